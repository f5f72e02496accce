"""What an action took away, kept for a minute so that it can be taken back."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from hectorscope.run.annotations import Annotations
from hectorscope.run.settings import Setting
from hectorscope.session.active_run import ActiveRun
from hectorscope.session.commands import ConfigureAll
from hectorscope.session.event_log import EventLog
from hectorscope.session.intake import Aside, Intake
from hectorscope.session.runs import NamedRun
from hectorscope.session.snapshot import UndoOffer
from hectorscope.session.transport import Stand

if TYPE_CHECKING:
    from hectorscope.session.session import Session

UNDO_S = 60.0
MOST = 4  # each has a map of its own in memory


class Kept(Protocol):
    """Something that can come back."""

    @property
    def scans(self) -> int:
        """How much it is worth."""

    def restore(self, session: "Session", what: str) -> None:
        """Bring it back. what: the action that took it away."""


@dataclass(frozen=True, slots=True)
class KeptRun:
    """A run that another one took the place of. intake, event_log: of its recording."""

    run: ActiveRun
    intake: Intake
    aside: Aside
    stand: Stand
    event_log: EventLog

    @property
    def scans(self) -> int:
        """How much it is worth."""
        return self.run.pipeline.scans

    def restore(self, session: "Session", what: str) -> None:
        """The run goes on where it was."""
        session.bring_back(self)
        session.log(f"Undone: {what}. The run goes on with its map of {self.scans} scans")


@dataclass(frozen=True, slots=True)
class KeptValues:
    """Settings that were overwritten together; the run went on."""

    values: Mapping[str, Setting]
    scans: int = 0

    def restore(self, session: "Session", what: str) -> None:
        """They hold from now on."""
        if change := session.settings.planned(ConfigureAll(what, self.values)):
            session.run.configure(change.after, session.now_ns)
            session.log(f"Undone: {what}. {len(change.old)} settings are as before")


@dataclass(frozen=True, slots=True)
class KeptName:
    """A run that was taken out of the list."""

    run: NamedRun
    scans: int = 0

    def restore(self, session: "Session", what: str) -> None:
        """It is in the list again, which shows that."""
        session.named.runs.put(self.run)


@dataclass(frozen=True, slots=True)
class KeptMarks:
    """Marks before one was changed or removed."""

    annotations: Annotations
    scans: int = 0

    def restore(self, session: "Session", what: str) -> None:
        """They stay with a recording, so the run that is shown by now gets them."""
        session.run.annotations = self.annotations
        session.log(f"Undone: {what}")


class UndoStack:
    """The newest comes back first. drop: hears of every run that can no longer come back.

    clock: seconds, monotonic.
    """

    def __init__(self, drop: Callable[[Kept], None], clock: Callable[[], float] = time.monotonic) -> None:
        self._drop = drop
        self._clock = clock
        self._kept: list[tuple[UndoOffer, Kept]] = []

    @property
    def offer(self) -> UndoOffer | None:
        """What can be taken back next."""
        return self._kept[-1][0] if self._kept else None

    @property
    def left(self) -> float | None:
        """Seconds until one is given up; None if there is none."""
        return max(0.0, self._kept[0][0].expires - self._clock()) if self._kept else None

    def keeps(self, intake: Intake) -> bool:
        """Whether a run that is kept goes on with it."""
        return any(isinstance(kept, KeptRun) and kept.intake is intake for _, kept in self._kept)

    def push(self, what: str, kept: Kept) -> None:
        """Keep one, and give up the least one if there are too many: nobody fills the memory by a held key."""
        self._kept.append((UndoOffer(what, self._clock() + UNDO_S), kept))
        if len(self._kept) > MOST:
            least = min(range(len(self._kept)), key=lambda at: self._kept[at][1].scans)
            self._drop(self._kept.pop(least)[1])

    def pop(self) -> tuple[str, Kept] | None:
        """Hand out the newest."""
        self.lapse()
        if not self._kept:
            return None
        offer, kept = self._kept.pop()
        return offer.what, kept

    def lapse(self) -> bool:
        """Give up those whose minute is over; whether there was one."""
        over = [kept for offer, kept in self._kept if offer.expires <= self._clock()]
        self._kept = self._kept[len(over) :]
        for kept in over:
            self._drop(kept)
        return bool(over)

    def forget_values(self) -> None:
        """Another run is shown: values of the one before are no longer to be brought back."""
        self._kept = [each for each in self._kept if not isinstance(each[1], KeptValues)]

    def clear(self) -> None:
        """Give up all."""
        kept, self._kept = self._kept, []
        for _, each in kept:
            self._drop(each)
