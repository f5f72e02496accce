"""Measurements that something held up: they come together, or long after they were made."""

import pytest

from benchmarks import ensembles
from benchmarks.additions.faults import held_up
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from hectorscope.simulation import SceneOptions, Simulation
from slam_core.config import SlamConfig, with_value
from slam_core.diagnostics import TOO_LATE
from slam_core.measurements import LaserScan

ROOMS = SceneOptions(scan_rate=10.0, beams=361, duration=30.0)
LEAST_LATE = 3.0  # seconds, twice what the state buffer reaches back at least


def held(seconds: float, *, stamped: bool, history: float = 1.5) -> Pipeline:
    """A run through rooms whose scans of so many seconds come together. history: of the state buffer, seconds."""
    items = list(Simulation("rooms", ROOMS).items())
    config = with_value(SlamConfig(), "navigation.history", history)
    pipeline = Pipeline(Settings(config), items[0].stamp_ns)
    for item in held_up((LaserScan,), seconds, 10.0, stamped=stamped)(items, 1):
        for measurement in pipeline.admit(item):
            pipeline.step(measurement)
    return pipeline


@pytest.mark.parametrize(
    "what",
    ["scans of 1 s in 5 stamped together", "data of 1 s in 5 stamped together", "scans up to 3 s late in 10"],
)
@pytest.mark.parametrize("name", ["rooms", "handheld"])
def test_what_was_held_up_leads_nobody_astray(name: str, what: str) -> None:
    """The robot turns and drives on meanwhile: nothing is written at a wrong place."""
    found = ensembles.outcomes([ensembles.run(f"{name}, {what}", 2, {})])
    assert found[0].error < 0.03 and not (found[0].misplaced or found[0].silent)


def test_a_laser_alone_is_followed_through_scans_that_came_together() -> None:
    """Their steady rate is all that tells how the robot moved meanwhile."""
    (found,) = ensembles.outcomes([ensembles.run("arena, laser alone, scans of 1 s in 5 stamped together", 2, {})])
    assert found.error < 0.1 and not (found.misplaced or found.silent)


def test_scans_that_came_together_are_told() -> None:
    """With what was done about it; none of them is left out."""
    pipeline = held(1.0, stamped=True)
    assert any(text.startswith("scans came together after a pause") for text in pipeline.warned)
    assert not pipeline.skipped[TOO_LATE]


def test_scans_that_the_state_buffer_does_not_reach_are_left_out() -> None:
    """They are counted and told, and those that it reaches are used."""
    pipeline = held(LEAST_LATE, stamped=False)
    assert pipeline.skipped[TOO_LATE] >= 10
    assert any(text.startswith("scans come later than the state buffer") for text in pipeline.warned)
    assert not held(LEAST_LATE, stamped=False, history=LEAST_LATE).skipped[TOO_LATE]
