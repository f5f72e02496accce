"""The unit of systemd and the container file of docs/station.md: what they start can be started."""

import functools
import json
import os
import re
import shlex
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from hectorscope.cli import main
from tests.conftest import ROOT

TEXT = (ROOT / "docs" / "station.md").read_text(encoding="utf-8")
PROGRAM = "/srv/hectorscope/bin/hectorscope"


def block(language: str) -> str:
    """What stands in the document in a language."""
    return TEXT.split(f"```{language}\n")[1].split("```")[0]


def values(text: str, key: str) -> list[str]:
    """What stands behind a word at the beginning of a line."""
    return re.findall(rf"^{key}[ =](.*)$", text, re.MULTILINE)


def parsed(monkeypatch: pytest.MonkeyPatch, words: list[str]) -> tuple[Any, ...]:
    """What our own parser makes of a command line of `live`."""
    seen: list[tuple[Any, ...]] = []

    @functools.wraps(main.live)
    def noted(*given: Any, **named: Any) -> None:
        seen.append((*given, *named.values()))

    monkeypatch.setattr(main, "live", noted)
    assert main.main(words) == 0
    return seen[0]


def test_the_command_of_the_unit_is_one_of_ours(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every flag exists, and what it writes lies in the folders that the unit makes."""
    unit = block("ini")
    (command,) = values(unit, "ExecStart")
    program, *words = shlex.split(command)
    assert program == PROGRAM
    told = repr(parsed(monkeypatch, words))
    assert "ws://robot:8765" in told
    assert "/etc/hectorscope/token" in told
    assert all(word.startswith("/var/lib/hectorscope") for word in words if word.startswith("/var"))
    assert values(unit, "StateDirectory") == values(unit, "CacheDirectory") == ["hectorscope"]
    assert values(unit, "SuccessExitStatus") == [str(main.INTERRUPTED)]
    assert values(unit, "RestartPreventExitStatus") == [str(main.MISTAKE)]


def test_a_flag_that_does_not_exist_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """The parser of these tests is the program's own."""
    with pytest.raises(SystemExit):
        parsed(monkeypatch, ["live", "ws://robot:8765", "--recrod", "mission"])


def test_the_unit_passes_systemd(tmp_path: Path) -> None:
    """No key, section or value that systemd does not know. The program stands where this machine has one."""
    analyze = shutil.which("systemd-analyze")
    if analyze is None:
        pytest.skip("no systemd-analyze: apt-get install systemd")
    program = shutil.which("true")
    assert program is not None
    unit = tmp_path / "hectorscope.service"
    unit.write_text(block("ini").replace(PROGRAM, program))
    asked = [analyze, "verify", "--man=no", str(unit)]
    done = subprocess.run(asked, capture_output=True, text=True, timeout=60, check=False)
    said = [line for line in done.stderr.splitlines() if "hectorscope" in line]
    assert (done.returncode, said) == (0, [])


def test_the_command_of_the_container_is_one_of_ours(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every flag exists; what is installed and copied is there; what it writes lies in the volume."""
    file = block("dockerfile")
    (entry,), (command,) = values(file, "ENTRYPOINT"), values(file, "CMD")
    assert json.loads(entry) == [PROGRAM]
    words = json.loads(command)
    assert "ws://robot:8765" in repr(parsed(monkeypatch, words))
    (volume,) = values(file, "VOLUME")
    assert all(word.startswith(volume) for word in words if word.startswith(os.sep))
    for place in re.findall(r"/src/(\S+)", file):
        assert (ROOT / place).exists()
