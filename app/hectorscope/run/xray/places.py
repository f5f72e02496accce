"""Room, corridor and open water: a simulated scan of each, on which covariances are compared."""

from collections.abc import Mapping
from functools import cache
from types import MappingProxyType
from typing import Literal

from hectorscope.run.checkpoints import Checkpoint, Place
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from hectorscope.run.xray.match_problem import MatchProblem, problem_of
from hectorscope.simulation import ScenarioName, SceneOptions, Simulation
from slam_core.config import SlamConfig
from slam_core.measurements import LaserScan

Kind = Literal["room", "corridor", "water"]
# The drive through the corridor lasts until its near end is too far away to count; the boat is behind the island.
DRIVES: Mapping[Kind, tuple[ScenarioName, float, float]] = MappingProxyType({
    "room": ("rooms", 0.0, 6.0),
    "corridor": ("corridor", 0.0, 20.0),
    "water": ("littoral", 14.0, 26.0),
})  # fmt: skip
SCAN_RATE, BEAMS, SEED = 10.0, 361, 1


@cache
def place(kind: Kind) -> MatchProblem:
    """The last scan of a short drive there, by the default settings; always the same. It takes about a second."""
    scenario, begin, duration = DRIVES[kind]
    options = SceneOptions(begin=begin, duration=duration, scan_rate=SCAN_RATE, beams=BEAMS, seed=SEED)
    settings = Settings(SlamConfig())
    pipeline = Pipeline(settings)
    measured = [each for item in Simulation(scenario, options).items() for each in pipeline.admit(item)]
    last = max(k for k, each in enumerate(measured) if isinstance(each, LaserScan))
    for each in measured[:last]:
        pipeline.step(each)
    before = Checkpoint(pipeline, Place(0, None), None).pipeline(settings)
    pipeline.step(measured[last])
    assert pipeline.result is not None
    found = problem_of(before, pipeline.result, settings.start)
    assert found is not None
    return found
