"""For tests of the X-ray: a scan of a simulated drive with the run before it, and where its handle is gripped."""

from collections import Counter
from functools import cache, partial

import numpy as np
from playwright.sync_api import Page

from hectorscope.inputs import Item
from hectorscope.panels._xray_scene import HANDLE_PIXELS
from hectorscope.run.checkpoints import Checkpoints, Place
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from hectorscope.run.xray.match_problem import MatchProblem, problem_of
from hectorscope.session.other_scans import OtherScans
from hectorscope.session.rework import Rework
from hectorscope.simulation import SceneOptions, Simulation
from slam_core.config import SlamConfig, with_values
from slam_core.measurements import LaserScan
from slam_core.results import StepResult
from tests.scene import PROJECT
from tests.sources import MemoryRecording

SECONDS = 6.0
ARROW = 0.8  # of the handle: a place on the arrow of an axis
PAPER = with_values(SlamConfig.paper(), {"map.size": 512})


@cache
def drive() -> tuple[Item, ...]:
    """Some metres through rooms, ten scans a second."""
    return tuple(Simulation("rooms", SceneOptions(duration=SECONDS, scan_rate=10.0, beams=361, seed=3)).items())


@cache
def scanned(config: SlamConfig = PAPER) -> tuple[Rework, StepResult]:
    """The last scan, and the run before it."""
    pipeline, rework = Pipeline(Settings(config)), None
    ready = [measurement for item in drive() for measurement in pipeline.admit(item)]
    for measurement in ready:
        if isinstance(measurement, LaserScan):
            rework = Rework(pipeline, measurement.stamp_ns, None)
        pipeline.step(measurement)
    assert rework is not None and pipeline.result is not None
    return rework, pipeline.result


@cache
def other_scans(config: SlamConfig = PAPER) -> OtherScans:
    """Of the same drive, with a checkpoint halfway."""
    begun, settings, checkpoints = partial(Pipeline, live=False), Settings(config), Checkpoints()
    pipeline = begun(settings)
    for number, item in enumerate(drive()):
        for measurement in pipeline.admit(item):
            pipeline.step(measurement)
        if number == len(drive()) // 2:
            checkpoints.add(pipeline, Place(number + 1, Counter(items=number + 1)))
    start_ns, times = pipeline.start_ns or 0, pipeline.trajectory[:, 0].copy()
    return OtherScans(MemoryRecording(list(drive())), start_ns, times, settings, checkpoints, begun)


@cache
def problem(config: SlamConfig = PAPER) -> MatchProblem:
    """The same, opened."""
    rework, result = scanned(config)
    found = problem_of(rework.before(Settings(config)), result, config)
    assert found is not None
    return found


def grip(page: Page, start: np.ndarray, metres: float) -> tuple[np.ndarray, np.ndarray]:
    """Pixels of the window: on the arrow of the handle along the heading of a start, and so many metres ahead."""
    ahead = start[:2] + metres * np.array([np.cos(start[2]), np.sin(start[2])])
    at, aim = (np.array(page.evaluate(PROJECT, [*place.tolist(), 0.04])) for place in (start[:2], ahead))
    begin = at + ARROW * HANDLE_PIXELS * (aim - at) / np.hypot(*(aim - at))
    return begin, begin + (aim - at)
