"""What moved on leaves the map, walls stay, and what is new is noticed."""

import numpy as np
import pytest

from slam_core.config import MapConfig, SlamConfig, with_value
from slam_core.geometry import transform_points
from slam_core.mapping.pyramid import Pyramid
from slam_core.slam import HectorSlam
from tests.worlds import room_scan

CONFIG = SlamConfig(map=MapConfig(size=400))
DT = 100_000_000
AT = slice(60, 80)  # beams to a visitor, who stands in the way of a wall
REST, NOBODY = np.zeros(3), np.empty((0, 2), np.float32)


def scan(k, visitor=False, noise=0.005):
    """The room seen from its middle; the visitor stands 1.5 m away."""
    made = room_scan(REST, k * DT, noise=noise)
    if visitor:
        made.ranges[AT] = 1.5
    return made


def visited(config=CONFIG):
    """A robot at rest that somebody visited for a while: written into the map a hundred times."""
    slam = HectorSlam(config)
    slam.step(scan(0, visitor=True))
    result = slam.step(scan(1, visitor=True))
    for _ in range(100):
        slam.map.update(result.points, NOBODY, np.zeros(2), result.planar, config.map)
    return slam, transform_points(result.planar, result.points[AT])


def occupied(slam, points):
    """Which of the points (n, 2), map metres, lie in an occupied cell of the finest level."""
    columns, rows = slam.map.levels[0].cell_of(points[:, 0], points[:, 1])
    return slam.map.levels[0].log_odds[rows, columns] > 0


def test_a_robot_at_rest_forgets_a_visitor_within_five_seconds():
    """However long somebody stood there: once beams pass, no cell stays occupied; never, if switched off."""
    slam, place = visited()
    assert occupied(slam, place).all()
    before = slam.map.revision
    for k in range(2, 50):
        slam.step(scan(k))
    assert not occupied(slam, place).any()
    assert slam.map.revision > before
    paper, place = visited(with_value(CONFIG, "map.clear_interval", 0.0))
    for k in range(2, 50):
        paper.step(scan(k))
    assert occupied(paper, place).all()


def test_a_clock_that_was_set_back_does_not_keep_a_visitor():
    """Cells are cleared as soon as beams pass, whatever the stamps were before."""
    slam, place = visited()
    slam.step(scan(36_000, visitor=True))
    for k in range(2, 50):
        slam.step(scan(k))
    assert not occupied(slam, place).any()


def test_walls_and_free_space_are_not_doubted():
    """A minute in an empty room changes next to nothing, at whatever angle the beams meet the walls.

    On the edge of the pillar a cell is hit by the first scan alone.
    """
    slam, paper = HectorSlam(CONFIG), HectorSlam(with_value(CONFIG, "map.clear_interval", 0.0))
    for k in range(600):
        for run in (slam, paper):
            run.step(scan(k, noise=0.0))
    changed = [
        np.count_nonzero(a.log_odds != b.log_odds) for a, b in zip(slam.map.levels, paper.map.levels, strict=True)
    ]
    assert changed[0] <= 2
    assert changed[1:] == [0, 0]


def test_a_thin_wall_outlives_beams_through_its_gaps():
    """Where beams end close by, a cell is no ghost; where all of them end far behind, it is."""
    config = MapConfig(size=256)
    wall = np.column_stack([np.full(201, 2.0), np.linspace(-1.0, 1.0, 201)]).astype(np.float32)
    for gap, stays in ((0.02, True), (1.0, False)):
        pyramid = Pyramid(config)
        pyramid.update(wall, NOBODY, np.zeros(2), REST, config)
        through = np.where(np.abs(wall[:, 1:]) < gap, np.float32(1.5), np.float32(1.0)) * wall
        for _ in range(20):
            pyramid.clear(through, np.zeros(2), REST, config)
        columns, rows = pyramid.levels[0].cell_of(2.0, 0.0)
        assert (pyramid.levels[0].log_odds[rows, columns] > 0) == stays


def test_a_ghost_beside_an_edge_goes_with_the_beams_that_pass_it():
    """Of the beams of its bearing every second ends at a corner far before it: the others are enough."""
    config = MapConfig(size=256)
    pyramid = Pyramid(config)
    ghost = np.array([[2.5, 0.02]], np.float32)
    pyramid.update(ghost, NOBODY, np.zeros(2), REST, config)
    angles = np.radians(np.arange(-5.0, 5.0, 0.125))
    ranges = np.where(np.arange(len(angles)) % 2, 1.0, 4.0)
    beams = (ranges * [np.cos(angles), np.sin(angles)]).T.astype(np.float32)
    for _ in range(6):
        pyramid.clear(beams, np.zeros(2), REST, config)
    columns, rows = pyramid.levels[0].cell_of(*ghost[0])
    assert pyramid.levels[0].log_odds[rows, columns] < 0


def test_what_an_edge_hides_is_not_doubted():
    """A cell whose own bearing is blocked stays, however far the beams beside it go."""
    config = MapConfig(size=256)
    pyramid = Pyramid(config)
    hidden = np.array([[2.5, 0.02]], np.float32)
    pyramid.update(hidden, NOBODY, np.zeros(2), REST, config)
    angles = np.radians(np.arange(-5.0, 5.0, 0.125))
    ranges = np.where(np.abs(angles) < np.radians(1.1), 1.0, 4.0)
    beams = (ranges * [np.cos(angles), np.sin(angles)]).T.astype(np.float32)
    for _ in range(6):
        pyramid.clear(beams, np.zeros(2), REST, config)
    columns, rows = pyramid.levels[0].cell_of(*hidden[0])
    assert pyramid.levels[0].log_odds[rows, columns] > 0


def test_beams_that_end_in_free_space_are_unexpected():
    """A visitor in a room that is known empty; not the walls, and nothing in a first scan."""
    slam = HectorSlam(CONFIG)
    assert not slam.step(scan(0)).unexpected.any()
    result = slam.step(scan(1, visitor=True))
    assert result.unexpected[AT].all()
    assert result.unexpected.sum() == 20
    assert not slam.step(scan(2)).unexpected.any()


def test_ends_off_the_map_are_not_unexpected():
    """Where the map ends, nothing is known to be free."""
    pyramid = Pyramid(MapConfig(size=64))
    ends = np.array([[100.0, 0.0], [-1.6, -1.6], [0.0, 1.59]], np.float32)
    assert not pyramid.unexpected(ends, REST).any()


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_bearings_behind_the_laser_wrap(side):
    """A ghost at 180 degrees, where the bins of bearings begin and end, goes like any other."""
    config = MapConfig(size=256)
    pyramid = Pyramid(config)
    ghost = np.array([[-1.5, 0.01 * side]], np.float32)
    pyramid.update(ghost, NOBODY, np.zeros(2), REST, config)
    behind = np.column_stack([np.full(101, -3.0), np.linspace(-0.5, 0.5, 101)]).astype(np.float32)
    for _ in range(6):
        pyramid.clear(behind, np.zeros(2), REST, config)
    columns, rows = pyramid.levels[0].cell_of(*ghost[0])
    assert pyramid.levels[0].log_odds[rows, columns] < 0
