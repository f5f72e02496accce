"""Section IV-C: the levels share one corner and one scan."""

import numpy as np
import pytest

from slam_core.config import MapConfig
from slam_core.pyramid import Pyramid

CONFIG = MapConfig(size=256, levels=3, start_x=0.25, start_y=0.75)


def written(config=CONFIG):
    """A pyramid with one scan of two walls in it."""
    pyramid = Pyramid(config)
    ys = np.linspace(-1.5, 1.5, 200, dtype=np.float32)
    points = np.column_stack([np.full_like(ys, 2.0), ys])
    pyramid.update(points, np.empty((0, 2), np.float32), np.zeros(2), np.array([0.3, -0.4, 0.2]), config)
    return pyramid


def test_each_level_has_half_the_resolution_and_the_same_extent():
    """Cell length doubles, cells on a side halve, and the corner is the same for all."""
    levels = Pyramid(CONFIG).levels
    assert [level.resolution for level in levels] == pytest.approx([0.05, 0.1, 0.2])
    assert [level.shape for level in levels] == [(256, 256), (128, 128), (64, 64)]
    assert all((level.origin == levels[0].origin).all() for level in levels)


def test_start_offset_places_the_origin():
    """The map's start lies at the given fractions of its width and height."""
    np.testing.assert_allclose(Pyramid(CONFIG).levels[0].origin, [-0.25 * 12.8, -0.75 * 12.8])


def test_levels_are_updated_together_and_agree():
    """A fine occupied cell lies in a coarse occupied cell, on every level."""
    pyramid = written()
    rows, columns = np.nonzero(pyramid.levels[0].log_odds > 0)
    assert len(rows) > 30
    for k, level in enumerate(pyramid.levels[1:], 1):
        assert (level.log_odds[rows >> k, columns >> k] > 0).all()


def test_copy_is_independent():
    """Writing to a copy leaves the original alone: that is what checkpoints stand on."""
    pyramid = written()
    before = pyramid.levels[0].log_odds.copy()
    other = pyramid.copy()
    other.update(np.ones((5, 2), np.float32), np.empty((0, 2), np.float32), np.zeros(2), np.zeros(3), CONFIG)
    np.testing.assert_array_equal(pyramid.levels[0].log_odds, before)
    assert (pyramid.updates, other.updates) == (1, 2)
