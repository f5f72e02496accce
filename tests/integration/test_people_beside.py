"""People who walk beside a slow scanner that nothing else helps."""

from collections.abc import Iterator
from itertools import takewhile

import numpy as np

from benchmarks.accuracy import process
from hectorscope.inputs import Item
from hectorscope.simulation import SceneOptions, Simulation
from slam_core.config import SlamConfig, with_value
from slam_core.evaluation.trajectory import Trajectory, align, interpolate, move

OFFICES = SceneOptions(scan_rate=4.7, beams=361, seed=3, imu=False)
SHORT_NS = 45_000_000_000


def beginning() -> Iterator[Item]:
    """Out of the first office and along the corridor, in the midst of people."""
    items = Simulation("offices", OFFICES).items()
    first = next(items)
    yield first
    yield from takewhile(lambda item: item.stamp_ns < first.stamp_ns + SHORT_NS, items)


def worst_error(delay: float) -> float:
    """Metres, of the positions after alignment."""
    pipeline = process(list(beginning()), with_value(SlamConfig(), "map.appearance_delay", delay))
    ours = Trajectory.from_rows(pipeline.trajectory)
    truth, covered = interpolate(Trajectory.from_rows(pipeline.truth), ours.times)
    poses = ours.planar[covered]
    away = poses - move(align(truth.planar[:, :2], poses[:, :2]), truth.planar)
    return float(np.hypot(*away[:, :2].T).max())


def test_the_match_does_not_follow_them() -> None:
    """They take up to a fifth of the beams, and keep pace with the robot. Written at once, they carry it away."""
    assert worst_error(SlamConfig().map.appearance_delay) < 0.1
    assert worst_error(0.0) > 1.0
