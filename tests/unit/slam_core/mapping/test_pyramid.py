"""Section IV-C: the levels share one corner and one scan."""

from dataclasses import replace

import numpy as np
import pytest

from slam_core.config import ConfigError, MapConfig
from slam_core.mapping.pyramid import NEAR, Pyramid, longest_gap, megabytes
from slam_core.mapping.tiles import TILE
from tests.worlds import same_map

CONFIG = MapConfig(size=512, levels=3, start_x=0.25, start_y=0.75)


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
    assert [level.shape for level in levels] == [(512, 512), (256, 256), (128, 128)]
    assert all((level.origin == levels[0].origin).all() for level in levels)


def test_start_offset_places_the_origin():
    """The map's start lies at the given fractions of its width and height."""
    np.testing.assert_allclose(Pyramid(CONFIG).levels[0].origin, [-0.25 * 25.6, -0.75 * 25.6])


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


SMALL = MapConfig(size=64, levels=3)
NOTHING = np.empty((0, 2), np.float32)


def beam(pyramid, x, y, config, start=(0.0, 0.0)):
    """One beam from `start` to x, y, metres in the map."""
    pose = np.array([*start, 0.0])
    pyramid.update(
        np.array([[x, y]], np.float32) - pose[:2].astype(np.float32), NOTHING, np.zeros(2), pose, config
    )


@pytest.mark.parametrize("size", [64, 65, 100, 127])
@pytest.mark.parametrize("levels", [1, 3, 6])
def test_the_first_window_holds_the_size_that_was_asked_for(size, levels):
    """It is rounded outwards to whole tiles, and to what windows move by; all levels cover the same area."""
    config = replace(SMALL, size=size, levels=levels, start_x=0.3)
    pyramid, step = Pyramid(config), max(TILE, 32 << (levels - 1))
    row0, row1, column0, column1 = pyramid.levels[0].box
    assert row0 <= -0.5 * size < row0 + step
    assert row1 - step < 0.5 * size <= row1
    assert column0 <= -0.3 * size < column0 + step
    assert column1 - step < 0.7 * size <= column1
    for i, level in enumerate(pyramid.levels):
        assert tuple(n << i for n in level.box) == pyramid.levels[0].box


def test_the_window_moves_only_when_a_beam_needs_it():
    """What lies in the first window leaves it alone; then it is around the robot, with room to go on."""
    pyramid = Pyramid(SMALL)
    beam(pyramid, 1.0, 1.0, SMALL)
    assert pyramid.levels[0].box == (-64, 64, -64, 64)
    beam(pyramid, 9.0, 0.0, SMALL)
    row0, row1, column0, column1 = first = pyramid.levels[0].box
    assert row1 - row0 == column1 - column0
    assert min(-row0, row1, -column0, column1) >= (9.0 + NEAR) / 0.05
    beam(pyramid, 11.0, 0.0, SMALL, start=(3.0, 0.0))
    assert pyramid.levels[0].box == first
    beam(pyramid, 68.0, 0.0, SMALL, start=(60.0, 0.0))
    row0, row1, column0, column1 = pyramid.levels[0].box
    assert column0 < 60.0 / 0.05 - 200
    assert column1 > 60.0 / 0.05 + 200
    assert pyramid.stored


def test_the_laser_and_cleared_beams_take_the_map_along():
    """A robot that sees its nearest walls only, or clears without an end, still stays on the map."""
    pyramid = Pyramid(SMALL)
    beam(pyramid, 9.0, 0.0, SMALL, start=(20.0, 0.0))
    assert int(pyramid.levels[0].cell_of(20.0, 0.0)[0]) < pyramid.levels[0].shape[1]
    free = np.array([[0.0, 30.0]], np.float32)
    pyramid.update(np.ones((1, 2), np.float32), free, np.zeros(2), np.zeros(3), SMALL)
    assert pyramid.levels[0].shape[0] > 600


def test_a_straight_drive_takes_the_memory_of_what_it_saw():
    """Two kilometres with beams to both sides: the window keeps its size, and moves every 6 m or less."""
    pyramid, boxes = Pyramid(SMALL), []
    for k in range(1000):
        points = np.array([[1.0, 2.0], [1.0, -2.0], [8.0, 0.0]], np.float32)
        pyramid.update(points, NOTHING, np.zeros(2), np.array([2.0 * k, 0.0, 0.0]), SMALL)
        boxes.append(pyramid.levels[0].box)
    assert len({box[1] - box[0] for box in boxes[1:]}) == 1
    assert len(set(boxes)) < 2000 / 6
    assert 600 < pyramid.stored < 3 * 2000 / 3.2
    assert pyramid.nbytes < 60e6
    assert pyramid.nbytes == pytest.approx(
        sum(level.nbytes for level in pyramid.levels) + sum(pyramid.tile(key).nbytes for key in pyramid._tiles)
    )


