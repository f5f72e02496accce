"""Other scans of a recording than the shown one, for those who look into the matcher by themselves."""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from hectorscope.inputs import Item, Rereadable
from hectorscope.run.checkpoints import Checkpoint, Checkpoints
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from hectorscope.session.rework import Rework
from slam_core.config import SlamConfig
from slam_core.errors import SlamError
from slam_core.measurements import Float64s, LaserScan, Measurement
from slam_core.results import StepResult

SLACK_NS = 1_000  # the times of the rows are rounded
NEAR = 2  # times the last interval between scans
ABSENT = "this recording cannot be read at two places"


@dataclass(frozen=True, eq=False)
class Reached:
    """A scan, as the run processed it: the run before it, its result, and the configuration in force."""

    rework: Rework
    result: StepResult
    config: SlamConfig


@dataclass(frozen=True, eq=False)
class OtherScans:
    """Goes to any scan of a run by a reading of its own: on any thread, while the run goes on.

    times: (n,) of the scans that are known, seconds since the start. begun: makes the pipeline of the first scan.
    """

    source: Rereadable
    start_ns: int
    times: Float64s
    settings: Settings
    checkpoints: Checkpoints
    begun: Callable[[Settings], Pipeline]

    def time_of(self, near_s: float, by: int) -> float | None:
        """The time of the known scan nearest to a time, or of one so many scans behind it; None without any."""
        if not len(self.times):
            return None
        nearest = int(np.abs(self.times - near_s).argmin())
        return float(self.times[min(max(nearest + by, 0), len(self.times) - 1)])

    def way_to(self, seconds: float, slice_s: float) -> Iterator[Reached | None]:
        """Gives None after each slice of work, and the scan of that time at last. SlamError if it is not there."""
        target_ns = self.start_ns + round(seconds * 1e9) - SLACK_NS
        source = self.source.again()
        if source is None:
            raise SlamError(ABSENT)
        try:
            earlier = self.checkpoints.before(target_ns)
            pipeline = earlier.pipeline(self.settings) if earlier else self.begun(self.settings)
            items = source.items_from(earlier.place.state) if earlier else source.items()
            yield from _processed(pipeline, items, target_ns, earlier, slice_s)
        finally:
            source.close()


def _processed(
    pipeline: Pipeline, items: Iterator[Item], target_ns: int, earlier: Checkpoint | None, slice_s: float
) -> Iterator[Reached | None]:
    ends = time.monotonic() + slice_s
    for measurement in _measurements(pipeline, items):
        before = _before(pipeline, measurement, target_ns, earlier)
        result = pipeline.step(measurement)
        if before is not None and result is not None and result.stamp_ns >= target_ns:
            yield Reached(before, result, pipeline.slam.config)
            return
        if time.monotonic() > ends:
            yield None
            ends = time.monotonic() + slice_s
    raise SlamError("the recording ends before that scan")


def _before(pipeline: Pipeline, scan: Measurement, target_ns: int, earlier: Checkpoint | None) -> Rework | None:
    """The run before a scan, if that may be the one: the time of a result is that of its scan or later."""
    if not isinstance(scan, LaserScan):
        return None
    last_ns = pipeline.last_scan_ns
    is_near = last_ns is None or scan.stamp_ns + NEAR * (scan.stamp_ns - last_ns) > target_ns
    return Rework(pipeline, scan.stamp_ns, earlier) if is_near else None


def _measurements(pipeline: Pipeline, items: Iterator[Item]) -> Iterator[Measurement]:
    for item in items:
        yield from pipeline.admit(item)
    yield from pipeline.flush()
