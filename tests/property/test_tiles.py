"""A map in tiles is the map that a large dense window would hold, for whoever writes and reads it."""

from copy import deepcopy

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from slam_core.config import MapConfig, MatcherConfig, SlamConfig
from slam_core.localization.global_search import agreement, locate
from slam_core.localization.map_view import crossings
from slam_core.localization.search_parts import Region
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.correlative import find_pose
from slam_core.matching.matcher import coarse_to_fine
from slam_core.scan.stabilise import StabilisedScan
from tests.worlds import same_map

CELL = 0.4  # metres: a dense map of some hundred metres stays small
DENSE = 2048
REACH = 8.0
LIMIT = 350.0  # metres from the start
NONE = np.empty((0, 2), np.float32)


def configs(levels: int) -> tuple[MapConfig, MapConfig]:
    """Of a map in tiles, and of one whose first window holds all."""
    small = MapConfig(resolution=CELL, size=64, levels=levels)
    return small, MapConfig(resolution=CELL, size=DENSE, levels=levels, grow=False, limit=500.0)


def walk(seed: int, scans: int):
    """Random scans from places anywhere: points, laser, pose."""
    rng = np.random.default_rng(seed)
    pose = np.zeros(3)
    for _ in range(scans):
        pose[:2] = np.clip(pose[:2] + rng.uniform(-150, 150, 2), -LIMIT, LIMIT)
        pose[2] = rng.uniform(-3, 3)
        ranges, angles = rng.uniform(1, REACH, 40), np.sort(rng.uniform(-np.pi, np.pi, 40))
        points = np.column_stack([ranges * np.cos(angles), ranges * np.sin(angles)]).astype(np.float32)
        yield points, rng.uniform(-0.2, 0.2, 2), pose.copy()


def write(pyramid: Pyramid, scan, config: MapConfig) -> None:
    """A scan is written; and a shorter one and the scan again clear what they pass."""
    points, laser, pose = scan
    pyramid.cover(points, pose)
    pyramid.update(points, points[:5] * np.float32(1.1), laser, pose, config)
    pyramid.update(points * np.float32(0.6), NONE, laser, pose, config)
    for _ in range(3):
        pyramid.clear(points, laser, pose, config)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10_000), st.integers(1, 4), st.integers(1, 12))
def test_a_map_in_tiles_holds_what_a_dense_one_does(seed: int, levels: int, scans: int):
    """Whatever was written and cleared, and wherever the window was meanwhile: every cell, to the last bit."""
    small, large = configs(levels)
    tiled, dense = Pyramid(small), Pyramid(large)
    for scan in walk(seed, scans):
        write(tiled, scan, small)
        write(dense, scan, large)
    assert same_map(tiled, dense)
    assert not dense.stored
    for level in range(levels if tiled.stored else 0):
        assert tiled.whole(level).log_odds.tobytes() == dense.gather(level, dense.bounds(level)).tobytes()


def made(seed: int) -> tuple[Pyramid, Pyramid, list]:
    """The same map in tiles and dense, and the scans in it."""
    small, large = configs(3)
    tiled, dense, scans = Pyramid(small), Pyramid(large), list(walk(seed, 12))
    for scan in scans:
        write(tiled, scan, small)
        write(dense, scan, large)
    return tiled, dense, scans


def test_the_maps_of_these_tests_are_in_tiles():
    """More tiles lie outside of the window than in it, or the tests would show nothing."""
    tiled, _, _ = made(0)
    assert tiled.stored > 10
    assert tiled.nbytes < 0.3 * Pyramid(configs(3)[1]).nbytes


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 10_000), st.floats(-1.0, 1.0), st.floats(-0.3, 0.3))
def test_matches_and_searches_read_the_same(seed: int, shift: float, turn: float):
    """At places that were left long ago: match, local search, surprises, agreement, crossings: to the last bit."""
    tiled, dense, scans = made(seed)
    for points, laser, pose in scans[:4]:
        start = pose + np.array([shift, -shift, turn])
        scan = StabilisedScan(points, np.zeros(len(points), np.float32), NONE, laser)
        ours, theirs = (coarse_to_fine(each, points, start, MatcherConfig()) for each in (tiled, dense))
        assert (ours.pose.tobytes(), ours.residuals.tobytes()) == (
            theirs.pose.tobytes(),
            theirs.residuals.tobytes(),
        )
        assert ours.fit == theirs.fit
        tiled.cover(points, start)
        ours, theirs = (find_pose(each.levels[-1], points, start, (2.0, 0.5)) for each in (tiled, dense))
        assert ours.tobytes() == theirs.tobytes()
        assert tiled.unexpected(points, start).tobytes() == dense.unexpected(points, start).tobytes()
        assert agreement(tiled, scan, start) == agreement(dense, scan, start)
        assert crossings(tiled, scan, start) == crossings(dense, scan, start)


