"""Kernels stay within their arrays for every pose and endpoint, also far away and without a number.

What these tests prove they prove in the checked build, in which an access out of range is an IndexError.
"""

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from slam_core.config import MapConfig, MatcherConfig
from slam_core.kernels.correlative import count_near_hits
from slam_core.kernels.range_noise import BANDS, learn_noise
from slam_core.kernels.straight_walls import smooth
from slam_core.kernels.structures import Level
from slam_core.kernels.surfels import normal_equations as surfel_equations
from slam_core.localization.dynamic_beams import BESIDE, foreground
from slam_core.localization.few_beams import confirmed
from slam_core.localization.global_search import agreement
from slam_core.localization.map_view import crossings
from slam_core.localization.place_search import PlaceSearch
from slam_core.mapping.interpolate import interpolate
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.correlative import find_pose
from slam_core.matching.landscape import costs
from slam_core.matching.matcher import beams_of, coarse_to_fine, normal_equations, sampled_covariance
from slam_core.results import PlanarGaussian
from slam_core.scan.stabilise import StabilisedScan
from tests.worlds import room_ranges

# From beside the map to beyond what whole numbers hold, and what is no number.
FAR = st.sampled_from(
    [
        sign * size
        for size in (0.0, 3.2, 51.17, 2e3, 8.4e5, 1.1e8, 1e19, 1e200, math.inf, math.nan)
        for sign in (1, -1)
    ]
)
COORDINATES = FAR | st.floats(-100.0, 100.0) | st.floats()
POSES = st.tuples(COORDINATES, COORDINATES, st.floats(-4.0, 4.0) | FAR).map(np.array)
ENDS = st.lists(st.tuples(COORDINATES, COORDINATES), min_size=1, max_size=12).map(
    lambda ends: np.array(ends).astype(np.float32)
)
SMALL = MapConfig(size=64, limit=1.0)
MANY = MapConfig(size=64, levels=6, limit=60.0)
MAPS = st.sampled_from(["empty", "room", "full", "many"])
NO_POINTS = np.empty((0, 2), np.float32)
ORIGIN = np.zeros(3)
CLOSE = np.array([0.1, 0.2])
CLOSE3 = np.array([0.01, 0.02, 0.3])

pytestmark = pytest.mark.filterwarnings("ignore::RuntimeWarning")  # numpy's, at numbers beyond its own


def room() -> np.ndarray:
    """(360, 2) endpoints of a scan in a small room."""
    angles = np.linspace(-math.pi, math.pi, 360, endpoint=False)
    ranges = room_ranges(CLOSE3, angles)
    return np.column_stack([ranges * np.cos(angles), ranges * np.sin(angles)]).astype(np.float32)


def made(kind: str) -> tuple[Pyramid, MapConfig]:
    """A map without a cell, of a room, of a room that has no space to grow, and of many levels."""
    config = MANY if kind == "many" else SMALL
    pyramid = Pyramid(config)
    if kind != "empty":
        pyramid.update(room(), NO_POINTS, CLOSE, ORIGIN, config)
    if kind == "full":
        config = MapConfig(size=64, limit=1.0, grow=False)
    return pyramid, config


def is_unharmed(pyramid: Pyramid) -> bool:
    """Whether levels agree on their area, hold numbers, and know a box that lies within."""
    for i, level in enumerate(pyramid.levels):
        row0, row1, column0, column1 = level.known
        rows, columns = level.shape
        within = 0 <= row0 <= row1 <= rows and 0 <= column0 <= column1 <= columns
        if not (within and np.isfinite(level.log_odds).all() and level.shape == level.cells.shape):
            return False
        if tuple(n * 2**i for n in level.shape) != pyramid.levels[0].shape or level._marks.any():
            return False
    return True


@settings(max_examples=20, derandomize=True)
@given(MAPS, ENDS, ENDS, POSES)
@example("full", room(), room(), np.array([-2e3, 0.0, 0.0]))
@example("room", np.array([[math.nan, 1.0]], np.float32), NO_POINTS, ORIGIN)
@example("room", np.array([[1.0, math.nan]], np.float32), NO_POINTS, ORIGIN)
def test_writing_and_clearing_stay_within_the_map(kind, points, cleared, pose):
    """Wherever a scan is written and clears cells that it passes: the map stays whole and within its limit."""
    pyramid, config = made(kind)
    laser = points[0].astype(np.float64)
    for start in (CLOSE, laser):
        pyramid.update(points, cleared, start, pose, config)
        pyramid.clear(points, start, pose, config)
        pyramid.unexpected(points, pose)
    pyramid.clear(room(), CLOSE, pose, config)
    assert is_unharmed(pyramid)
    assert pyramid.nbytes < 1.1e6 * config.limit


@settings(max_examples=20, derandomize=True)
@given(MAPS, ENDS, POSES, POSES)
@example("room", room(), np.array([1.7e6, -1.7e6, 1.0]), ORIGIN)
@example("many", room(), np.array([math.nan] * 3), ORIGIN)
def test_matching_stays_within_the_map(kind, points, start, prior):
    """From every start, with every prediction, by surfels and by samples."""
    pyramid, _ = made(kind)
    config = MatcherConfig(iterations_fine=3)
    predicted = PlanarGaussian(prior, np.diag([0.1, 0.1, 0.1]))
    for ends in (points, room()):
        match = coarse_to_fine(pyramid, ends, start, config, prior=predicted, trace=True)
        assert 0 <= match.fit.hit <= 1.0
        assert len(match.residuals) == len(ends)
    finest = pyramid.levels[0]
    normal_equations(finest, beams_of(points), start)
    level = Level(finest.surfels, finest.corner, 1.0 / finest.resolution)
    xs, ys = np.ascontiguousarray(points.T)
    surfel_equations(level, xs, ys, start)


