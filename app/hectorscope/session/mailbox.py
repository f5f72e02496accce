"""Latest-wins hand-over: the writer never waits and the reader never sees anything stale."""

import threading
from collections.abc import Callable
from typing import Generic, TypeVar

T = TypeVar("T")


class Mailbox(Generic[T]):
    """Holds one value; a newer one replaces it. Any number of threads may put, take and peek."""

    def __init__(self) -> None:
        self._filled = threading.Condition()
        self._value: T | None = None
        self._fresh = False
        self._told: Callable[[T], None] = lambda _: None

    def tell(self, told: Callable[[T], None]) -> None:
        """Call a function with each new value, on the thread that puts it: it must not wait."""
        self._told = told

    def put(self, value: T) -> None:
        """Replace the content."""
        with self._filled:
            self._value, self._fresh = value, True
            self._filled.notify_all()
        self._told(value)

    def take(self, timeout: float | None = 0.0) -> T | None:
        """The newest value if nobody took it yet, after waiting up to `timeout` seconds (None: for ever)."""
        with self._filled:
            if not self._filled.wait_for(lambda: self._fresh, timeout):
                return None
            self._fresh = False
            return self._value

    @property
    def latest(self) -> T | None:
        """The newest value, taken or not; None before the first."""
        with self._filled:
            return self._value
