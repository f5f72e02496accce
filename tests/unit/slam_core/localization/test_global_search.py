"""The search of a whole map, against every place tried one by one."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from slam_core import geometry
from slam_core.config import MapConfig, SlamConfig, TrackingConfig
from slam_core.kernels import global_search as kernels
from slam_core.localization import search_parts
from slam_core.localization.global_search import MOVE, GlobalSearch, agreement, locate
from slam_core.localization.place_search import RIVAL, Places, PlaceSearch, apart, walls
from slam_core.localization.search_parts import BLOCK, Region
from slam_core.mapping.grid import GridLevel
from slam_core.mapping.pyramid import Pyramid
from slam_core.mapping.tiled_map import MapLevel
from slam_core.scan.stabilise import StabilisedScan, stabilise
from tests.worlds import room_scan, standing

CONFIG = SlamConfig(map=MapConfig(size=400))


def find_places(
    level: GridLevel, points: np.ndarray, least: float, region: Region | None = None, work: float = math.inf
) -> Places:
    """A search from its begin to its end, in parts of so much work."""
    search = PlaceSearch(level, points, least, region)
    while not search.finished:
        search.advance(work)
    return search.places()


def level_scan(pose: np.ndarray) -> StabilisedScan:
    """The test room seen from `pose`."""
    return stabilise(room_scan(pose), standing, CONFIG.scan)


@pytest.fixture(scope="module")
def room() -> Pyramid:
    """The test room, mapped from five places."""
    pyramid = Pyramid(CONFIG.map)
    for pose in np.array([[0, 0, 0], [1, -1, 1], [-1, 1, 2], [-2, -1, 3], [0.5, 0.5, -1.5]], float):
        scan = level_scan(pose)
        pyramid.update(scan.points, scan.cleared, scan.laser, pose, CONFIG.map)
    return pyramid


def test_nothing_is_found_where_nothing_is_known():
    """All that was seen may lie off a map that does not grow."""
    level = Pyramid(CONFIG.map).levels[0]
    assert not len(find_places(level, level_scan(np.zeros(3)).points, 0.5).poses)


def made_level(seed: int) -> GridLevel:
    """A few random walls on cells of 20 cm; everything is known."""
    rng = np.random.default_rng(seed)
    level = GridLevel(0.2, (23, 30), np.array([-2.0, -1.0]))
    level.log_odds[:] = np.where(rng.random((23, 30)) < 0.15, 2.0, -1.0)
    level.bounds = level.box
    return level


def every_score(level: GridLevel, points: np.ndarray) -> np.ndarray:
    """(headings, rows, columns): sums of the walls that the endpoints meet, place by place."""
    picture = np.pad(walls(level, level.box).astype(int), 200)
    reach = np.quantile(np.hypot(*points.T), 0.9)
    count = max(8, math.ceil(2 * math.pi * reach / level.resolution))
    rows, columns = level.shape
    out = np.zeros((count, rows, columns), int)
    for h in range(count):
        ends = geometry.transform_points(np.array([0, 0, 2 * math.pi * h / count]), points) / level.resolution
        for du, dv in np.floor(ends + 0.5).astype(int):
            out[h] += picture[200 + dv : 200 + dv + rows, 200 + du : 200 + du + columns]
    return out


@settings(max_examples=25)
@given(st.integers(0, 10**6), st.integers(1, 40))
def test_no_place_is_better_than_the_first(seed: int, beams: int):
    """The first place scores what the best of all places scores, and is the first of the best in order."""
    level = made_level(seed)
    points = np.random.default_rng(seed + 1).uniform(-3, 3, (beams, 2)).astype(np.float32)
    scores = every_score(level, points.astype(float))
    places = find_places(level, points, 0.01)
    if places.crowded:
        return
    h, row, column = np.unravel_index(np.argmax(scores), scores.shape)
    assert places.scores[0] == scores.max() / (2 * beams)
    expected = [*((np.array([column, row]) + 0.5) * 0.2 + level.origin), 2 * math.pi * h / len(scores)]
    error = places.poses[0] - expected
    assert np.abs([error[0], error[1], geometry.wrap(error[2])]).max() < 1e-9


def test_the_rivals_are_there_and_apart():
    """Nothing apart from every place that was returned scores more than the least of them."""
    level = made_level(3)
    points = np.random.default_rng(5).uniform(-3, 3, (25, 2)).astype(np.float32)
    scores = every_score(level, points.astype(float))
    places = find_places(level, points, 0.1)
    assert len(places.poses) > 2
    assert all(apart(a, b) for i, a in enumerate(places.poses) for b in places.poses[:i])
    assert np.all(places.scores >= RIVAL * places.scores[0])
    assert np.all(np.diff(places.scores) <= 0)
    for h, row, column in np.argwhere(scores > 2 * 25 * places.scores[-1]):
        pose = np.array([*((np.array([column, row]) + 0.5) * 0.2 + level.origin), 2 * math.pi * h / len(scores)])
        assert not all(apart(pose, other) for other in places.poses)


@settings(max_examples=25)
@given(st.integers(0, 10**6), st.floats(1.0, 1e5))
def test_a_search_in_parts_finds_the_same(seed: int, work: float):
    """To the last bit, however often it stops."""
    level = made_level(seed)
    points = np.random.default_rng(seed + 1).uniform(-3, 3, (12, 2)).astype(np.float32)
    whole, parts = find_places(level, points, 0.3), find_places(level, points, 0.3, work=work)
    assert (whole.poses.tobytes(), whole.scores.tobytes()) == (parts.poses.tobytes(), parts.scores.tobytes())
    assert whole.crowded == parts.crowded


def test_a_search_in_parts_needs_no_other_compilation():
    """A part of any length takes the kernel that is compiled: seconds would pass else, while a robot is lost."""
    find_places(made_level(1), np.ones((12, 2), np.float32), 0.3, work=3e5)
    assert len(kernels.best_places.signatures) <= 1


@settings(max_examples=25)
@given(st.integers(0, 10**6), st.floats(-3, 5), st.floats(-2, 4), st.floats(0, 4))
def test_in_a_region_only_its_places_count(seed: int, x: float, y: float, radius: float):
    """The best place is the best of the region's box; places up to a block beside the box may count as well."""
    level = made_level(seed)
    points = np.random.default_rng(seed + 1).uniform(-2, 2, (15, 2)).astype(np.float32)
    places = find_places(level, points, 0.01, Region(np.array([x, y, 0.0]), radius))
    rows, columns = (np.arange(n) + 0.5 for n in level.shape)
    off = [
        np.abs(axis * 0.2 + start - middle)
        for axis, start, middle in zip((columns, rows), level.origin, (x, y), strict=True)
    ]
    scores = every_score(level, points.astype(float))
    inside = scores[:, off[1] <= radius][:, :, off[0] <= radius]
    assert np.all(np.abs(places.poses[:, :2] - [x, y]) <= radius + 2 * BLOCK * 0.2) or not len(places.poses)
    if inside.size and inside.max() > 0 and not places.crowded:
        assert places.scores[0] >= inside.max() / 30


