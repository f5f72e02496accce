"""Which beam of a sweep an endpoint is."""

import math

import numpy as np

from slam_core import geometry
from slam_core.config import ScanConfig
from slam_core.measurements import LaserScan
from slam_core.results import Sweep
from slam_core.scan.beams import beam_of, endpoint_of
from slam_core.scan.stabilise import stabilise

CONFIG = ScanConfig(range_min=0.4, range_max=20.0, z_min=-0.5, z_max=0.5)
N = 181


def leaning_turn(from_ns, since_ns):
    """A base that leans by 0.2 rad and turns during the sweep: some beams meet the ground or the sky."""
    angles = since_ns * 1e-9
    return np.array([[*geometry.from_euler(0.2, 0.0, float(angle)), 0.0, 0.0, 0.0] for angle in angles])


def sweep_of(ranges) -> tuple[Sweep, np.ndarray]:
    """A sweep over 180 degrees in 0.1 s, and its endpoints."""
    scan = LaserScan(0, np.asarray(ranges, np.float32), -math.pi / 2, math.pi / (N - 1), 0.1 / N, 0.1, 30.0)
    placed = stabilise(scan, leaning_turn, CONFIG)
    return Sweep(scan, scan.ranges, placed.poses, CONFIG, placed.laser), placed.points


def test_each_endpoint_finds_its_beam_and_the_beam_its_endpoint():
    """Beams out of range, without a return, and out of the band of heights have no endpoint."""
    ranges = np.random.default_rng(3).uniform(0.0, 25.0, N)
    ranges[::17] = np.nan
    sweep, points = sweep_of(ranges)
    beams = [beam_of(sweep, k) for k in range(len(points))]
    assert 0 < len(beams) < np.count_nonzero((ranges >= 0.4) & (ranges < 20.0))
    assert beams == sorted(set(beams))
    assert [endpoint_of(sweep, beam) for beam in beams] == list(range(len(points)))
    without = sorted(set(range(N)) - set(beams))
    assert {endpoint_of(sweep, beam) for beam in without} == {None}


def test_the_endpoint_lies_at_the_range_of_its_beam():
    """Without a change of place during the sweep, the distance in space is the range."""
    ranges = np.linspace(1.0, 19.0, N)
    sweep, points = sweep_of(ranges)
    heights = stabilise(sweep.scan, leaning_turn, CONFIG).heights
    for k in range(0, len(points), 7):
        distance = math.hypot(*points[k].tolist(), float(heights[k]))
        assert abs(distance - ranges[beam_of(sweep, k)]) < 1e-3
