"""The wide search on a map that is known."""

import numpy as np
import pytest

from slam_core import geometry
from slam_core.config import MapConfig, SlamConfig
from slam_core.kernels.correlative import count_near_hits
from slam_core.mapping.grid import GridLevel
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.correlative import find_pose, pool
from slam_core.matching.matcher import coarse_to_fine
from slam_core.scan.stabilise import stabilise
from tests.worlds import room_scan, standing

CONFIG = SlamConfig(map=MapConfig(size=400))
WINDOW = (1.5, 0.8)


def level_scan(pose):
    """Endpoints of the test room seen from `pose`."""
    return stabilise(room_scan(pose), standing, CONFIG.scan)


@pytest.fixture(scope="module")
def room():
    """The test room, mapped from five places."""
    pyramid = Pyramid(CONFIG.map)
    for pose in np.array([[0, 0, 0], [1, -1, 1], [-1, 1, 2], [-2, -1, 3], [0.5, 0.5, -1.5]], float):
        scan = level_scan(pose)
        pyramid.update(scan.points, scan.cleared, scan.laser, pose, CONFIG.map)
    return pyramid


def test_the_pose_is_found_from_anywhere_in_the_window(room):
    """Wherever the truth lies in the window, search and match end within 3 cm and 0.02 rad of it."""
    rng = np.random.default_rng(4)
    around = np.array([-0.3, 0.2, 3.0])  # the window reaches across the heading of pi
    for offset in np.vstack([rng.uniform(-1, 1, (15, 3)), [[1, 1, 1], [-1, -1, -1]]]):
        truth = around + offset * [WINDOW[0], WINDOW[0], WINDOW[1]]
        points = level_scan(truth).points
        found = find_pose(room.levels[-1], points, around, WINDOW)
        error = coarse_to_fine(room, points, found, CONFIG.matcher).pose - truth
        error[2] = geometry.wrap(error[2])
        assert np.abs(error).max() < 0.03


def test_the_result_lies_in_the_window_and_its_heading_is_wrapped(room):
    """No further than one fine step beyond the window, and the heading between -pi and pi."""
    around = np.array([0.0, 0.0, 3.1])
    points = level_scan(np.array([2.0, 0.0, -2.0])).points
    found = find_pose(room.levels[-1], points, around, (0.3, 0.2))
    assert np.abs(found[:2]).max() <= 0.3 + room.levels[-1].resolution
    assert abs(geometry.wrap(found[2] - 3.1)) <= 0.2 + 0.03
    assert abs(found[2]) <= np.pi


def test_equal_fits_are_decided_the_same_way(room):
    """On a map without anything every pose fits alike: the first in order wins, every time."""
    empty = GridLevel(0.2, (100, 100), np.array([-10.0, -10.0]))
    points = level_scan(np.zeros(3)).points
    first, again = (find_pose(empty, points, np.zeros(3), (0.8, 0.12)) for _ in range(2))
    assert first.tobytes() == again.tobytes()
    np.testing.assert_allclose(first, [-1.0, -1.0, -0.15])


def test_pooling_takes_the_largest_neighbour():
    """As the maximum over nine shifted copies of the cells with a border of nothing."""
    cells = np.random.default_rng(0).random((9, 12)).astype(np.float32)
    padded = np.pad(cells, 1)
    shifted = [padded[dy : dy + 9, dx : dx + 12] for dy in range(3) for dx in range(3)]
    np.testing.assert_array_equal(pool(cells), np.max(shifted, axis=0))


def test_a_wall_beside_the_border_of_its_cells_is_hit(room):
    """An end hits if one of the four nearest cells is occupied; it misses if none is, and all are known."""
    level, rng = room.levels[0], np.random.default_rng(2)
    points, poses = level_scan(np.zeros(3)).points, rng.uniform(-0.3, 0.3, (5, 3))
    counts = np.empty((len(poses), 2), np.int32)
    count_near_hits(level.cells, level.corner, 1.0 / level.resolution, points, poses, counts)
    for pose, (known, hits) in zip(poses, counts, strict=True):
        ends = geometry.transform_points(pose, points).T
        u, v = np.floor(ends / level.resolution - 0.5).astype(int) - level.corner[:, None]
        four = np.stack([level.log_odds[v + j, u + i] for j in (0, 1) for i in (0, 1)])
        hit = (four > 0).any(axis=0)
        assert hits == hit.sum()
        assert known == (hit | (four != 0).all(axis=0)).sum()
