"""An interruption reaches the command although it came while a callback of compiled code ran."""

import ctypes
import time

import pytest

from app.interruption import delivered_later


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
