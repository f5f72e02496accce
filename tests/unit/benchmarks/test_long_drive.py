"""The streets of the long drive: what a laser sees in them, and that wheels and truth agree."""

import math

import numpy as np

from benchmarks.streets import ACCELERATION, BEAMS, RATE, VIEW, Streets, drive, scan, streets
from slam_core.config import SlamConfig
from slam_core.slam import HectorSlam


def test_a_beam_goes_through_openings_to_the_wall():
    """Two rooms side by side are one where they touch; beyond the range there is no return."""
    world = Streets(np.zeros((2, 2)), np.array([[-2.0, 3.0, -1.0, 1.0], [3.0, 50.0, -0.5, 4.0]]))
    seen = scan(world, np.array([0.0, 0.0, 0.0]), 0, np.random.default_rng(0))

    def at(degrees: float) -> float:
        return float(seen.ranges[round((math.radians(degrees) + 0.5 * VIEW) / VIEW * (BEAMS - 1))])

    assert math.isinf(at(0.0))
    assert abs(at(90.0) - 1.0) < 0.06
    assert abs(at(-90.0) - 1.0) < 0.06
    assert abs(at(45.0) - math.sqrt(2.0)) < 0.06


def test_wheels_lead_along_the_way():
    """The velocities add up to the poses, and the last pose is the end of the way."""
    world, pose = streets([3.0, 5.0]), np.zeros(3)
    for odometry, _, truth in drive(world):
        pose[2] += odometry.yaw_rate / RATE
        step = odometry.velocity[0] / RATE
        pose[:2] += step * np.array([math.cos(pose[2]), math.sin(pose[2])])
        assert np.abs(pose[:2] - truth[:2]).max() < 0.5  # a part of a step is taken for a whole one
    np.testing.assert_allclose(truth[:2], world.corners[-1])
    assert world.length == 8.0


def test_wheels_gather_and_lose_speed_as_a_base_can():
    """A speed that leaps would count as slip. Short legs are driven more slowly."""
    speeds = np.array([odometry.velocity[0] for odometry, _, _ in drive(streets([2.0, 20.0]))])
    assert np.abs(np.diff(speeds, prepend=0.0, append=0.0)).max() < ACCELERATION / RATE + 1e-9
    assert 5.0 < speeds.max() <= 8.0


def test_the_end_of_the_way_is_found():
    """Streets and corridors at 8 m/s, where little besides the wheels tells how far the base has come."""
    slam, pose = HectorSlam(SlamConfig()), np.zeros(3)
    for odometry, seen, truth in drive(streets([100.0, 60.0])):
        slam.add(odometry)
        slam.add(seen)
        pose = truth
    slam.finish()
    assert np.hypot(*(slam.trajectory.positions[-1, :2] - pose[:2])) < 0.5