@settings(max_examples=25)
@given(st.floats(-np.pi, np.pi), st.floats(-np.pi, np.pi), st.floats(0.1, np.pi))
def test_only_headings_that_a_robot_can_have_are_searched(heading: float, motion: float, turn: float):
    """All within its limits, and none further than a step of the lattice beside; it may have turned since."""
    region = Region(np.zeros(3), 1.0, np.array([0.0, 0.0, motion]), heading, turn)
    headings = np.linspace(0.0, 2.0 * np.pi, 90, endpoint=False)
    kept = set(region.facing(headings).tolist())
    turned = {psi: abs(geometry.wrap(psi - heading - motion)) for psi in headings.tolist()}
    assert {psi for psi, by in turned.items() if by <= turn} <= kept
    assert all(turned[psi] <= turn + 2.0 * np.pi / 90 + 1e-9 for psi in kept)
    assert len(Region(np.zeros(3), 1.0).facing(headings)) == 90


def test_places_with_another_heading_than_a_robot_can_have_are_none():
    """They would crowd out the right one where much looks alike."""
    level = made_level(1)
    points = np.random.default_rng(2).uniform(-2, 2, (15, 2)).astype(np.float32)
    for heading in (0.0, 3.0):
        places = find_places(level, points, 0.01, Region(np.zeros(3), 3.0, heading=heading, turn=0.5))
        assert len(places.poses)
        assert all(abs(geometry.wrap(psi - heading)) < 0.7 for psi in places.poses[:, 2])


