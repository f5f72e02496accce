"""The circuits of bare corridors: what the car's laser sees, and that it keeps between the walls."""

import numpy as np
import pytest

from benchmarks.circuits import DEPTH, FIRST, HALF, LASER, SCANNER, Shape, circuit
from slam_core.measurements import LaserScan, TruthPose


def scans(shape: Shape, seconds: float, seed: int = 1) -> list[LaserScan]:
    """Of the begin of a drive at 2 m/s."""
    return [item for item in circuit(shape, 2.0, seed, seconds) if isinstance(item, LaserScan)]


@pytest.mark.parametrize("shape", ["square", "winding"])
def test_the_walls_are_beside_the_way(shape: Shape) -> None:
    """On both sides as far as half the width, all the way; nothing is nearer than a box."""
    for scan in scans(shape, 20.0)[::40]:
        angles = scan.angle_min + scan.angle_increment * np.arange(len(scan.ranges))
        nearest = [float(scan.ranges[angles * side > 0.5].min()) for side in (1.0, -1.0)]
        assert HALF[shape] - max(DEPTH) - 0.15 < min(nearest) and max(nearest) < HALF[shape] + 0.15


def test_few_beams_end_on_the_ends_of_boxes() -> None:
    """At rest the front of the box ahead stops a hundredth of them; those straight ahead do not return."""
    scan = scans("square", 3.0)[0]
    angles = scan.angle_min + scan.angle_increment * np.arange(len(scan.ranges))
    returned = np.isfinite(scan.ranges)
    ranges, bearings = scan.ranges[returned], angles[returned]
    x, y = ranges * np.cos(bearings) + LASER[0], ranges * np.sin(bearings)
    ahead = min(each for each in FIRST if each > 0.0)
    face = (np.abs(x - ahead) < 0.05) & (y < DEPTH[0] - HALF["square"]) & (y > -HALF["square"] - 0.05)
    assert 3 <= np.count_nonzero(face) < 0.015 * len(angles)
    assert not returned[np.abs(angles) < 0.08].any()
    assert ranges.max() < SCANNER.range_max + 0.1


def test_a_seed_gives_the_same_drive() -> None:
    """Another one other noise; the truth is that of the same way."""
    first, again, other = (circuit("square", 2.0, seed, 3.0) for seed in (1, 1, 2))
    for a, b, c in zip(first, again, other, strict=True):
        if isinstance(a, LaserScan) and isinstance(b, LaserScan) and isinstance(c, LaserScan):
            np.testing.assert_array_equal(a.ranges, b.ranges)
            assert not np.array_equal(a.ranges, c.ranges)
        else:
            assert isinstance(a, TruthPose) and isinstance(c, TruthPose) and a.stamp_ns == c.stamp_ns
            np.testing.assert_array_equal(a.T_map_base.translation, c.T_map_base.translation)
