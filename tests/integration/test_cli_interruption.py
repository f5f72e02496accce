"""Ctrl-C, at a page and in the middle of work."""

import signal
import subprocess
import sys
import time
import urllib.request
from pathlib import Path

import pytest

from tests.commands import PATIENCE_S

INTERRUPTED = 130


def interrupt(process: subprocess.Popen[str]) -> str:
    """Ctrl-C until it ends; what it said on stderr. A compiler or a loader at work can miss one."""
    deadline = time.monotonic() + PATIENCE_S
    while process.poll() is None and time.monotonic() < deadline:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(timeout=5.0)
        except subprocess.TimeoutExpired:
            continue
    assert process.stderr is not None
    return process.stderr.read()


# The interpreter may end itself by the signal where generated code was running: a shell reads 130 from both.
ENDED_BY_INTERRUPTION = (INTERRUPTED, -signal.SIGINT)


def test_an_interruption_is_clean(tmp_path: Path):
    """Ctrl-C in the middle of long work: exit code 130, a word, no traceback."""
    command = [
        sys.executable,
        "-m",
        "hectorscope.cli.main",
        "simulate",
        "--scenario",
        "rooms",
        "--duration",
        "3600",
    ]
    work = subprocess.Popen([*command, "--out", str(tmp_path / "long.mcap")], stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + PATIENCE_S
    while not any(tmp_path.iterdir()) and time.monotonic() < deadline and work.poll() is None:
        time.sleep(0.05)
    errors = interrupt(work)
    assert work.returncode in ENDED_BY_INTERRUPTION, errors
    assert "interrupted" in errors
    assert "Traceback" not in errors


@pytest.mark.parametrize("recording", ["bag", "wrong_units_bag"])
def test_a_page_is_served_until_interrupted(recording: str, request: pytest.FixtureRequest):
    """The command prints its address, answers there, and ends cleanly at Ctrl-C; also for a refused recording."""
    path = request.getfixturevalue(recording)
    command = [sys.executable, "-u", "-m", "hectorscope.cli.main", "view", str(path), "--port", "0"]
    page = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert page.stdout is not None
    line = page.stdout.readline()
    assert "http://127.0.0.1:" in line
    with urllib.request.urlopen(f"{line.split()[-1]}healthz", timeout=PATIENCE_S) as answer:
        assert answer.status == 200
    errors = interrupt(page)
    assert page.returncode in ENDED_BY_INTERRUPTION, errors
    assert "Traceback" not in errors