@settings(max_examples=50)
@given(st.floats(-3, 5), st.floats(-2, 4), st.floats(0, 4), st.integers(1, 9))
@example(-0.864, 1.562, 0.089, 9)
def test_tiles_beside_a_region_make_no_part(x: float, y: float, radius: float, size: int):
    """A part without places has no best one: what was seen far from the region does not count."""
    level = made_level(1)
    points = np.random.default_rng(2).uniform(-2, 2, (12, 2)).astype(np.float32)
    region = Region(np.array([x, y, 0.0]), radius)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(GridLevel, "seen", lambda _: [(-1, -1), (0, 0), (40, -40), (-40, 0)])
        patch.setattr(search_parts, "LARGE", 1)
        patch.setattr(search_parts, "PART", size)
        assert all(part.box[2] > 0 and part.box[3] > 0 for part in search_parts.parts(level, region, 3.0))
        find_places(level, points, 0.3, region)


@settings(max_examples=25)
@given(st.integers(0, 10**6), st.integers(1, 3), st.booleans())
def test_a_large_region_in_parts_gives_the_same(seed: int, size: int, whole: bool):
    """Where all was seen: the same places and scores, to the last bit, however small the parts."""
    level = made_level(seed)
    points = np.random.default_rng(seed + 1).uniform(-2, 2, (12, 2)).astype(np.float32)
    region = None if whole else Region(np.array([0.3, 0.9, 0.0]), 1.1)
    at_once = find_places(level, points, 0.3, region)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(GridLevel, "seen", lambda _: [(x, y) for x in (-1, 0) for y in (-1, 0)])
        patch.setattr(search_parts, "LARGE", 1)
        patch.setattr(search_parts, "PART", size)
        assert len(search_parts.parts(level, region, 3.0)) > 1 or size > 2
        in_parts = find_places(level, points, 0.3, region)
    assert at_once.crowded == in_parts.crowded
    assert at_once.poses.tobytes() == in_parts.poses.tobytes()
    assert at_once.scores.tobytes() == in_parts.scores.tobytes()


def test_only_where_something_was_seen_a_large_map_is_searched():
    """Two rooms a kilometre apart: as many parts, none much larger than a room and what a scan there reaches."""
    pyramid, reach = Pyramid(CONFIG.map), 5.0
    for pose in np.array([[0.0, 0.0, 0.0], [1000.0, 700.0, 1.0]]):
        scan = level_scan(np.zeros(3))
        pyramid.update(scan.points, scan.cleared, scan.laser, pose, CONFIG.map)
    places = search_parts.parts(MapLevel(pyramid, 1), None, reach)
    assert 2 <= len(places) <= 8
    assert sum((w[1] - w[0]) * (w[3] - w[2]) for w, _ in places) < 8 * 300**2
    scan = level_scan(np.array([0.4, -0.3, 0.2]))
    search, done = GlobalSearch(pyramid, scan, CONFIG), []
    while not search.finished:
        done.append(search.advance(3e6))
    assert max(done) < 3e6 + 2 * MOVE
    assert search.result().failure == ("ambiguous", 2, 0.0)


