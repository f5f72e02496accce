"""The last scan, ready to be processed again: what a changed setting does to it is seen while the run rests."""

from collections.abc import Callable

from hectorscope.run.checkpoints import Checkpoint, Place
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings

Act = Callable[[Pipeline], object]


class Rework:
    """The pipeline as it was before a scan, and what it was given since.

    scan_ns: the stamp of that scan, from which on a change acts. earlier: a checkpoint of the same run before it,
    with which tiles of the map are shared.
    """

    def __init__(self, pipeline: Pipeline, scan_ns: int, earlier: Checkpoint | None) -> None:
        self.scan_ns = scan_ns
        self._before = Checkpoint(pipeline, Place(0, None), earlier)
        self._since: list[Act] = []

    def note(self, act: Act) -> None:
        """The pipeline was given something: an item, a measurement or the end."""
        self._since.append(act)

    def before(self, settings: Settings) -> Pipeline:
        """Another pipeline as it was before the scan; safe on any thread, since what is kept does not change."""
        return self._before.pipeline(settings)

    def again(self, settings: Settings) -> Pipeline:
        """Another pipeline at the same instant, as if these settings had been there before the scan."""
        pipeline = self._before.pipeline(settings)
        for act in self._since:
            act(pipeline)
        return pipeline
