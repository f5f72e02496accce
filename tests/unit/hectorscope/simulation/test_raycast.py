"""Rays against triangles."""

import numpy as np
import pytest

from hectorscope.simulation.raycast import MISS, cast, column_grid


def brute_force(triangles: np.ndarray, origin: np.ndarray, direction: np.ndarray) -> float:
    """Nearest hit by the plane's equation and signed areas, one triangle after the other."""
    nearest = np.inf
    for a, b, c in triangles:
        normal = np.cross(b - a, c - a)
        facing = normal @ direction
        if abs(facing) < 1e-12:
            continue
        t = normal @ (a - origin) / facing
        point = origin + t * direction
        sides = [normal @ np.cross(q - p, point - p) for p, q in ((a, b), (b, c), (c, a))]
        if 0 < t < nearest and min(sides) >= 0:
            nearest = t
    return nearest


@pytest.mark.parametrize("cell", [0.3, 1.0, 20.0])
def test_agrees_with_brute_force(cell: float) -> None:
    """Whatever the size of the columns, every ray finds the nearest of 60 random triangles."""
    rng = np.random.default_rng(3)
    centres = rng.uniform(-4, 4, (60, 1, 3))
    triangles = centres + rng.normal(scale=0.9, size=(60, 3, 3))
    origins = rng.uniform(-4, 4, (300, 3))
    directions = rng.normal(size=(300, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    distances, hits = cast(column_grid(triangles, cell), origins, directions, 100.0)
    expected = [brute_force(triangles, o, d) for o, d in zip(origins, directions, strict=True)]
    np.testing.assert_allclose(distances, expected, rtol=1e-9)
    assert 50 < np.count_nonzero(hits != MISS) < 290


@pytest.mark.parametrize("direction", [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)])
def test_rays_along_the_axes(direction: tuple[int, int, int]) -> None:
    """A ray that stays in one row or one column of the grid finds what it should."""
    d = np.array([direction], dtype=np.float64)
    side, up = np.roll(d[0], 1), np.roll(d[0], 2)
    centre = 2.5 * d[0]
    triangles = np.array([[centre - side - up, centre + 2 * side - up, centre - side + 2 * up]])
    for sign in (1.0, -1.0):
        distances, _ = cast(column_grid(triangles, 0.5), np.zeros((1, 3)), sign * d, 10.0)
        assert distances[0] == (pytest.approx(2.5) if sign > 0 else np.inf)


def test_reach() -> None:
    """What lies beyond the reach is not hit."""
    triangles = np.array([[(5.0, -1.0, -1.0), (5.0, 1.0, -1.0), (5.0, 0.0, 2.0)]])
    grid, x = column_grid(triangles, 1.0), np.array([[1.0, 0.0, 0.0]])
    assert cast(grid, np.zeros((1, 3)), x, 5.1)[0][0] == pytest.approx(5.0)
    assert cast(grid, np.zeros((1, 3)), x, 4.9)[0][0] == np.inf