def test_a_bound_is_what_the_block_could_score_at_best():
    """Each endpoint counts as the largest cell that it meets from any place of the block."""
    level = made_level(7)
    cells = walls(level, level.box)
    shifts = np.random.default_rng(1).integers(-12, 12, (30, 2))
    bounds = np.empty((-(-23 // BLOCK), -(-30 // BLOCK)), np.uint8)
    search = PlaceSearch(level, np.ones((1, 2), np.float32), 0.1)
    search.advance()
    kernels.block_bounds(search.pictures.blocks, shifts, 0, 0, bounds)
    picture = np.pad(cells, 50)
    for (r, c), bound in np.ndenumerate(bounds):
        corners = 50 + BLOCK * np.array([c, r]) + shifts
        assert bound == sum(int(picture[v : v + BLOCK, u : u + BLOCK].max()) for u, v in corners)


def test_the_place_is_found_wherever_the_robot_is(room: Pyramid):
    """From anywhere in the room and any heading: within 3 cm and 0.02 rad."""
    rng = np.random.default_rng(2)
    for _ in range(12):
        truth = rng.uniform([-3, -2, -math.pi], [1, 2, math.pi])
        result = locate(room, level_scan(truth), CONFIG)
        assert result.match is not None, result.failure
        error = result.match.pose - truth
        assert np.hypot(*error[:2]) < 0.03
        assert abs(geometry.wrap(error[2])) < 0.02


def test_two_places_alike_are_no_place():
    """A rectangle without anything in it looks the same from two sides: that is said instead of a guess."""
    empty = Pyramid(CONFIG.map)
    sides = [(-4.0, -3.0), (4.0, -3.0), (4.0, 3.0), (-4.0, 3.0), (-4.0, -3.0)]
    ring = np.concatenate([np.linspace(a, b, 300, endpoint=False) for a, b in pairwise(sides)])
    points = ring.astype(np.float32)
    nothing = np.empty((0, 2), np.float32)
    empty.update(points, nothing, np.zeros(2), np.zeros(3), CONFIG.map)
    scan = StabilisedScan(points, np.zeros(len(points), np.float32), nothing, np.zeros(2))
    result = locate(empty, scan, CONFIG)
    assert result.match is None
    assert result.failure == ("ambiguous", 2, 0.0)


def test_another_building_is_no_place(room: Pyramid):
    """A round hall is nowhere in a square room, and the reason gives the figure that was wanted."""
    angles = np.linspace(0, 2 * math.pi, 500)
    points = (2.2 * np.column_stack([np.cos(angles), 0.7 * np.sin(angles)])).astype(np.float32)
    scan = StabilisedScan(points, np.zeros(500, np.float32), np.empty((0, 2), np.float32), np.zeros(2))
    result = locate(room, scan, CONFIG)
    assert result.match is None
    assert result.failure is not None
    assert (result.failure.code, result.failure.limit) == ("no_place", 0.85)
    assert result.failure.value < 0.85


def test_what_is_wanted_is_a_setting(room: Pyramid):
    """A scan of which half is furniture that was not there is found only by who asks for less."""
    scan = level_scan(np.array([-1.0, 0.5, 0.3]))
    points = scan.points.copy()
    points[::2] *= 0.7
    changed = scan._replace(points=points)
    assert locate(room, changed, CONFIG).match is None
    easy = locate(room, changed, replace(CONFIG, tracking=TrackingConfig(relocalise_min_inlier_ratio=0.4)))
    assert easy.match is not None
    assert np.hypot(*(easy.match.pose - [-1.0, 0.5, 0.3])[:2]) < 0.1


def test_beams_through_walls_count_half():
    """A wall at 2 m and one behind it at 4 m: beams that end on the far one cross the near one."""
    pyramid = Pyramid(CONFIG.map)
    ys = np.linspace(-1, 1, 200)
    near, far = (np.column_stack([np.full_like(ys, x), ys]).astype(np.float32) for x in (2.05, 4.05))
    nothing = np.empty((0, 2), np.float32)
    for points, laser in ((near, [0.0, 0.0]), (far, [3.0, 0.0])):
        pyramid.update(points, nothing, np.array(laser), np.zeros(3), CONFIG.map)
    seen = StabilisedScan(near, np.zeros(200, np.float32), nothing, np.zeros(2))
    through = StabilisedScan(far, np.zeros(200, np.float32), nothing, np.zeros(2))
    assert agreement(pyramid, seen, np.zeros(3)) == pytest.approx(1.0)
    assert agreement(pyramid, through, np.zeros(3)) == pytest.approx(0.5, abs=0.02)
    assert agreement(pyramid, seen, np.array([-0.1, 0.0, 0.0])) == pytest.approx(0.5, abs=0.02)
    assert agreement(pyramid, seen, np.array([0.0, 50.0, 0.0])) == 0.0


def test_the_search_is_the_same_every_time(room: Pyramid):
    """To the last bit."""
    scan = level_scan(np.array([0.3, 0.2, 2.0]))
    first, again = (find_places(room.levels[1], scan.points, 0.3) for _ in range(2))
    assert first.poses.tobytes() == again.poses.tobytes()
