"""Another run of the recording that is shown, at the same time of it: both are compared at each instant."""

import logging
import time
from functools import partial

from hectorscope.inputs import Rereadable, Source
from hectorscope.run.checkpoints import Checkpoints
from hectorscope.run.map_difference import share_that_differs
from hectorscope.run.map_image import MapImage
from hectorscope.run.map_images import level_image
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.rows import GrowingRows
from hectorscope.run.series import SERIES_DTYPE
from hectorscope.session.head import Head
from hectorscope.session.runs import NamedRun, RunsError
from hectorscope.session.snapshot import Compared
from slam_core.localization.prior_map import PriorMap
from slam_core.measurements import LaserScan

APART_S = 1 / 2  # of the recording, between two comparisons of the maps
MAPS_S = 1 / 2  # between two pictures of its map, while it goes on

_logger = logging.getLogger("hectorscope")


class Companion(Head):
    """A pipeline that stays at a time: it stops before the first scan behind it, and goes back by checkpoints."""

    until_ns = 0

    def follow(self, time_ns: int) -> None:
        """Its time from now on. What lies behind it is reached from the last checkpoint before."""
        if time_ns == self.until_ns:
            return
        self.until_ns = time_ns
        checkpoint, now_ns = self._checkpoints.before(time_ns), self.pipeline.time_ns
        if time_ns < now_ns or (checkpoint and checkpoint.time_ns > now_ns):
            self._go_to(checkpoint)

    @property
    def is_there(self) -> bool:
        """Whether there is nothing more to step up to its time."""
        following = self._ready[0] if self._ready else None
        return self.done or (isinstance(following, LaserScan) and following.stamp_ns > self.until_ns)

    def advance(self, seconds: float) -> None:
        """Run on for about so long, and not beyond its time."""
        ends = time.monotonic() + seconds
        try:
            while not self.is_there and (left := ends - time.monotonic()) > 0.0:
                self._advance(left)
        except Exception as error:  # as of the head: what is shown goes on
            _logger.warning("the run that is compared with ended early: %s", error)
            self.done = True


class Comparison:
    """The run that the shown one is compared with. It belongs to the engine's thread; close it at the end."""

    def __init__(
        self, run: NamedRun, source: Source, start_ns: int | None, prior_map: PriorMap | None, known: Checkpoints
    ) -> None:
        """known: checkpoints that both runs share, with its budget. RunsError if there is no second reading."""
        again = source.again() if isinstance(source, Rereadable) else None
        if again is None:
            raise RunsError(f"{source.name} cannot be read at two places, so no run of it can be compared")
        self.run = run
        begun = partial(Pipeline, start_ns=start_ns, prior_map=prior_map, live=False)
        self._companion = Companion(again, begun, run.settings, known)
        self._map: MapImage | None = None
        self._drawn: tuple[Pipeline, int] | None = None
        self._drawn_at = 0.0
        self._apart = GrowingRows(2)

    def advance(self, seconds: float, time_ns: int) -> bool:
        """Follow the shown run to its time for about so long; whether there was something to do."""
        self._companion.follow(time_ns)
        if self._companion.is_there:
            return False
        self._companion.advance(seconds)
        return True

    def close(self) -> None:
        """Stop reading."""
        self._companion.close()

    def state(self, shown: Pipeline) -> Compared:
        """For a snapshot, with the run that is shown."""
        pipeline = self._companion.pipeline
        self._draw(pipeline)
        if self._companion.is_there and shown.time_ns == pipeline.time_ns:
            self._compare_maps(shown)
        return Compared(
            number=self.run.number,
            name=self.run.name,
            settings=self.run.settings,
            whole=self._companion.is_there,
            trajectory=pipeline.trajectory,
            truth_in_map=pipeline.truth_in_map,
            series=pipeline.series.view(SERIES_DTYPE).reshape(-1),
            map=self._map,
            map_apart=self._apart.view,
        )

    def _compare_maps(self, shown: Pipeline) -> None:
        """One row more some times a second of the recording; after a jump back they begin anew."""
        if not shown.scans or shown.slam.map.empty or self._map is None:
            return
        seconds = float(shown.trajectory[-1, 0])
        last = float(self._apart.view[-1, 0]) if len(self._apart) else -APART_S
        if last <= seconds < last + APART_S:
            return
        if seconds < last:
            self._apart = GrowingRows(2)
        self._apart.append((seconds, share_that_differs(level_image(shown.slam.map, 0), self._map)))

    def _draw(self, pipeline: Pipeline) -> None:
        """Its finest level, some times a second, and once more where it stays."""
        state, now = (pipeline, pipeline.slam.map.revision), time.monotonic()
        due = self._companion.is_there or now - self._drawn_at >= MAPS_S
        if pipeline.slam.map.empty or state == self._drawn or not due:
            return
        revision = self._map.revision + 1 if self._map else 0
        self._map = level_image(pipeline.slam.map, 0, revision)
        self._drawn, self._drawn_at = state, now