def wherever(test):
    """A test of a kind of map, some endpoints and a pose."""
    test = example("room", np.array([[math.nan, 1.0]], np.float32), np.array([math.nan] * 3))(test)
    test = example("room", room(), ORIGIN)(test)
    return settings(max_examples=20, derandomize=True)(given(MAPS, ENDS, POSES)(test))


@wherever
def test_what_the_map_confirms_is_a_share_of_the_beams(kind, points, pose):
    """At any pose, of any endpoints; nothing without a map."""
    pyramid, _ = made(kind)
    for ends in (points, room(), NO_POINTS):
        share = confirmed(pyramid, ends, pose)
        assert 0.0 <= share <= 1.05  # the normals of surfels are rounded
        assert share == 0.0 or (kind != "empty" and len(ends) > 0)


@wherever
def test_counted_ends_are_those_of_the_scan(kind, points, pose):
    """At any pose there are no more known than ends, no more hits than known, and none without a map."""
    pyramid, _ = made(kind)
    for level in pyramid.levels:
        for ends in (points, room(), NO_POINTS):
            counts = np.full((1, 2), -1, np.int32)
            count_near_hits(level.cells, level.corner, 1.0 / level.resolution, ends, pose[None], counts)
            (known, hits), = counts  # fmt: skip
            assert 0 <= hits <= known <= len(ends)
            assert known == 0 or kind != "empty"


@given(
    st.lists(
        st.tuples(st.floats(-6.0, 6.0), st.floats(-6.0, 6.0)) | st.tuples(COORDINATES, COORDINATES), max_size=40
    )
)
def test_the_foreground_is_of_some_beams(ends):
    """One answer for each endpoint, wherever it is; at an end only what is close by."""
    points = np.array(ends, np.float32).reshape(-1, 2)
    assert not foreground(points).all() or not ends
    found = foreground(points, sees_past=True)
    assert len(found) == len(ends)
    assert (np.hypot(*points[[0, -1]][found[[0, -1]]].T) < BESIDE).all() if len(found) else True


@settings(max_examples=20, derandomize=True)
@given(MAPS, POSES, ENDS)
def test_landscapes_stay_within_the_map(kind, pose, points):
    """The cost at any pose, of any endpoints, on every level: at most that of endpoints that all miss."""
    poses = np.stack([pose, ORIGIN, pose + 0.5])
    for level in made(kind)[0].levels:
        for ends in (points, room()):
            assert not (costs(level, ends, poses) > 1.001 * len(ends)).any()


@settings(max_examples=20, derandomize=True)
@given(MAPS, POSES, ENDS)
def test_samples_and_points_stay_within_the_map(kind, pose, points):
    """The sampled covariance around any finite pose, and eqs. (4)-(6) at any point."""
    level = made(kind)[0].levels[0]
    if np.abs(pose).max() < 1e7:
        sampled_covariance(level, room(), pose, 0.2)
    us, vs = np.ascontiguousarray(points.T)
    assert interpolate(level.cells, us, vs).shape == (len(us), 3)


@settings(max_examples=10, derandomize=True)
@given(MAPS, ENDS, POSES)
def test_searches_stay_within_the_map(kind, points, pose):
    """The local search around any pose, and that of the whole map, by endpoints within the range of a laser."""
    pyramid, _ = made(kind)
    ends = np.clip(np.nan_to_num(points), -100.0, 100.0)
    if not math.isinf(pose[2]):  # a heading is wrapped wherever one is made
        find_pose(pyramid.levels[-1], points, pose, (1.0, 0.3))
    scan = StabilisedScan(ends, np.zeros(len(ends), np.float32), NO_POINTS, CLOSE)
    if not pyramid.empty:
        PlaceSearch(pyramid.levels[1], ends, 0.7).advance()
        assert 0.0 <= agreement(pyramid, scan, pose) <= 1.0
        known, crossing = crossings(pyramid, scan, pose)
        assert 0 <= crossing <= known <= len(ends)


RANGES = st.sampled_from([math.nan, math.inf, -math.inf, -1.0, 0.0, 0.3, 2.0, 2.02, 5.0, 80.0, 3e38]) | st.floats(
    0.1, 9.0
)
SIGMAS = st.sampled_from([-1.0, 0.0, 0.01, 0.05, 3.0, math.inf, math.nan])


@settings(max_examples=60, derandomize=True)
@given(
    st.lists(st.tuples(RANGES, RANGES), max_size=150),
    st.lists(SIGMAS, min_size=BANDS, max_size=BANDS).map(np.array),
    st.floats(-0.1, 0.1) | FAR,
)
def test_noise_is_taken_out_of_ranges_only(pairs, noise, increment):
    """Any scans, whatever their noise is taken for: what is no range stays as it is, and a range remains one."""
    ranges, before = np.array(pairs, np.float32).reshape(-1, 2).T.copy()
    limits = 0.25, 50.0
    angles = increment * np.arange(len(ranges))
    found = smooth(ranges, (np.cos(angles), np.sin(angles)), limits, noise, 0.04, 0.01)
    valid = (ranges >= limits[0]) & (ranges < limits[1])
    np.testing.assert_array_equal(found[~valid], ranges[~valid])
    assert (np.isfinite(found[valid]) & (found[valid] > 0.0)).all()
    estimates = np.full(BANDS, -1.0)
    learn_noise(ranges, before, limits, estimates, noise)
    assert np.isfinite(noise).all() and (noise <= 50.0).all()
