"""Latest-wins hand-over: the writer never waits and the reader never sees anything stale."""

import threading
from typing import Generic, TypeVar

T = TypeVar("T")


class Mailbox(Generic[T]):
    """Holds one value; a newer one replaces it. Any number of threads may put, take and peek."""

    def __init__(self) -> None:
        self._filled = threading.Condition()
        self._value: T | None = None
        self._fresh = False

    def put(self, value: T) -> None:
        """Replace the content."""
        with self._filled:
            self._value, self._fresh = value, True
            self._filled.notify_all()

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
