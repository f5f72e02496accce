"""A map that was frozen comes back as it was."""

import zlib

import numpy as np

from slam_core.config import MapConfig
from slam_core.mapping.frozen_map import FrozenMap, Packing
from slam_core.mapping.pyramid import Pyramid
from tests.worlds import same_map

CONFIG = MapConfig(resolution=0.4, size=64, levels=3)
ZLIB = Packing(zlib.compress, zlib.decompress)
LASER = np.zeros(2)
NONE = np.empty((0, 2), np.float32)


def ring(radius: float) -> np.ndarray:
    angles = np.linspace(0.0, 6.2, 90)
    return np.column_stack([radius * np.cos(angles), radius * np.sin(angles)]).astype(np.float32)


def drive(pyramid: Pyramid, places: list[float]) -> None:
    """A scan at each of these x."""
    for x in places:
        pyramid.update(ring(8.0), NONE, LASER, np.array([x, 0.0, 0.0]), CONFIG)
        pyramid.clear(ring(6.0), LASER, np.array([x, 1.0, 0.0]), CONFIG)


def test_a_thawed_map_goes_on_like_the_frozen_one():
    """Also when the window has moved, and tiles lie outside of it."""
    pyramid = Pyramid(CONFIG)
    drive(pyramid, [0.0, 60.0, 120.0])
    assert pyramid.stored
    frozen = FrozenMap(pyramid, ZLIB)
    thawed = frozen.thaw()
    assert isinstance(thawed, Pyramid)
    assert same_map(thawed, pyramid)
    assert (thawed.revision, thawed.updates, thawed.window) == (pyramid.revision, pyramid.updates, pyramid.window)
    for one in (pyramid, thawed):
        drive(one, [130.0, 60.0, 0.0])
    assert same_map(thawed, pyramid)
    assert sorted(thawed.changed_since(5)) == sorted(pyramid.changed_since(5))
    assert not same_map(frozen.thaw(), pyramid)


def test_unchanged_tiles_are_those_of_the_map_before():
    """Only tiles that changed since take memory again, and both maps come back as they were."""
    pyramid = Pyramid(CONFIG)
    drive(pyramid, [0.0, 60.0, 120.0])
    before, copy = FrozenMap(pyramid, ZLIB), pyramid.copy()
    revision = pyramid.revision
    drive(pyramid, [121.0])
    after = FrozenMap(pyramid, ZLIB, before)
    shared = {id(tile) for tile in before.tiles}
    new = [tile for tile in after.tiles if id(tile) not in shared]
    assert 0 < len(new) <= len(pyramid.changed_since(revision)) < len(after.tiles)
    assert same_map(before.thaw(), copy)
    assert same_map(after.thaw(), pyramid)
