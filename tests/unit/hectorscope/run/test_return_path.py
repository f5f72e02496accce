"""The way back to the start."""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from hectorscope.run.map_image import MapImage
from hectorscope.run.return_path import CLEARANCE, return_path

RESOLUTION = 0.05


def room(width: float = 10.0, height: float = 6.0) -> MapImage:
    """Free cells with walls around, the lower left corner at the origin."""
    cells = np.ones((round(height / RESOLUTION), round(width / RESOLUTION)), np.uint8)
    cells[:2], cells[-2:], cells[:, :2], cells[:, -2:] = 2, 2, 2, 2
    return MapImage(0, RESOLUTION, 0.0, 0.0, cells, 1)


def driven(*corners: tuple[float, float]) -> NDArray[np.float64]:
    """A trajectory along corners, a row each 5 cm."""
    parts = [np.linspace(a, b, max(2, int(np.hypot(*np.subtract(b, a)) / 0.05))) for a, b in pairwise(corners)]
    rows = np.zeros((sum(map(len, parts)), 8))
    rows[:, 1:3] = np.concatenate(parts)
    return rows


def length(path: NDArray[np.float64]) -> float:
    """Of a polyline, metres."""
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())


def test_it_is_shorter_than_the_way_that_was_driven() -> None:
    """From the last position to the first, straight over free ground."""
    trajectory = driven((1.0, 1.0), (9.0, 1.0), (9.0, 5.0), (1.0, 5.0))
    path = return_path(room(), trajectory)
    assert np.array_equal(path[[0, -1]], trajectory[[-1, 0], 1:3])
    assert length(path) < 5.0 < length(trajectory[:, 1:3])


def test_it_goes_around_walls_with_clearance() -> None:
    """Through the gap of a wall, in the middle of which the robot has never been."""
    level = room()
    level.cells[: round(4.0 / RESOLUTION), round(5.0 / RESOLUTION) : round(5.2 / RESOLUTION)] = 2
    trajectory = driven((2.0, 1.0), (2.0, 5.6), (8.0, 5.6), (8.0, 1.0))
    path = return_path(level, trajectory)
    rows, columns = np.nonzero(level.cells == 2)
    walls = (np.column_stack([columns, rows]) + 0.5) * RESOLUTION
    apart = np.linalg.norm(path[:, None] - walls[None], axis=2).min()
    assert apart > CLEARANCE - 0.1  # a cell of the search
    assert length(path) < length(trajectory[:, 1:3]) - 1.0


def test_unknown_ground_is_not_entered_but_where_the_robot_was() -> None:
    """Two rooms that a dark passage joins: the way leads through it as the robot came."""
    level = room()
    level.cells[:, round(4.0 / RESOLUTION) : round(6.0 / RESOLUTION)] = 0
    trajectory = driven((1.0, 1.0), (1.0, 5.0), (9.0, 5.0), (9.0, 1.0))
    path = return_path(level, trajectory)
    passage = path[(path[:, 0] > 4.1) & (path[:, 0] < 5.9)]
    assert len(passage) > 5
    assert np.allclose(passage[:, 1], 5.0, atol=0.15)


def test_without_a_map_it_is_the_trajectory_back() -> None:
    """Where the ends lie outside of the map there is nothing to search."""
    trajectory = driven((100.0, 1.0), (101.0, 1.0))
    assert np.array_equal(return_path(room(), trajectory), trajectory[::-1, 1:3])
