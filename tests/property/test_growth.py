"""A map that grew must be the map that was large from the start."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from slam_core.config import MapConfig
from slam_core.mapping.pyramid import Pyramid
from tests.worlds import same_map

REACH = 8.0  # metres that a beam goes at most
STEP = 4.0  # and the robot between two scans


def walk(seed, scans):
    """Random scans from a random walk: points, cleared, laser, pose of each."""
    rng = np.random.default_rng(seed)
    pose = np.zeros(3)
    for _ in range(scans):
        pose = pose + rng.uniform(-1, 1, 3) * (STEP, STEP, 3.0)
        beams, angles = rng.uniform(0, REACH, (2, 30)), rng.uniform(-np.pi, np.pi, (2, 30))
        points, cleared = (
            np.column_stack([r * np.cos(a), r * np.sin(a)]).astype(np.float32)
            for r, a in zip(beams, angles, strict=True)
        )
        yield points, cleared[: rng.integers(0, 20)], rng.uniform(-0.2, 0.2, 2), pose


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10_000), st.integers(1, 6), st.integers(64, 130), st.floats(0, 1), st.floats(0, 1))
def test_a_grown_map_is_the_map_that_was_large_from_the_start(seed, levels, size, start_x, start_y):
    """Wherever it starts and whatever the walk: every cell of every level is the same to the last bit."""
    small = MapConfig(resolution=0.1, size=size, levels=levels, start_x=start_x, start_y=start_y)
    large = MapConfig(resolution=0.1, size=1024, levels=levels, grow=False)
    grown, whole = Pyramid(small), Pyramid(large)
    for scan in walk(seed, 6):
        grown.update(*scan, small)
        whole.update(*scan, large)
    assert same_map(grown, whole)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10_000), st.integers(1, 6), st.integers(64, 130))
def test_levels_stay_aligned_on_one_corner(seed, levels, size):
    """After every scan all levels cover the same area, and a cell holds exactly four of the level below."""
    config = MapConfig(resolution=0.1, size=size, levels=levels)
    pyramid = Pyramid(config)
    for scan in walk(seed, 6):
        pyramid.update(*scan, config)
        finest = pyramid.levels[0]
        for i, level in enumerate(pyramid.levels):
            assert (level.corner * 2**i == finest.corner).all()
            assert tuple(n * 2**i for n in level.shape) == finest.shape
            assert level.log_odds.shape == level.cells.shape
            assert all(n % level.tile == 0 for n in level.box)
