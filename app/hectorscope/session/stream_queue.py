"""The hand-over from the thread that reads a source to the thread that steps the pipeline."""

import threading
from collections import deque

from hectorscope.inputs import Item
from slam_core.measurements import LaserScan

MOST_ITEMS = 100_000  # of a live stream: minutes, which wait only while nobody takes any, as behind a failure


class StreamQueue:
    """Bounded by its scans: a recording waits for room, a live stream gives up its oldest waiting scan.

    A recording that found no room reads on when half of the scans are taken: so its thread wakes rarely, not at
    each scan.
    Everything else is small and precious (the filter integrates it), so it is not given up, but where nobody has
    taken any for minutes: then the oldest items go. The order of arrival is kept. One thread calls `put` and
    `finish`, one calls `get`; `close` may come from anywhere.
    """

    def __init__(self, live: bool, scans: int = 16) -> None:
        self.dropped = 0
        self._live = live
        self._scans = scans
        self._slots: deque[list[Item]] = deque()  # one item each; a slot emptied is a scan given up
        self._waiting: deque[list[Item]] = deque()  # the slots that hold a scan
        self._changed = threading.Condition()
        self._finished = self._closed = False

    def put(self, item: Item) -> bool:
        """Append; a recording blocks while it is full. False after `close`: stop reading."""
        slot = [item]
        with self._changed:
            if isinstance(item, LaserScan):
                self._make_room()
                self._waiting.append(slot)
            if not self._closed:
                while self._live and len(self._slots) >= MOST_ITEMS:
                    self._give_up(self._slots.popleft())
                self._slots.append(slot)
                self._changed.notify_all()
            return not self._closed

    def _give_up(self, slot: list[Item]) -> None:
        if self._waiting and self._waiting[0] is slot:
            self._waiting.popleft()
            self.dropped += 1

    def _make_room(self) -> None:
        if len(self._waiting) < self._scans:
            return
        if self._live:
            self._waiting.popleft().clear()
            self.dropped += 1
            return
        while len(self._waiting) > self._scans // 2 and not self._closed:
            self._changed.wait()

    def get(self, timeout: float | None = None) -> Item | None:
        """The oldest item; None when nothing came within `timeout` seconds, or nothing will come any more."""
        with self._changed:
            while True:
                while self._slots:
                    slot = self._slots.popleft()
                    if slot:
                        return self._taken(slot)
                if self._finished or self._closed or not self._changed.wait(timeout):
                    return None

    def _taken(self, slot: list[Item]) -> Item:
        if self._waiting and self._waiting[0] is slot:
            self._waiting.popleft()
            if len(self._waiting) == self._scans // 2:
                self._changed.notify_all()
        return slot[0]

    def finish(self) -> None:
        """Nothing more will come; what waits is still handed out."""
        with self._changed:
            self._finished = True
            self._changed.notify_all()

    def close(self) -> None:
        """Forget what waits and let both sides go."""
        with self._changed:
            self._closed = True
            self._slots.clear()
            self._waiting.clear()
            self._changed.notify_all()

    @property
    def done(self) -> bool:
        """Whether `get` will never hand out anything again."""
        with self._changed:
            return self._closed or (self._finished and not any(self._slots))
