"""The end of the program from outside: Ctrl-C, a service that is stopped, a terminal whose link broke."""

import _thread
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

INTERRUPTED = 130  # the exit code
RETRY_S = 0.05
# By which a program is asked to end; a system without terminals has no SIGHUP.
ENDING = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]


@contextmanager
def ended_by_interruption() -> Iterator[None]:
    """Whatever asks the program to end raises KeyboardInterrupt, as Ctrl-C does; on the main thread.

    A signal that whoever started the program has it ignore, as `nohup` does, stays ignored.
    """
    asked = threading.Event()

    def interrupt(_number: int, _frame: FrameType | None) -> None:
        asked.set()
        raise KeyboardInterrupt

    with _handled(interrupt), _unraisable_after(asked):
        yield


@contextmanager
def undisturbed() -> Iterator[None]:
    """What is done here is finished, whoever asks for the end meanwhile; on the main thread."""
    with _handled(signal.SIG_IGN):
        yield


@contextmanager
def _unraisable_after(interruption: threading.Event) -> Iterator[None]:
    """What Python can only print: an interruption comes again a moment later, and its consequences are not told.

    Python cannot raise through the compiler's callbacks: it would print the interruption and forget it. An object
    of the compiler that the interruption left half made fails when it is freed.
    """
    previous = sys.unraisablehook

    def hook(lost: "sys.UnraisableHookArgs") -> None:
        if isinstance(lost.exc_value, KeyboardInterrupt):
            again = threading.Timer(RETRY_S, _thread.interrupt_main)
            again.daemon = True
            again.start()
        elif not interruption.is_set():
            previous(lost)

    sys.unraisablehook = hook
    try:
        yield
    finally:
        sys.unraisablehook = previous


@contextmanager
def _handled(handler: Any) -> Iterator[None]:
    heard = [number for number in ENDING if signal.getsignal(number) != signal.SIG_IGN]
    previous = [(number, signal.signal(number, handler)) for number in heard]
    try:
        yield
    finally:
        for number, before in previous:
            signal.signal(number, before)
