"""An interruption reaches the command, although it came while a callback of compiled code ran."""

import ctypes
import gc
import signal
import subprocess
import sys
import time

import pytest

from hectorscope.cli.interruption import ENDING, ended_by_interruption


def test_an_interruption_lost_in_a_callback_comes_again(capsys: pytest.CaptureFixture[str]):
    """Raised inside a C callback, where Python can only print and forget it, it ends the work, in silence."""

    @ctypes.CFUNCTYPE(None)
    def callback() -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt), ended_by_interruption():
        callback()
        for _ in range(200):
            time.sleep(0.05)
    assert "Traceback" not in capsys.readouterr().err


class _HalfMade:
    """Fails when it is freed, as an object of the compiler does whose making was interrupted."""

    def __del__(self) -> None:
        raise AttributeError("half made")


def test_what_an_interruption_left_half_made_is_not_told():
    """An object that fails when it is freed is silent after an interruption, and told before one."""

    def work() -> None:
        _ = _HalfMade()
        signal.raise_signal(signal.SIGINT)

    told: list[object] = []
    before, sys.unraisablehook = sys.unraisablehook, told.append
    try:
        with ended_by_interruption():
            _HalfMade()
            assert len(told) == 1
            with pytest.raises(KeyboardInterrupt):
                work()
            gc.collect()
    finally:
        sys.unraisablehook = before
    assert len(told) == 1


@pytest.mark.parametrize("ending", ENDING)
def test_a_signal_that_is_ignored_stays_ignored(ending: signal.Signals):
    """Under nohup the lost terminal does not end the program; the other signals do."""
    before = signal.signal(ending, signal.SIG_IGN)
    try:
        with ended_by_interruption():
            signal.raise_signal(ending)
            others = [number for number in ENDING if signal.getsignal(number) != signal.SIG_IGN]
            for number in others:
                with pytest.raises(KeyboardInterrupt):
                    signal.raise_signal(number)
        assert signal.getsignal(ending) == signal.SIG_IGN
    finally:
        signal.signal(ending, before)


WHILE_LOADED = """
import signal, sys

class Interrupting:
    def find_spec(self, name, *_):
        if name == "tyro":
            signal.raise_signal(signal.SIGINT)

sys.meta_path.insert(0, Interrupting())
from hectorscope.cli.start import main
sys.exit(main())
"""


def test_an_interruption_while_the_program_is_loaded_is_one_too():
    """Ctrl-C in the first moments, while a library comes: one word, and the exit code of an interruption."""
    done = subprocess.run([sys.executable, "-c", WHILE_LOADED], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (130, "interrupted\n")
