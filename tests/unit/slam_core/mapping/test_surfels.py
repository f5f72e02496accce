"""Where in its cells a surface lies: what the map keeps of it, and what a match makes of that."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slam_core.config import MapConfig, MatcherConfig
from slam_core.kernels.gauss_newton import TOGETHER
from slam_core.kernels.structures import Level
from slam_core.kernels.surfels import normal_equations, settle
from slam_core.mapping.pyramid import Pyramid
from slam_core.mapping.surfels import pieces
from slam_core.matching.matcher import coarse_to_fine
from slam_core.results import PlanarGaussian

CONFIG = MapConfig(size=512)
CELL = CONFIG.resolution
NONE, LASER, HERE = np.empty((0, 2), np.float32), np.zeros(2), np.zeros(3)
CELLS_ALONE, WITH_SURFELS = MatcherConfig(surfel_weight=0.0), MatcherConfig()
OPEN = np.zeros(2)


def grid(level):
    """The surfels of a level as the kernels take them."""
    return Level(level.surfels, level.corner, 1.0 / level.resolution)


def room(rng, pose=HERE, *, ahead=4.0, aside=3.0, noise=0.01):
    """Endpoints on a wall ahead and one on either side, with noise along the beams."""
    angles = np.linspace(-2.0, 2.0, 721)
    cosines, sines = np.cos(angles + pose[2]), np.sin(angles + pose[2])
    with np.errstate(divide="ignore"):
        to_front = np.where(cosines > 0, (ahead - pose[0]) / cosines, np.inf)
        to_side = (aside - pose[1] * np.sign(sines)) / np.abs(sines)
    ranges = np.minimum(to_front, to_side) + rng.normal(scale=noise, size=len(angles))
    return (ranges[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])).astype(np.float32)


def wall(distance, *, heading=0.0, length=2.0):
    """Endpoints on a wall across the way of a laser that looks along `heading`."""
    aside = np.linspace(-length / 2, length / 2, 201)
    c, s = math.cos(heading), math.sin(heading)
    return np.column_stack([c * distance - s * aside, s * distance + c * aside]).astype(np.float32)


def seen(points, times=1, *, laser=LASER, onto=None):
    """A map into which those points were written."""
    pyramid = onto or Pyramid(CONFIG)
    for _ in range(times):
        pyramid.update(points, NONE, laser, HERE, CONFIG)
    return pyramid


def halves(points):
    """Every other point, as coordinates."""
    return tuple((part[:, 0].copy(), part[:, 1].copy()) for part in (points[::2], points[1::2]))


def pulled(pyramid, points, pose=HERE):
    """Where surfels alone take a pose that a match holds weakly."""
    level, moved = pyramid.levels[0], pose.copy()
    weak = np.array([1.0, 0.0, 0.0, 1.0, 0.0, 1.0])
    settle(grid(level), halves(points), moved, weak, 1.0, OPEN)
    return moved


def off(config, part=0.0, board=0.0):
    """Mean error (m) of matches in a map written at the true poses, of walls at some part of a cell.

    board: how thick the wall ahead is, whose other side was written too and is where the matches are.
    """
    rng = np.random.default_rng(2)
    pyramid, errors = Pyramid(CONFIG), []
    for k in range(40):
        pose = np.array([*rng.uniform(-0.5, 0.5, 2), rng.uniform(-0.3, 0.3)])
        size = {"ahead": 4.0 + part * CELL, "aside": 3.0 + part * CELL}
        scan = room(rng, pose, **size)
        if board and k >= 20:  # the room beyond, seen from its other end
            scan = room(rng, pose, ahead=8.0 - size["ahead"] - board, aside=size["aside"])
            pose = np.array([8.0 - pose[0], -pose[1], pose[2] + math.pi])
        if k < 30:
            pyramid.update(scan, NONE, LASER, pose, CONFIG)
        else:
            prior = PlanarGaussian(pose, np.diag([0.02, 0.02, 0.01]) ** 2)
            errors.append(coarse_to_fine(pyramid, scan, pose, config, prior=prior).pose[:2] - pose[:2])
    return float(np.hypot(*np.mean(errors, axis=0)))


def test_a_match_feels_where_in_a_cell_the_walls_lie():
    """At any place within their cells, on edges too: by cells alone the worst is off twice as much or more."""
    parts = (0.0, 0.2, 0.4, 0.5, 0.6, 0.8)
    settled, plain = (max(off(config, part) for part in parts) for config in (WITH_SURFELS, CELLS_ALONE))
    assert plain > 0.005
    assert settled < plain / 2


@pytest.mark.parametrize("part", [0.2, 0.5])
def test_a_board_has_two_sides(part):
    """Seen from one side and then from the other: it is pulled less into a board of 4 cm than by cells alone."""
    assert off(WITH_SURFELS, part, board=0.04) < 0.7 * off(CELLS_ALONE, part, board=0.04)


@given(
    distance=st.floats(1.0, 5.0),
    heading=st.floats(-math.pi, math.pi),
    away=st.floats(-0.4, 0.4).map(lambda part: part * CELL),
)
def test_a_pose_is_pulled_to_where_its_ends_lie_on_the_wall(distance, heading, away):
    """From up to two fifths of a cell off, along the normal and not across, whatever way the wall faces."""
    points, normal = wall(distance, heading=heading), np.array([math.cos(heading), math.sin(heading)])
    pose = pulled(seen(points), points, np.array([*(away * normal), 0.0]))
    assert abs(pose[:2] @ normal) < 0.002
    assert abs(pose[0] * normal[1] - pose[1] * normal[0]) < 0.002


def test_surfels_pull_as_plain_numpy_says():
    """The normal equations of every beam, its four surfels one by one, in double precision."""
    rng = np.random.default_rng(4)
    level = seen(room(rng), 20).levels[0]
    points, pose = np.concatenate([room(rng) for _ in range(4)]), np.array([0.004, -0.003, 0.001])
    assert len(points) > TOGETHER
    c, s = math.cos(pose[2]), math.sin(pose[2])
    arms = points.astype(float) @ np.array([[c, s], [-s, c]]) / CELL
    hessian, right = np.zeros((3, 3)), np.zeros(3)
    for arm, (u, v) in zip(arms, arms + pose[:2] / CELL - level.corner, strict=True):
        beams, normal, distance = 0.0, np.zeros(2), 0.0
        for row in (math.floor(v - 0.5), math.floor(v - 0.5) + 1):
            for column in (math.floor(u - 0.5), math.floor(u - 0.5) + 1):
                n, nx, ny, offset = read(int(level.surfels[row, column]))
                if nx * arm[0] + ny * arm[1] < 0.0:
                    beams += n
                    normal += n * np.array([nx, ny])
                    distance += n * (offset - nx * (u - column - 0.5) - ny * (v - row - 0.5))
        if beams:
            normal, distance = normal / beams, distance / beams
            weight = beams / (beams + 10.0) / (1.0 + (distance / 0.2) ** 2)
            jacobian = np.array([*normal, normal[1] * arm[0] - normal[0] * arm[1]])
            hessian += weight * np.outer(jacobian, jacobian)
            right += weight * jacobian * distance
    xs, ys = points[:, 0].copy(), points[:, 1].copy()
    found = normal_equations(grid(level), xs, ys, np.array(pose))
    upper = hessian[np.triu_indices(3)]
    np.testing.assert_allclose(found[:6], upper, rtol=1e-3, atol=1e-3 * upper.max() ** 0.5)
    np.testing.assert_allclose(found[6:], right, rtol=2e-2, atol=0.5)


def read(word):
    """Beams, normal and offset in cells of a surfel."""
    signed = [((word >> first) & ((1 << bits) - 1), 1 << bits) for first, bits in ((6, 7), (13, 7), (20, 12))]
    nx, ny, offset = (value - whole if value >= whole // 2 else value for value, whole in signed)
    return word & 63, nx / 63.0, ny / 63.0, offset * 0.75 / 2047.0


def test_a_surfel_is_the_mean_line_of_its_beams():
    """Ends 1 cm before and behind the middle of their cells: a line through the middle that looks at the laser."""
    middle = 2.0 + CELL / 2
    pyramid = seen(wall(middle - 0.01))
    pyramid = seen(wall(middle + 0.01), onto=pyramid)
    level = pyramid.levels[0]
    column, row = level.cell_of(middle, 0.0)
    n, nx, ny, offset = read(int(level.surfels[row, column]))
    assert n >= 8
    assert (nx, ny) == pytest.approx((-1.0, 0.0), abs=0.02)
    assert offset == pytest.approx(0.0, abs=0.01)


@given(st.floats(-math.pi, math.pi), st.floats(1.0, 3.0))
def test_the_pieces_that_are_shown_lie_on_the_wall(heading, distance):
    """To millimetres, from left to right as the laser sees it, and those of many beams count most."""
    once, often = (seen(wall(distance, heading=heading), times) for times in (1, 30))
    away = np.array([math.cos(heading), math.sin(heading)])
    for pyramid, least, most in ((once, 0.05, 0.8), (often, 0.6, 1.0)):
        finest = pyramid.levels[0]
        ends, counts = pieces(finest.surfels, finest.resolution, *finest.origin)
        off = ends @ away - distance
        assert len(ends) > 20
        assert np.median(np.abs(off)) < 0.002
        assert np.abs(off.mean(axis=1)).max() < 0.005
        to_the_right = (ends[:, 1] - ends[:, 0]) @ np.array([away[1], -away[0]])
        assert (to_the_right > 0.04).all()
        assert least < np.median(counts) < most


def test_a_level_without_surfels_has_no_pieces():
    """Neither a coarser level nor a map of which nothing is known."""
    for level in Pyramid(MapConfig()).levels:
        ends, counts = pieces(level.surfels, level.resolution, 0.0, 0.0)
        assert ends.shape == (0, 2, 2)
        assert counts.shape == (0,)


def test_only_the_finest_level_keeps_surfels():
    """The coarser ones lead to it and have no last word; their memory stays as it was."""
    assert [len(level.surfels) > 0 for level in seen(wall(2.0)).levels] == [True, False, False]


def test_what_is_round_or_alone_leaves_no_surfel():
    """Ends without a surface around them have no line."""
    lone = np.array([[2.0, 0.0], [1.0, 2.0], [-2.0, 1.0]], np.float32)
    scattered = np.random.default_rng(5).uniform(1.0, 3.0, (60, 2)).astype(np.float32)
    assert not seen(lone).levels[0].surfels.any()
    kept = np.count_nonzero(seen(scattered).levels[0].surfels)
    assert kept < 12


def test_a_surface_that_turned_is_learned_anew():
    """As many beams as told of the old one take it away, and then the new one stands there."""
    points = wall(2.02)
    pyramid = seen(points, 3)
    turned = np.column_stack([2.02 + 1.5 * points[:, 1], points[:, 1]]).astype(np.float32)
    seen(turned, 60, onto=pyramid)
    column, row = pyramid.levels[0].cell_of(2.02, 0.0)
    _, nx, ny, _ = read(int(pyramid.levels[0].surfels[row, column]))
    assert (nx, ny) == pytest.approx(np.array([-1.0, 1.5]) / math.hypot(1.0, 1.5), abs=0.03)


def test_what_has_moved_on_takes_its_surfel_along():
    """A wall that beams now pass: the surfels of the cells that are doubted are gone with it."""
    pyramid = seen(wall(2.0, length=1.0), 2)
    near = pyramid.levels[0].surfels != 0
    assert near.any()
    pyramid.clear(wall(4.0, length=4.0), LASER, HERE, CONFIG)
    assert not pyramid.levels[0].surfels[near].any()


def test_surfels_grow_and_are_copied_with_their_map():
    """They keep their places when the map grows, and a copy goes its own way."""
    points = wall(2.02)
    pyramid = seen(points)
    copy = pyramid.copy()
    shape = pyramid.levels[0].shape
    seen(wall(40.0, heading=2.5), onto=pyramid)
    assert pyramid.levels[0].shape != shape
    grown, kept = (each.levels[0].surfels[each.levels[0].cell_of(2.02, 0.0)[::-1]] for each in (pyramid, copy))
    assert grown == kept > 0
    assert copy.levels[0].surfels.shape == shape
    assert np.count_nonzero(pyramid.levels[0].surfels) > np.count_nonzero(copy.levels[0].surfels)


def test_surfels_never_take_a_pose_far_from_its_match():
    """Two thousand beams of a wall that is elsewhere by more than a cell: the match stands."""
    for off in (1.2 * CELL, 2.0 * CELL, 1.0):
        pose = np.array([off, 0.0, 0.0])
        moved = pulled(seen(wall(2.0), 20), wall(2.0), pose)
        assert np.hypot(*(moved - pose)[:2]) < CELL


def test_an_open_direction_is_left_as_it_is():
    """Along it the match took no step, and neither do surfels."""
    pyramid, points = seen(wall(2.02), 5), wall(2.02)
    level = pyramid.levels[0]
    pose, blind = np.array([0.01, 0.0, 0.0]), np.array([1.0, 0.0])
    loose = np.array([1.0, 0, 0, 1.0, 0, 1.0])
    settle(grid(level), halves(points), pose, loose, 1.0, blind)
    assert pose[0] == 0.01


def test_a_map_without_surfels_leaves_the_match_alone():
    """As of a saved map, which holds cells only: the same match as by cells alone, to the last bit."""
    rng = np.random.default_rng(6)
    saved = seen(room(rng), 3)
    saved.levels[0].surfels[:] = 0
    points, start = room(rng), np.array([0.03, -0.02, 0.01])
    settled, plain = (coarse_to_fine(saved, points, start, config) for config in (WITH_SURFELS, CELLS_ALONE))
    np.testing.assert_allclose(settled.pose, plain.pose, atol=1e-12)