def test_without_growing_beams_are_cut_at_the_edge():
    """With map.grow off the map stays as it is, and is not called full."""
    config = replace(SMALL, grow=False)
    pyramid = Pyramid(config)
    beam(pyramid, 20.0, 0.0, config)
    assert pyramid.levels[0].shape == (128, 128)
    assert np.count_nonzero(pyramid.levels[0].log_odds) > 60
    assert pyramid.stopped_at == 0


def test_the_limit_stops_the_map_and_raising_it_lets_it_go_on():
    """Beyond map.limit the size stays, beams are cut, the map says so; a higher limit acts from the next scan."""
    tight, wide = replace(SMALL, limit=1), replace(SMALL, limit=400)
    pyramid = Pyramid(tight)
    beam(pyramid, 3.0, 0.0, tight)
    shape = pyramid.levels[0].shape
    assert pyramid.stopped_at == 0
    beam(pyramid, 60.0, 40.0, tight)
    assert pyramid.stopped_at == 1
    assert pyramid.levels[0].shape == shape
    beam(pyramid, 1.0, 1.0, tight)
    assert pyramid.stopped_at == 1
    beam(pyramid, 60.0, 40.0, wide)
    assert pyramid.stopped_at == 0
    assert int(pyramid.levels[0].cell_of(60.0, 40.0)[0]) < pyramid.levels[0].shape[1]


def test_a_first_map_beyond_the_limit_is_refused():
    """The limit holds from the beginning; the message gives both figures and the settings."""
    with pytest.raises(ConfigError, match=r"2048 x 2048 cells takes 55 MB, map\.limit is 50 MB"):
        Pyramid(replace(SMALL, size=2048, limit=50.0))
    assert Pyramid(replace(SMALL, size=2048, limit=56.0)).levels


def test_memory_is_what_the_limit_counts():
    """The arrays of all levels take the megabytes that are compared with the limit, padding apart."""
    pyramid = Pyramid(replace(SMALL, size=2048))
    cells = [a for level in pyramid.levels for a in vars(level).values() if np.ndim(a) == 2 and len(a)]
    assert len(cells) == 13  # with the revisions of the tiles
    assert sum(a.nbytes for a in cells) == pytest.approx(1e6 * megabytes(2048 * 2048, 3), rel=0.01)


def test_a_copy_does_not_grow_along():
    """A checkpoint keeps its size when the map that it was made of grows, and then grows by itself."""
    pyramid = written(SMALL)
    other = pyramid.copy()
    beam(pyramid, 30.0, 10.0, SMALL)
    assert same_map(other, written(SMALL))
    beam(other, 30.0, 10.0, SMALL)
    assert same_map(other, pyramid)


def grazed(degrees: float) -> np.ndarray:
    """(n, 2) endpoints on a straight wall a metre aside, as far as 20 m ahead, of beams so far apart."""
    angles = np.radians(np.arange(60.0, 2.9, -degrees))
    return np.column_stack([1.0 / np.tan(angles), np.ones(len(angles))]).astype(np.float32)


def test_beams_more_than_a_right_angle_apart_leave_wide_gaps():
    """As of a scan that has lost most of them."""
    ends = np.array([[1.0, 0.0], [-1.0, 0.5], [0.5, -1.0]], np.float32)
    assert longest_gap(ends, np.zeros(2), 3.0) == 6.0


@pytest.mark.parametrize(("degrees", "times"), [(0.25, 1.0), (0.5, 1.0), (0.75, 1.0), (1.0, 2.0), (2.0, 2.0)])
def test_a_scanner_with_fewer_beams_may_leave_wider_gaps_in_a_wall(degrees: float, times: float):
    """Twice as wide ones from 0.9 degrees between beams on; three quarters of a degree are not near it."""
    laser = np.array([0.3, -0.2])
    points = grazed(degrees) + np.float32(laser)
    assert longest_gap(points, laser, 3.0) == 3.0 * times
    assert longest_gap(points[::-1], laser, 3.0) == 3.0 * times
    assert longest_gap(points[:1], laser, 3.0) == longest_gap(points[:0], laser, 3.0) == 3.0
    assert longest_gap(points, laser, 0.0) == 0.0


@pytest.mark.parametrize("degrees", [0.5, 1.0])
def test_a_wall_of_a_corridor_is_written_without_a_gap(degrees: float):
    """From 5 m to 12 m ahead, where its endpoints are up to 2.9 m apart, by a scanner of either kind."""
    pyramid = Pyramid(MapConfig(wall_gap=1.5))
    points = grazed(degrees)
    pyramid.update(points, np.empty((0, 2), np.float32), np.zeros(2), np.zeros(3), MapConfig(wall_gap=1.5))
    level = pyramid.levels[0]
    columns = np.arange(int(5.0 / level.resolution), int(12.0 / level.resolution)) - level.corner[0]
    row = int(1.0 / level.resolution + 0.5) - level.corner[1]
    assert (level.log_odds[row - 1 : row + 1, columns] > 0.0).any(axis=0).all()
