"""Earlier times of a stream: what came is kept for some minutes, and shown again while the run goes on."""

import threading
from collections import deque
from collections.abc import Iterator

from hectorscope.inputs import Item, SourceReport
from hectorscope.session.active_run import ActiveRun
from hectorscope.session.intake import Intake
from slam_core.measurements import LaserScan
from slam_core.results import StepResult

MOST_BYTES = 2**28  # of items, whatever their age
OVERHEAD = 500  # bytes that an item takes besides the ranges of a scan


class KeptItems:
    """The newest items of a stream, numbered in the order in which a run got them. Any thread may read.

    begin, end: numbers of the first item, and of the next one to come.
    """

    def __init__(self, seconds: float) -> None:
        self.begin = 0
        self._most_ns, self._nbytes = round(seconds * 1e9), 0
        self._items: deque[Item] = deque()
        self._lock = threading.Lock()

    @property
    def end(self) -> int:
        """The number of the next item."""
        return self.begin + len(self._items)

    def add(self, item: Item) -> None:
        """One more; the oldest ones are given up."""
        with self._lock:
            self._items.append(item)
            self._nbytes += _size(item)
            while self._nbytes > MOST_BYTES or item.stamp_ns - self._items[0].stamp_ns > self._most_ns:
                self._nbytes -= _size(self._items.popleft())
                self.begin += 1

    def at(self, number: int) -> Item | None:
        """An item; None if it is kept no more, or has not come."""
        with self._lock:
            return self._items[number - self.begin] if self.begin <= number < self.end else None


def _size(item: Item) -> int:
    return OVERHEAD + (item.ranges.nbytes if isinstance(item, LaserScan) else 0)


class KeptSource:
    """What is kept, as a recording that ends with the newest item."""

    name, live = "stream", False
    span_ns = None
    report = SourceReport()

    def __init__(self, kept: KeptItems) -> None:
        self._kept = kept

    def items(self) -> Iterator[Item]:
        """From the oldest one on."""
        return self.items_from(self._kept.begin)

    def items_from(self, place: object) -> Iterator[Item]:
        """From a number on."""
        assert isinstance(place, int)
        while (item := self._kept.at(place)) is not None:
            place += 1
            yield item

    def place(self) -> object:
        """Not noted: the run itself leaves checkpoints."""
        return None

    def close(self) -> None:
        """Nothing is open."""


class LookBack:
    """Keeps what a stream brings, and its run while an earlier time is shown. It belongs to the engine's thread.

    seconds: of the stream that are kept; 0 for nothing. front: the run that goes on, and what it reads; None while
    it is shown as it is now.
    """

    def __init__(self, seconds: float) -> None:
        self.items = KeptItems(seconds) if seconds else None
        self.front: tuple[ActiveRun, Intake] | None = None

    def span_ns(self, run: ActiveRun) -> tuple[int, int] | None:
        """First and last time of a run that can be shown; None without any."""
        first = run.checkpoints.first(self.items.begin) if self.items else None
        newest_ns = run.pipeline.time_ns
        return (min(first.serves_ns, newest_ns), newest_ns) if first else None

    def leave_now(self, run: ActiveRun, intake: Intake) -> tuple[ActiveRun, Intake]:
        """The same run to be shown at an earlier time, and what is kept to be read for it."""
        assert self.items is not None
        self.front = run, intake
        return run.twin(), Intake(KeptSource(self.items))

    def keep(self, run: ActiveRun, intake: Intake) -> None:
        """Keep a checkpoint if the run is at a place where it can be gone on from."""
        if place := intake.place:
            run.checkpoints.add(run.pipeline, place)
            if self.items is not None:
                run.checkpoints.forget_before(self.items.begin)

    def advance(self) -> tuple[StepResult | None, StepResult | None]:
        """Let the run go on up to its next scan, as far as items are there; the results before and of that."""
        if self.front is None:
            return None, None
        run, intake = self.front
        before = run.pipeline.result
        while not isinstance(waiting := run.waiting, LaserScan):
            if waiting is not None:
                run.step()
                continue
            self.keep(run, intake)
            if (item := intake.get(0.0)) is None:
                return before, None
            run.admit(item)
        return before, run.step_scan(rests=False)
