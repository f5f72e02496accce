"""One run in the engine: the pipeline, what waits for it, and the scan that can be processed again."""

from collections import deque
from collections.abc import Callable
from copy import copy
from functools import partial
from itertools import count
from operator import methodcaller
from pathlib import Path
from typing import Any

from hectorscope.inputs import Item, Rereadable, Source
from hectorscope.run.annotations import Annotations
from hectorscope.run.checkpoints import Checkpoint, Checkpoints
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.series import SERIES_DTYPE
from hectorscope.run.settings import Settings
from hectorscope.session.head import Head
from hectorscope.session.other_scans import OtherScans
from hectorscope.session.rework import Rework
from hectorscope.session.snapshot import Ahead
from slam_core.localization.prior_map import PriorMap
from slam_core.measurements import Float64s, LaserScan, Measurement
from slam_core.results import StepResult

_numbers = count(1)


class ActiveRun:
    """Everything that makes a run what it is: put aside and taken up again, it goes on as if nothing had been.

    number: no other run has it. slot: its number in the list of the session. revision: grows with each change of
    settings. pipeline: what is shown. head: runs ahead of it; None for a stream, and before `run_ahead`.
    checkpoints: of both.
    last: the last item that the pipeline had. annotations: marks that a person set.
    sought: whether it was said that the robot is not found in the map. folder: where it was saved.
    """

    def __init__(
        self,
        settings: Settings,
        start_ns: int | None,
        prior_map: PriorMap | None,
        *,
        live: bool,
        checkpoints: Checkpoints | None = None,
        slot: int = 0,
    ) -> None:
        self._begun = partial(Pipeline, start_ns=start_ns, prior_map=prior_map, live=live)
        self.pipeline = self._begun(settings)
        self.settings = settings
        self.checkpoints = Checkpoints() if checkpoints is None else checkpoints
        self.head: Head | None = None
        self.number, self.revision, self.slot = next(_numbers), 0, slot
        self.sought = False
        self.folder: Path | None = None
        self.last: Item | None = None
        self.annotations = Annotations()
        self._ready: deque[Measurement] = deque()
        self._rework: Rework | None = None
        self._outdated = False

    @property
    def ahead(self) -> Ahead:
        """What is known of it, by what is shown or by what runs ahead of that."""
        known = self.head.pipeline if self.head else self.pipeline
        if known.scans_read < self.pipeline.scans_read:
            known = self.pipeline
        return Ahead(
            lineage=(self.number, self.revision),
            time_ns=known.time_ns,
            whole=self.head is not None and self.head.done,
            series=known.series.view(SERIES_DTYPE).reshape(-1),
            settings=self.settings,
            warned=known.warned.copy(),
        )

    @property
    def rework(self) -> Rework | None:
        """The run as it was before the shown scan, if it may rest there."""
        return self._rework

    @property
    def waiting(self) -> Measurement | None:
        """The measurement to be stepped next."""
        return self._ready[0] if self._ready else None

    def admit(self, item: Item) -> None:
        """Take in one item."""
        self.last = item
        self._ready.extend(self._give(methodcaller("admit", item)))

    def flush(self) -> None:
        """There will be no more."""
        self._ready.extend(self._give(methodcaller("flush")))

    def step(self) -> None:
        """Step what waits, which is no scan."""
        self._give(methodcaller("step", self._ready.popleft()))

    def skip(self, reason: str) -> None:
        """Let the scan that waits go by."""
        self._ready.popleft()
        self.pipeline.skip(reason)
        self.checkpoints.forget_from(0)  # from before the gap nothing leads here

    def step_scan(self, *, rests: bool) -> StepResult | None:
        """Step the scan that waits. rests: what was before it is kept, so that it can be processed again."""
        scan = self._ready.popleft()
        assert isinstance(scan, LaserScan)
        earlier = self.checkpoints.before(scan.stamp_ns)
        self._rework = Rework(self.pipeline, scan.stamp_ns, earlier) if rests else None
        result: StepResult | None = self._give(methodcaller("step", scan))
        return result

    def _give(self, act: Callable[[Pipeline], Any]) -> Any:
        """Give the pipeline something, and keep it for when the last scan is processed again."""
        if self._rework is not None:
            self._rework.note(act)
        return act(self.pipeline)

    def now_ns(self, *, running: bool) -> int:
        """The time of a change made now: of the scan that can be processed again, or right after the last one."""
        if self._rework is not None and not running:
            return self._rework.scan_ns
        return self.pipeline.time_ns + (self.pipeline.last_scan_ns is not None)

    def configure(self, settings: Settings, now_ns: int) -> None:
        """Other settings, changed at that time."""
        self.settings = self.pipeline.settings = settings
        self.revision += 1
        self.checkpoints.forget_from(now_ns)
        if self.head is not None:
            self.head.configure(settings, now_ns)
        self._outdated = now_ns <= self.pipeline.time_ns

    def run_ahead(self, source: Source) -> Head:
        """Begin to run ahead of what is shown, by a reading of its own."""
        self.head = Head(source, self._begun, self.settings, self.checkpoints)
        return self.head

    def other_scans(self, source: Rereadable | None, times: Float64s) -> OtherScans | None:
        """Any of the known scans, by a reading of its own; None for a stream, and before the first item."""
        start_ns = self.pipeline.start_ns
        if source is None or start_ns is None:
            return None
        return OtherScans(source, start_ns, times, self.settings, self.checkpoints, self._begun)

    def twin(self) -> "ActiveRun":
        """The same run, to be shown at another time; with the same checkpoints."""
        other = copy(self)
        other._ready, other._rework = deque(), None
        return other

    def put_aside(self) -> None:
        """Another run is shown from now on: it has the budget of the checkpoints, and the time to run ahead."""
        self.checkpoints.forget_from(0)
        if self.head is not None:
            self.head.close()
            self.head = None

    def go_to(self, checkpoint: Checkpoint | None) -> None:
        """Go on from an instant that was passed, or from the beginning."""
        self.pipeline = checkpoint.pipeline(self.settings) if checkpoint else self._begun(self.settings)
        self._ready.clear()
        self._rework, self._outdated, self.last = None, False, None

    def process_again(self) -> bool:
        """Process the scan at which the run rested, if settings changed meanwhile; whether it was so."""
        outdated, self._outdated = self._outdated, False
        if not outdated or self._rework is None:
            return False
        self.pipeline = self._rework.again(self.settings)
        return True
