"""The boat in littoral waters without satellites for a while, and without its laser for a while."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.accuracy import process
from hectorscope.run.pipeline import Pipeline
from hectorscope.simulation import SceneOptions, Simulation
from hectorscope.simulation.sensors import START_NS
from slam_core.config import SlamConfig, with_value
from slam_core.evaluation.trajectory import Trajectory, interpolate
from slam_core.measurements import Float64s, LaserScan

ALONE = with_value(with_value(SlamConfig(), "aiding.gps", False), "aiding.compass", False)
LASER_FAILS = (25.0, 35.0)  # s


@dataclass(frozen=True, slots=True)
class Outage:
    """Metres in the plane: error when what was missing returns, worst after, and the largest jump of any scan.

    A jump is what the pose moves from one scan to the next beyond what the robot did.
    """

    at_return: float
    after: float
    jump: float


def satellites_fail(options: SceneOptions, config: SlamConfig | None = None) -> Outage:
    """The scene as it is: no satellites for 30 s in the middle, behind the island."""
    simulation = Simulation("littoral", options)
    back = simulation.duration / 2 + simulation.scene.gps_outage / 2
    return _outage(process(simulation.items(), config or SlamConfig()), back)


def laser_fails(options: SceneOptions, config: SlamConfig | None = None) -> Outage:
    """Satellites all the time, but no scans for ten seconds."""
    simulation = Simulation("littoral", replace(options, gps_outage=0.0))
    begin_ns, end_ns = (START_NS + round(t * 1e9) for t in LASER_FAILS)
    items = (i for i in simulation.items() if not (isinstance(i, LaserScan) and begin_ns < i.stamp_ns < end_ns))
    return _outage(process(items, config or SlamConfig()), LASER_FAILS[1])


def _outage(pipeline: Pipeline, back: float) -> Outage:
    truth, covered = interpolate(Trajectory.from_rows(pipeline.truth), pipeline.trajectory[:, 0])
    rows = pipeline.trajectory[covered]
    error: Float64s = rows[:, 1:3] - truth.positions[:, :2]
    size = np.hypot(*error.T)
    after = rows[:, 0] >= back
    return Outage(
        float(size[after][0]), float(size[after].max()), float(np.hypot(*np.diff(error, axis=0).T).max())
    )


def _satellites(seed: int) -> Outage:
    return satellites_fail(SceneOptions(seed=seed))


def _laser(seed: int) -> Outage:
    return laser_fails(SceneOptions(seed=seed))


def _laser_alone(seed: int) -> Outage:
    return laser_fails(SceneOptions(seed=seed), ALONE)


OUTAGE_SEEDS = (1, 2, 3)
OUTAGES: dict[str, Callable[[int], Outage]] = {
    "satellites": _satellites,
    "laser, with satellites and compass": _laser,
    "laser, with neither": _laser_alone,
}
