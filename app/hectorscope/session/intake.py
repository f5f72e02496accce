"""The items of a source in their order, also for a run that is put aside and taken up again."""

from collections import deque
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Protocol

from hectorscope.inputs import Item, Rereadable, Source
from hectorscope.run.checkpoints import Place
from hectorscope.session.feeder import APART, Feeder
from hectorscope.steering import Drivable
from slam_core.measurements import LaserScan


@dataclass(eq=False)
class Aside:
    """Where a run that is put aside goes on. taken: items of a recording it had. came: of a stream, missed."""

    taken: int
    came: deque[Item] = field(default_factory=deque)


class Keeps(Protocol):
    """Takes the items of a stream, which are shown again later. end: how many it has had."""

    @property
    def end(self) -> int:
        """So many."""

    def add(self, item: Item) -> None:
        """One more."""


class Intake:
    """Hands out items one by one. A recording begins anew, or after so many items; a stream flows on.

    path: where the recording lies, if that is known. keeps: gets what is handed out of a stream.
    """

    def __init__(self, source: Source, path: Path | None = None) -> None:
        self.source, self.path = source, path
        self.keeps: Keeps | None = None
        self._scans = 0
        self._feeder: Feeder | None = None
        self._taken = 0
        self._place: Place | None = None
        self._backlog: deque[Item] = deque()
        self._aside: list[Aside] = []

    @property
    def dropped(self) -> int:
        """Scans given up because the pipeline was too slow for a live stream."""
        return self._feeder.dropped if self._feeder else 0

    @property
    def behind(self) -> int:
        """Scans of a stream that came while another run was shown, and are still to be handed out."""
        return sum(isinstance(item, LaserScan) for item in self._backlog)

    @cached_property
    def drivable(self) -> Drivable | None:
        """The source, if its robot is driven by hand. Asking that evaluates its properties, so it is done once."""
        return self.source if isinstance(self.source, Drivable) else None

    @cached_property
    def rereadable(self) -> Rereadable | None:
        """The source, if it is a recording that can be read at several places at the same time."""
        return self.source if not self.source.live and isinstance(self.source, Rereadable) else None

    @property
    def done(self) -> bool:
        """Whether every item was handed out."""
        return self._feeder is not None and self._feeder.done and not self._backlog

    def check(self) -> None:
        """Raise what ended the reading, if it was an error."""
        if self._feeder is not None:
            self._feeder.check()

    def get(self, timeout: float) -> Item | None:
        """The next item, or None after `timeout` seconds."""
        if self._feeder is None:
            self._feeder = Feeder(self.source, self._place or self._taken)
        if self._backlog:
            while (fresh := self._fresh(0.0)) is not None:  # or the queue would give up scans meanwhile
                self._backlog.append(fresh)
            item: Item | None = self._backlog.popleft()
        else:
            item = self._fresh(timeout)
        if item is not None:
            self._note(item, self._feeder)
        return item

    def _note(self, item: Item, feeder: Feeder) -> None:
        """Where the next item comes from, of a stream behind every so many scans."""
        if not self.source.live:
            self._taken += 1
            self._place = feeder.place(self._taken)
        elif self.keeps is not None:
            self.keeps.add(item)
            self._scans += isinstance(item, LaserScan)
            end, is_due = self.keeps.end, self._scans == APART
            self._place = Place(end, end) if is_due else None
            self._scans = 0 if is_due else self._scans

    @property
    def begun(self) -> bool:
        """Whether an item was handed out since the beginning."""
        return self._taken > 0

    @property
    def place(self) -> Place | None:
        """Where the next item comes from, if that was noted."""
        return self._place

    def go_to(self, place: Place) -> None:
        """Go on at a place of the recording."""
        self.begin()
        self._taken, self._place = place.taken, place

    def _fresh(self, timeout: float) -> Item | None:
        assert self._feeder is not None
        item = self._feeder.get(timeout)
        if item is not None and self.source.live:
            for aside in self._aside:
                aside.came.append(item)
        return item

    def begin(self) -> None:
        """For a new run: a recording from its beginning, a stream from now on."""
        self._taken, self._place = 0, None
        self._backlog = deque()
        if self._feeder is not None and (not self.source.live or self._feeder.done):
            self.close()

    def put_aside(self) -> Aside:
        """For the run so far, before `begin`: what it needs to go on later."""
        aside = Aside(self._taken, self._backlog.copy())
        self._aside.append(aside)
        return aside

    def forget(self, aside: Aside) -> None:
        """That run will not go on."""
        self._aside.remove(aside)

    def resume(self, aside: Aside) -> None:
        """Go on where that run was: a recording after the items it has had, a stream with all that it missed."""
        self.forget(aside)
        self.begin()
        self._taken, self._backlog = aside.taken, aside.came

    def close(self) -> None:
        """Stop reading. A live source must be closed before."""
        if self._feeder is not None:
            self._feeder.close()
            self._feeder = None

    def end(self) -> None:
        """Close the source: no run will go on with it."""
        self.source.close()
        self.close()
