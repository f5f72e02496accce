"""The cost of eq. (7) at many poses at once."""

import numpy as np

from slam_core.config import MapConfig
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.landscape import costs
from slam_core.matching.matcher import beams_of, normal_equations
from tests.worlds import room_ranges

ANGLES = np.linspace(-np.pi, np.pi, 360, endpoint=False)


def scan() -> np.ndarray:
    """(360, 2) endpoints in a room."""
    ranges = room_ranges(np.zeros(3), ANGLES)
    return np.column_stack([ranges * np.cos(ANGLES), ranges * np.sin(ANGLES)]).astype(np.float32)


def test_each_cost_is_that_of_the_matcher():
    """The same numbers as those of one pose after another, on every level."""
    pyramid = Pyramid(MapConfig(size=256))
    pyramid.update(scan(), np.empty((0, 2), np.float32), np.zeros(2), np.zeros(3), MapConfig(size=256))
    poses = np.random.default_rng(1).uniform(-0.5, 0.5, (40, 3))
    for level in pyramid.levels:
        one_by_one = [normal_equations(level, beams_of(scan()), pose)[2] for pose in poses]
        np.testing.assert_allclose(costs(level, scan(), poses), one_by_one, rtol=1e-6)


def test_it_costs_least_where_the_map_was_drawn():
    """Of a grid of poses around it, on every level."""
    pyramid = Pyramid(MapConfig(size=256))
    pyramid.update(scan(), np.empty((0, 2), np.float32), np.zeros(2), np.zeros(3), MapConfig(size=256))
    offsets = np.linspace(-0.4, 0.4, 9)
    poses = np.stack(np.meshgrid(offsets, offsets, [-0.1, 0.0, 0.1]), axis=-1).reshape(-1, 3)
    for level in pyramid.levels:
        assert np.abs(poses[np.argmin(costs(level, scan(), poses))]).max() < 1e-9
