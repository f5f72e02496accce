"""What a sweep changes must not hang on how beams share a way, nor on how cells share a row."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from slam_core.kernels.dynamic_objects import by_bearing
from slam_core.mapping.grid import GridLevel
from slam_core.mapping.pyramid import log_odds
from slam_core.mapping.tiles import derived

FREE, OCCUPIED = log_odds(0.4), log_odds(0.9)
CELLS = 400


def way(start, end):
    """Cells (n, 2) from start up to end, without it: the places across are rounded, halves towards the start."""
    d = end - start
    long = np.abs(d).max()
    if not long:
        return np.empty((0, 2), np.int64)
    k = np.arange(long)
    # ceil(k |d| / long - 1/2) in whole numbers
    steps = np.sign(d) * ((2 * k[:, None] * np.abs(d) + long - 1) // (2 * long))
    return start + steps


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10_000), st.integers(3, 900), st.floats(0.5, 2 * np.pi), st.booleans())
def test_a_sweep_frees_the_ways_of_all_its_beams(seed, beams, angle, jagged):
    """Near walls or jagged ones, few or many beams, any field of view: exactly the cells of the beams' ways."""
    rng = np.random.default_rng(seed)
    level = GridLevel(1.0, (CELLS, CELLS), np.zeros(2))
    start = rng.integers(150, 250, 2)
    angles = rng.uniform(-np.pi, np.pi) + np.linspace(0, angle, beams)
    ranges = rng.uniform(1, 145, beams if jagged else 1 + beams // 50)
    ranges = np.interp(np.linspace(0, 1, beams), np.linspace(0, 1, len(ranges)), ranges)
    ends = start + np.rint(ranges[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])).astype(int)
    level.update(start + 0.5, ends + 0.5, np.empty((0, 2)), (FREE, OCCUPIED), (-50.0, 50.0))
    expected = np.zeros((CELLS, CELLS), bool)
    for end in ends:
        cells = way(start, end)
        expected[cells[:, 1], cells[:, 0]] = True
    expected[ends[:, 1], ends[:, 0]] = False
    np.testing.assert_array_equal(level.log_odds < 0, expected)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10_000), st.integers(1, 100), st.integers(1, 100), st.integers(0, 40))
def test_a_map_of_any_width_is_that_part_of_a_wide_one(seed, rows, columns, beams):
    """Narrower than a block of cells, or not a whole number of them: both maps are the same to the last bit."""
    rng = np.random.default_rng(seed)
    narrow, wide = (GridLevel(1.0, shape, np.zeros(2)) for shape in ((rows, columns), (128, 128)))
    for _ in range(4):
        start = rng.uniform(0, (columns, rows))
        ends, empty = (rng.uniform(0, (columns, rows), (n, 2)) for n in (beams, beams // 4))
        for level in (narrow, wide):
            level.update(start, ends, empty, (FREE, OCCUPIED), (-2.0, 3.0), -0.5)
    # Beyond its edge the narrow map has no cell behind a beam's end.
    np.testing.assert_array_equal(narrow.log_odds, wide.log_odds[:rows, :columns])
    np.testing.assert_array_equal(narrow.cells, wide.cells[:rows, :columns])


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10_000), st.floats(0.1, 0.9), st.floats(0.01, 0.9))
def test_what_the_matcher_reads_follows_from_the_log_odds(seed, occupied, free):
    """Of cells that were written, and of cells that beams passed later: both round alike, to the last bit."""
    rng = np.random.default_rng(seed)
    level = GridLevel(1.0, (128, 128), np.zeros(2), tile=64)
    start, angles = np.full(2, 64.3), np.sort(rng.uniform(-np.pi, np.pi, 200))
    ways = np.column_stack([np.cos(angles), np.sin(angles)])
    for _ in range(3):
        ends = start + rng.uniform(5, 30, (200, 1)) * ways
        level.update(start, ends, np.empty((0, 2)), (-free, occupied), (-9.0, 9.0))
    beams = by_bearing(start, start + 50.0 * ways)
    assert level.clear(start, beams, 1.5, 4.0, -free)
    np.testing.assert_array_equal(level.cells, derived(level.log_odds))
