"""The front of a run: a recording is run ahead of what is shown, in the time that the engine has to spare."""

import logging
from collections import deque
from collections.abc import Callable
from time import monotonic

from hectorscope.inputs import Source
from hectorscope.run.checkpoints import Checkpoint, Checkpoints
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from hectorscope.session.intake import Intake
from slam_core.measurements import Measurement

_logger = logging.getLogger("hectorscope")


class Head:
    """A pipeline of its own, which leaves checkpoints. It belongs to the engine's thread.

    source: a reading of its own, closed with the head. begun: makes the pipeline of the first scan. done: there is
    no more, or it cannot go on.
    """

    def __init__(
        self, source: Source, begun: Callable[[Settings], Pipeline], settings: Settings, checkpoints: Checkpoints
    ) -> None:
        self._source, self._begun, self._settings, self._checkpoints = source, begun, settings, checkpoints
        self._intake = Intake(source)
        self._ready: deque[Measurement] = deque()
        self.pipeline = begun(settings)
        self.done = False

    def advance(self, seconds: float) -> None:
        """Run on for about so long. What fails ends the pass, and the shown run tells it once it comes there."""
        ends = monotonic() + seconds
        try:
            self._overtake()
            while not self.done and (left := ends - monotonic()) > 0.0:
                self._advance(left)
        except Exception as error:
            _logger.warning("the pass ahead of the shown run ended early: %s", error)
            self.done = True

    def configure(self, settings: Settings, now_ns: int) -> None:
        """Other settings, changed at that time: what was run behind it is run again."""
        self._settings = settings
        if self.pipeline.time_ns < now_ns:
            self.pipeline.settings = settings
        else:
            self._go_to(self._checkpoints.last)

    def close(self) -> None:
        """Stop reading."""
        self.done = True
        self._source.close()
        self._intake.close()

    def _overtake(self) -> None:
        """Go on where the shown run has left the last checkpoint, if it has come further."""
        last = self._checkpoints.last
        if last is not None and last.scans_read > self.pipeline.scans_read:
            self._go_to(last)

    def _go_to(self, checkpoint: Checkpoint | None) -> None:
        """Go on from a checkpoint, or from the beginning."""
        self.done = False
        self._ready.clear()
        if checkpoint is None:
            self.pipeline = self._begun(self._settings)
            self._intake.begin()
        else:
            self.pipeline = checkpoint.pipeline(self._settings)
            self._intake.go_to(checkpoint.place)

    def _advance(self, patience: float) -> None:
        """One measurement stepped, or one item read."""
        if self._ready:
            self.pipeline.step(self._ready.popleft())
            return
        if place := self._intake.place:
            self._checkpoints.add(self.pipeline, place)
        item = self._intake.get(patience)
        if item is not None:
            self._ready.extend(self.pipeline.admit(item))
        elif self._intake.done:
            self._intake.check()
            self._ready.extend(self.pipeline.flush())
            self.done = not self._ready
