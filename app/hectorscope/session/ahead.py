"""Whether and when a recording is run ahead of what is shown."""

from time import monotonic

from hectorscope.session.active_run import ActiveRun
from hectorscope.session.head import Head
from hectorscope.session.intake import Intake


class RunsAhead:
    """Begins the head of the shown run, and lets it go on.

    after: seconds from the first item of the recording; None: never.
    """

    def __init__(self, intake: Intake, after: float | None) -> None:
        self._intake, self._after = intake, after
        self._is_possible = intake.rereadable is not None
        self._from = 0.0  # of the monotonic clock, once an item came

    def advance(self, run: ActiveRun, seconds: float) -> float | None:
        """Go on for about so long. In how many seconds there is more to do; None if never."""
        if run.head is None and (left := self._left()):
            return left
        head = run.head or self._begin(run)
        if head is None or head.done:
            return None
        head.advance(seconds)
        return 0.0

    def _left(self) -> float | None:
        """Seconds until it may begin: before the first item the sensors are checked, and may be repaired."""
        if self._after is None or not (self._is_possible and self._intake.begun):
            return None
        self._from = self._from or monotonic() + self._after
        return max(0.0, self._from - monotonic())

    def _begin(self, run: ActiveRun) -> Head | None:
        if self._left() is None:
            return None
        source = self._intake.rereadable
        other = source.again() if source else None
        self._is_possible = other is not None
        return run.run_ahead(other) if other else None
