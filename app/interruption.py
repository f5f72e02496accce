"""Ctrl-C while the compiler is at work: Python cannot raise through its callbacks, it prints and forgets it."""

import _thread
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager

RETRY_S = 0.05


@contextmanager
def delivered_later() -> Iterator[None]:
    """An interruption that got lost in a callback of compiled code is raised again a moment later."""
    previous = sys.unraisablehook

    def hook(lost: "sys.UnraisableHookArgs") -> None:
        if isinstance(lost.exc_value, KeyboardInterrupt):
            again = threading.Timer(RETRY_S, _thread.interrupt_main)
            again.daemon = True
            again.start()
        else:
            previous(lost)

    sys.unraisablehook = hook
    try:
        yield
    finally:
        sys.unraisablehook = previous