@settings(max_examples=5, deadline=None)
@given(st.integers(0, 10_000))
def test_a_lost_robot_is_found_in_tiles_as_in_a_dense_map(seed: int):
    """In a region and in the whole map: the same place, or the same reason."""
    tiled, dense, scans = made(seed)
    for points, laser, pose in scans[:2]:
        scan = StabilisedScan(points, np.zeros(len(points), np.float32), NONE, laser)
        for region in (None, Region(pose, 30.0)):
            ours, theirs = (locate(each, scan, SlamConfig(), region) for each in (tiled, dense))
            assert ours.failure == theirs.failure
            if ours.match is not None and theirs.match is not None:
                assert ours.match.pose.tobytes() == theirs.match.pose.tobytes()


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10_000), st.integers(1, 4))
def test_tiles_that_are_not_reported_as_changed_are_the_same(seed: int, levels: int):
    """What follows the map by revisions and copies what changed has all of it, wherever the window goes."""
    small, _ = configs(levels)
    pyramid, followed, seen = Pyramid(small), {}, 0
    for scan in walk(seed, 8):
        write(pyramid, scan, small)
        followed |= {key: pyramid.tile(key) for key in pyramid.changed_since(seen)}
        seen = pyramid.revision
    assert pyramid.changed_since(seen) == []
    assert set(followed) == set(pyramid.changed_since(0))
    for key, tile in followed.items():
        now = pyramid.tile(key)
        assert (now is None) == (tile is None)
        if now is not None and tile is not None:
            assert [a.tobytes() for a in now.log_odds] == [a.tobytes() for a in tile.log_odds]
            assert (now.surfels is None) == (tile.surfels is None)


@pytest.mark.parametrize("copied", [Pyramid.copy, deepcopy])
def test_copies_share_tiles_and_go_their_own_ways(copied):
    """Both go on alike with the same scans; what one writes the other does not see."""
    small, _ = configs(3)
    pyramid, _, _ = made(1)
    other, untouched = copied(pyramid), copied(pyramid)
    assert all(other._tiles[key] is tile for key, tile in pyramid._tiles.items())
    for scan in walk(2, 6):
        write(pyramid, scan, small)
    assert not same_map(pyramid, other)
    assert same_map(other, untouched)
    for scan in walk(2, 6):
        write(other, scan, small)
    assert same_map(pyramid, other)


def test_at_its_limit_the_map_takes_no_new_tile_and_keeps_those_it_has():
    """Memory stays below the limit on an endless drive; on the way back the old tiles are there and change."""
    config = MapConfig(resolution=CELL, size=64, levels=2, limit=5.0)
    pyramid = Pyramid(config)
    scan = next(walk(0, 1))
    places = [np.array([20.0 * k, 0.0, 0.0]) for k in range(400)]
    for pose in places:
        write(pyramid, (scan[0], scan[1], pose), config)
        assert pyramid.nbytes <= 5e6
    assert pyramid.stopped_at == 5.0
    tiles = set(pyramid.changed_since(0))
    assert 50 < len(tiles) < 300
    before = pyramid.revision
    for pose in reversed(places):
        write(pyramid, (scan[0], scan[1], pose), config)
        assert pyramid.nbytes <= 5e6
    assert set(pyramid.changed_since(0)) == tiles
    assert len(set(pyramid.changed_since(before)) & tiles) > 0.9 * len(tiles)
