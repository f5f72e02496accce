"""Worlds and their shapes."""

import numpy as np
import pytest

from hectorscope.simulation.raycast import MISS
from hectorscope.simulation.worlds import CEILING, GROUND, Surface, World, box, post, quad, wall

X, DOWN, UP = (np.array([d], dtype=np.float64) for d in [(1, 0, 0), (0, 0, -1), (0, 0, 1)])


def at(x: float, y: float, z: float) -> np.ndarray:
    return np.array([[x, y, z]])


def test_a_wall_has_its_thickness_and_its_doorway() -> None:
    """Beams stop at the near face of the wall and pass through the gap."""
    world = World([Surface(wall((3, -2), (3, 2), 0, 2, 0.2, gaps=[(2.5, 3.5)]))])
    assert world.cast(at(0, 0, 1), X, 30)[0][0] == pytest.approx(2.9)
    assert world.cast(at(0, 1, 1), X, 30)[0][0] == np.inf
    assert world.cast(at(0, 1.6, 1), X, 30)[0][0] == pytest.approx(2.9)


def test_ground_ceiling_and_what_hides_them() -> None:
    """Levels are hit where nothing stands in front of them."""
    world = World([Surface(box(-1, -1, 1, 1, 0, 1))], ground=0.0, ceiling=2.5)
    distances, hits = world.cast(at(3, 0, 2), DOWN, 30)
    assert distances[0] == pytest.approx(2.0)
    assert hits[0] == GROUND
    distances, hits = world.cast(at(3, 0, 2), UP, 30)
    assert distances[0] == pytest.approx(0.5)
    assert hits[0] == CEILING
    distances, hits = world.cast(at(0, 0, 2), DOWN, 30)
    assert distances[0] == pytest.approx(1.0)
    assert hits[0] >= 0


def test_water_returns_nothing() -> None:
    """A beam that reaches the water is lost; one that meets a post before is not."""
    world = World([Surface(post(5, 0, 0.5, -1, 3))], ground=0.0, water=True)
    slope = np.array([[np.cos(0.1), 0.0, -np.sin(0.1)]])
    low, hits = world.cast(at(0, 0, 0.2), slope, 30)
    assert low[0] == np.inf
    assert hits[0] == MISS
    assert world.cast(at(0, 0, 2.0), slope, 30)[0][0] == pytest.approx(4.5 / np.cos(0.1), abs=0.05)


def test_height_of_a_ramp() -> None:
    """A wheel stands on the ramp where there is one and on the ground elsewhere."""
    ramp = quad((0, -1, 0), (2, -1, 0.5), (2, 1, 0.5), (0, 1, 0))
    world = World([Surface(ramp)], ground=-0.1)
    heights = world.floor_height(np.array([0.5, 1.0, 1.9, 3.0]), np.array([0.0, 0.7, -0.9, 0.0]))
    np.testing.assert_allclose(heights, [0.125, 0.25, 0.475, -0.1], atol=1e-9)


def test_depth_belongs_to_its_surface() -> None:
    """Every triangle knows how deep beams enter it."""
    world = World([Surface(box(0, 0, 1, 1, 0, 1)), Surface(box(2, 0, 3, 1, 0, 1), depth=0.1)])
    _, hits = world.cast(np.array([[-1, 0.5, 0.5], [4.0, 0.5, 0.5]]), np.concatenate((X, -X)), 30)
    np.testing.assert_allclose(world.depths[hits], [0.0, 0.1])
