"""An interruption reaches the command, although it came while a callback of compiled code ran."""

import ctypes
import signal
import time

import pytest

from hectorscope.cli.interruption import ENDING, delivered_later, ended_by_interruption


def test_an_interruption_lost_in_a_callback_comes_again(capsys: pytest.CaptureFixture[str]):
    """Raised inside a C callback, where Python can only print and forget it, it ends the work, in silence."""

    @ctypes.CFUNCTYPE(None)
    def callback() -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt), delivered_later():
        callback()
        for _ in range(200):
            time.sleep(0.05)
    assert "Traceback" not in capsys.readouterr().err


@pytest.mark.parametrize("ending", ENDING)
def test_a_signal_that_is_ignored_stays_ignored(ending: signal.Signals):
    """Under nohup the lost terminal does not end the program; the other signals do."""
    before = signal.signal(ending, signal.SIG_IGN)
    try:
        with ended_by_interruption():
            signal.raise_signal(ending)
            others = [number for number in ENDING if number != ending]
            assert all(signal.getsignal(number) == signal.default_int_handler for number in others)
        assert signal.getsignal(ending) == signal.SIG_IGN
    finally:
        signal.signal(ending, before)
