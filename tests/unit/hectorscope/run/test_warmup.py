"""The kernels are ready before the first scan, and whoever waits for them is told."""

import re
import subprocess
import sys
from collections.abc import Callable

import pytest

from hectorscope.run import warmup
from tests.conftest import ROOT

# Prints every kernel of ours that is compiled, not loaded, while everything is run once.
WATCHED = """
from tests import conftest
from numba.core import event
from hectorscope.run.warmup import warm_up

class Compiled(event.Listener):
    def on_start(self, _):
        pass

    def on_end(self, compilation):
        print(compilation.data["dispatcher"].py_func.__qualname__)

event.register("numba:compile", Compiled())
warm_up()
"""


def test_everything_is_run_and_the_waiting_is_told(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The made-up room exercises the whole pipeline; how far that is goes to the terminal and to the page."""
    monkeypatch.setattr(warmup, "PATIENCE_S", 0.0)
    monkeypatch.setattr(warmup, "PERIOD_S", 0.001)
    told: list[str] = []
    warmup.warm_up(told.append)
    counts = [re.fullmatch(r"(\d+) of (\d+) kernels compiled \(first start only\)", text) for text in told]
    numbers = [(int(count[1]), int(count[2])) for count in counts if count]
    assert len(numbers) == len(told) > 0
    assert numbers == sorted(numbers)
    assert 0 < numbers[-1][0] <= numbers[-1][1]
    assert told[0] in capsys.readouterr().err


def test_a_start_in_time_says_nothing(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """Who has not waited for long needs no word."""
    monkeypatch.setattr(warmup, "PATIENCE_S", 600.0)
    warmup.warm_up()
    assert capsys.readouterr().err == ""


def test_who_waits_has_a_helper(monkeypatch: pytest.MonkeyPatch) -> None:
    """It runs the filter's kernels to the end when it is left alone, and ends before that with who began it."""
    helpers = [warmup._helper()]
    assert helpers[0].wait(300) == 0
    helpers.append(warmup._helper())
    helpers[1].communicate()  # closes its input, as the end of this process would
    assert helpers[1].returncode == 1

    def helper(begin: Callable[[], subprocess.Popen[bytes]] = warmup._helper) -> subprocess.Popen[bytes]:
        helpers.append(begin())
        return helpers[-1]

    monkeypatch.setattr(warmup, "_helper", helper)
    monkeypatch.setattr(warmup, "PATIENCE_S", 0.0)
    warmup.warm_up()
    assert len(helpers) == 3
    assert helpers[2].returncode is not None


def test_the_second_start_compiles_nothing() -> None:
    """Every kernel that Python calls is kept; one that is not would be compiled at each start."""
    command = [sys.executable, "-c", WATCHED]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True, timeout=300)
    again = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, timeout=300, text=True)
    ours = set(again.stdout.split()) - {"impl"}
    assert not ours
