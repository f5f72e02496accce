"""Earlier times of a stream: what came is kept for some minutes, and shown again while the run goes on."""

import threading
from collections import deque
from collections.abc import Iterator
from typing import TYPE_CHECKING

from hectorscope.inputs import Item, SourceReport
from hectorscope.session.active_run import ActiveRun
from hectorscope.session.intake import Intake
from slam_core.measurements import LaserScan
from slam_core.results import StepResult

if TYPE_CHECKING:
    from hectorscope.session.session import Session

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

    def __init__(self, session: "Session", seconds: float) -> None:
        self.items = KeptItems(seconds) if seconds else None
        self.front: tuple[ActiveRun, Intake] | None = None
        self._session = session

    @property
    def newest(self) -> ActiveRun:
        """The run as it is now, whatever time of it is shown."""
        return self.front[0] if self.front else self._session.run

    @property
    def kept_ns(self) -> tuple[int, int] | None:
        """First and last time of a stream that can be shown; None without any."""
        first = self.newest.checkpoints.first(self.items.begin) if self.items else None
        newest_ns = self.newest.pipeline.time_ns
        return (min(first.serves_ns, newest_ns), newest_ns) if first else None

    @property
    def lag(self) -> float | None:
        """Seconds from what is shown to the run as it is now; None if it is shown as it is now."""
        behind_ns = self.newest.pipeline.time_ns - self._session.run.pipeline.time_ns
        return behind_ns / 1e9 if self.front else None

    def leave_now(self) -> None:
        """Show the same run at an earlier time, by what is kept."""
        session = self._session
        if self.front is not None:
            return
        assert self.items is not None
        self.front = session.run, session.intake
        session.run, session.intake = session.run.twin(), Intake(KeptSource(self.items))
        session.transport.look_back()

    def go_live(self) -> None:
        """Show the run as it is now."""
        session = self._session
        if self.front is None:
            return
        session.intake.close()
        (session.run, session.intake), self.front = self.front, None
        session.transport.go_live()
        session.show_anew()

    def keep(self, run: ActiveRun, intake: Intake) -> None:
        """Keep a checkpoint if the run is at a place where it can be gone on from."""
        if place := intake.place:
            run.checkpoints.add(run.pipeline, place)
            if self.items is not None:
                run.checkpoints.forget_before(self.items.begin)

    def step_front(self) -> None:
        """Let the run go on by a scan, if there is one, while an earlier time is shown."""
        if self.front is None:
            return
        run, intake = self.front
        self._session.tell(run.pipeline.result, self._step(run, intake))

    def _step(self, run: ActiveRun, intake: Intake) -> StepResult | None:
        """Up to the next scan, as far as items are there."""
        while not isinstance(waiting := run.waiting, LaserScan):
            if waiting is not None:
                run.step()
                continue
            self.keep(run, intake)
            if (item := intake.get(0.0)) is None:
                return None
            run.admit(item)
        return run.step_scan(rests=False)
