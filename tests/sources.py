"""Sources for tests that hold their measurements in memory: real ones, by the protocol."""

import queue
from collections import Counter
from collections.abc import Iterator, Sequence
from copy import copy
from typing import Self

from hectorscope.inputs import Item, SourceReport


class MemoryRecording:
    """A recording that is a list. fail_at: raise `error` once, before that item, on the first pass."""

    live = False

    def __init__(self, items: Sequence[Item], *, error: Exception | None = None, fail_at: int = 0) -> None:
        self.name = "memory"
        self.closed = False
        self._items = items
        self._error, self._fail_at = error, fail_at
        self._read: Counter[str] = Counter()

    @property
    def span_ns(self) -> tuple[int, int]:
        """First and last stamp."""
        stamps = [item.stamp_ns for item in self._items]
        return (min(stamps), max(stamps)) if stamps else (0, 0)

    @property
    def report(self) -> SourceReport:
        """Items read in this pass."""
        return SourceReport(dict(self._read), notes=("all from memory",))

    def place(self) -> object:
        """How many items were handed out, and the counters."""
        return self._read.copy()

    def items_from(self, place: object) -> Iterator[Item]:
        """Everything behind a place."""
        assert isinstance(place, Counter)
        self._read = place.copy()
        return self._after(place.total())

    def again(self) -> Self:
        """A reading of its own."""
        other = copy(self)
        other._read = Counter()
        return other

    def items(self) -> Iterator[Item]:
        """Everything, from the beginning."""
        self._read.clear()
        return self._after(0)

    def _after(self, skip: int) -> Iterator[Item]:
        for number, item in enumerate(self._items[skip:], skip):
            if self._error is not None and number == self._fail_at:
                error, self._error = self._error, None
                raise error
            self._read[type(item).__name__] += 1
            yield item

    def reopened(self) -> "MemoryRecording":
        """The same list once more."""
        return MemoryRecording(self._items)

    def close(self) -> None:
        """Nothing to let go of."""
        self.closed = True


class MemoryStream:
    """A live stream that brings what the test sends."""

    live = True
    span_ns = None

    def __init__(self) -> None:
        self.name = "stream"
        self.report = SourceReport()
        self._items: queue.SimpleQueue[Item | None] = queue.SimpleQueue()

    def send(self, items: Sequence[Item]) -> None:
        """Let these arrive."""
        for item in items:
            self._items.put(item)

    def items(self) -> Iterator[Item]:
        """What arrives, until closed."""
        while (item := self._items.get()) is not None:
            yield item

    def close(self) -> None:
        """End `items`."""
        self._items.put(None)
