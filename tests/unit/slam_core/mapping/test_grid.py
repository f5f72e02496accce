"""The log-odds level: what one scan may change, and where."""

import os
from pathlib import Path

import numpy as np
import pytest

from slam_core.mapping.grid import GridLevel
from slam_core.mapping.pyramid import log_odds
from slam_core.mapping.tiles import holds, tiles_around

FREE, OCCUPIED = log_odds(0.4), log_odds(0.9)
NONE = np.empty((0, 2))
STATM = Path("/proc/self/statm")
MEGABYTE = 1_000_000


def update(level, start, ends, cleared=NONE, caps=(-50.0, 50.0), revision=1):
    ends = np.array(ends, float).reshape(-1, 2)
    level.update(np.array(start), ends, cleared, (FREE, OCCUPIED), caps, revision=revision)


@pytest.fixture
def level():
    return GridLevel(1.0, (20, 30), np.array([-10.0, -5.0]))


def test_steps_are_the_log_odds_of_the_factors():
    """Factors 0.4 and 0.9 give the known steps of -0.405 and +2.197."""
    assert (round(FREE, 3), round(OCCUPIED, 3)) == (-0.405, 2.197)


def test_one_beam_frees_its_way_and_occupies_its_end(level):
    """Cells from the laser up to the end get the free step, the end only the occupied one, others nothing."""
    update(level, (0.5, 0.5), [(6.5, 0.5)])
    row = level.log_odds[5]
    np.testing.assert_allclose(row[10:16], FREE, rtol=1e-6)
    assert row[16] == pytest.approx(OCCUPIED)
    assert np.count_nonzero(level.log_odds) == 7


def test_one_change_a_cell_a_scan(level):
    """A hundred equal beams change each cell as much as one does."""
    update(level, (0.5, 0.5), [(6.5, 0.5)] * 100)
    assert level.log_odds[5, 16] == pytest.approx(OCCUPIED)
    assert level.log_odds[5, 12] == pytest.approx(FREE)


def test_a_hit_wins_over_a_passing_beam_in_either_order(level):
    """A cell that one beam hits and another crosses takes the occupied step only, whatever comes first."""
    other = level.copy()
    update(level, (0.5, 0.5), [(6.5, 0.5), (9.5, 0.5)])
    update(other, (0.5, 0.5), [(9.5, 0.5), (6.5, 0.5)])
    assert level.log_odds[5, 16] == pytest.approx(OCCUPIED)
    np.testing.assert_array_equal(level.log_odds, other.log_odds)


def test_probability_follows_log_odds(level):
    """The probability that the matcher reads is the logistic of the log-odds everywhere."""
    rng = np.random.default_rng(0)
    for _ in range(5):
        update(level, (0.5, 0.5), rng.uniform((-9, -4), (18, 13), (40, 2)))
    np.testing.assert_allclose(level.probability, 1 / (1 + np.exp(-level.log_odds)), atol=2.0**-16)


def test_caps_hold(level):
    """No cell leaves the range of the caps."""
    for _ in range(200):
        update(level, (0.5, 0.5), [(6.5, 0.5)], caps=(-3.0, 4.0))
    assert level.log_odds.min() == -3.0
    assert level.log_odds.max() == 4.0


def test_beams_without_return_clear_and_occupy_nothing(level):
    """A cleared ray frees its way and marks no end."""
    update(level, (0.5, 0.5), NONE, cleared=np.array([[6.5, 0.5]]))
    assert level.log_odds.max() == 0.0
    assert np.count_nonzero(level.log_odds < 0) == 6


@pytest.mark.parametrize("end", [(500.5, 0.5), (0.5, -300.0), (400.0, 500.0), (-77.0, -3.0)])
def test_an_end_off_the_map_is_clipped(level, end):
    """A beam that leaves the map frees its cells inside and touches nothing else; the known box stays inside."""
    update(level, (0.5, 0.5), [end])
    assert level.log_odds.max() == 0.0
    assert np.count_nonzero(level.log_odds) >= 4
    row0, row1, column0, column1 = level.known
    assert 0 <= row0 < row1 <= 20
    assert 0 <= column0 < column1 <= 30


def test_a_laser_off_the_map_only_marks_ends(level):
    """With the laser off the map no ray is drawn, and nothing breaks."""
    update(level, (100.0, 0.5), [(6.5, 0.5)])
    assert np.count_nonzero(level.log_odds) == 1


def test_known_box_holds_every_touched_cell(level):
    """Whatever was touched lies in the known box."""
    rng = np.random.default_rng(1)
    update(level, (0.5, 0.5), rng.uniform((-9, -4), (18, 13), (25, 2)))
    row0, row1, column0, column1 = level.known
    outside = level.log_odds.copy()
    outside[row0:row1, column0:column1] = 0.0
    assert not outside.any()


@pytest.mark.parametrize("shape", [(24, 32), (32, 48)])
@pytest.mark.parametrize("by", [(0, 0), (8, 0), (0, -8), (-8, 16), (16, 8), (-80, 0), (0, 400)])
def test_a_window_that_moves_keeps_what_stays_in_it(shape, by):
    """Cells keep content and place in the map; all else in the window is unknown, however far it moved."""
    level = GridLevel(1.0, (24, 32), np.array([-16.0, -8.0]), surfels=True, tile=8)
    rng = np.random.default_rng(0)
    update(level, (0.5, 0.5), rng.uniform((-15, -7), (15, 15), (25, 2)))
    level.surfels[:] = (level.log_odds > 0) * np.uint32(7)
    old = level.copy()
    level.move(old.corner + np.array(by), shape)
    assert level.shape == shape
    assert level.corner.tolist() == (old.corner + np.array(by)).tolist()
    for kind in ("log_odds", "cells", "surfels"):
        np.testing.assert_array_equal(getattr(level, kind), old.gather(level.box, kind))
    tiles = {key for key in old.seen() if holds(tiles_around(level.box, 8), key)}
    assert set(level.seen()) == tiles
    assert level.bounds == old.bounds


@pytest.mark.parametrize("tile", [2, 4, 8, 16, 64])
def test_the_tiles_that_a_scan_changes_take_its_revision(tile):
    """All that changed do, whatever their size; those of eight cells and more only if they changed."""
    level = GridLevel(1.0, (192, 256), np.zeros(2), tile=tile)
    rng = np.random.default_rng(2)
    for revision in (3, 4):
        before = level.copy()
        update(level, (60.5, 70.5), rng.uniform((40, 50), (150, 120), (12, 2)), revision=revision)
        changed = level.log_odds != before.log_odds
        tiles = changed.reshape(192 // tile, tile, 256 // tile, tile).any(axis=(1, 3))
        assert (level.revisions[tiles] == revision).all()
        if tile >= 8:
            assert (level.revisions[~tiles] == before.revisions[~tiles]).all()
    assert {0, 3, 4} == set(level.revisions.flat) or tile == 64


def test_occupancy_is_a_ros_grid(level):
    """-1 where unknown, else the probability in percent."""
    update(level, (0.5, 0.5), [(6.5, 0.5)])
    grid = level.occupancy()
    assert grid.dtype == np.int8
    assert grid[5, 16] == 90
    assert grid[5, 12] == 40
    assert grid[0, 0] == -1


def test_the_free_way_matches_a_plain_walk(level):
    """The cells freed are those of a Bresenham walk written the slow way, for every direction."""
    rng = np.random.default_rng(7)
    for _ in range(50):
        fresh = GridLevel(1.0, (20, 30), np.array([-10.0, -5.0]))
        end = np.floor(rng.uniform((-10, -5), (20, 15))) + 0.5
        update(fresh, (4.5, 5.5), [end])
        du, dv = end[0] - 4.5, end[1] - 5.5
        n = int(max(abs(du), abs(dv)))
        freed = {(int(c) - 10, int(r) - 5) for r, c in np.argwhere(fresh.log_odds < 0)}
        # A tie (exactly half a cell) may go to either side.
        assert len(freed) == max(n, 0)
        for u, v in freed:
            k = abs(u - 4) if abs(du) >= abs(dv) else abs(v - 5)
            ideal = (4 + du * k / n, 5 + dv * k / n)
            assert max(abs(u - ideal[0]), abs(v - ideal[1])) <= 0.5 + 1e-9


def test_many_beams_free_what_each_alone_would(level):
    """The cells that a scan changes are the union of those of its beams, even of two into one cell."""
    rng = np.random.default_rng(3)
    ends = np.repeat(rng.uniform((-15, -9), (25, 19), (30, 2)), 2, axis=0)
    update(level, (4.5, 5.5), ends)
    freed, hit = np.zeros(level.shape, bool), np.zeros(level.shape, bool)
    for end in ends:
        alone = GridLevel(level.resolution, level.shape, level.origin)
        update(alone, (4.5, 5.5), [end])
        freed |= alone.log_odds < 0
        hit |= alone.log_odds > 0
    np.testing.assert_array_equal(level.log_odds > 0, hit)
    np.testing.assert_array_equal(level.log_odds < 0, freed & ~hit)


def test_an_end_beyond_all_measure_writes_nothing_outside(level):
    """A beam of thousands of kilometres leaves a sound map: no ray, no end."""
    update(level, (0.5, 0.5), [(4e6, 3e5), (6.5, 0.5)])
    assert np.count_nonzero(level.log_odds) == 7


def test_a_long_walk_is_exact():
    """On a large map the freed cells are those of the walk in whole numbers, to the last one."""
    rng = np.random.default_rng(11)
    for end in rng.integers(0, 3000, (20, 2)):
        level = GridLevel(1.0, (3000, 3000), np.zeros(2))
        update(level, (1400.5, 1700.5), [end + 0.5])
        (du, dv), start = np.abs(end - (1400, 1700)), np.array([1400, 1700])
        long, short = max(du, dv), min(du, dv)
        k = np.arange(long)
        across = (k * short + long - 1 - (long >> 1)) // long
        steps = np.column_stack([k, across] if du >= dv else [across, k])
        expected = start + np.sign(end - start) * steps
        np.testing.assert_array_equal(
            np.argwhere(level.log_odds < 0), np.array(sorted((v, u) for u, v in expected.tolist()))
        )


def test_the_cell_behind_an_end_sinks_no_lower_than_asked(level):
    """It takes free steps, whether unknown or occupied before, down to the bound; one further away takes none."""
    for count in range(1, 10):
        level.update(np.array([0.5, 0.5]), np.array([[6.5, 0.5]]), NONE, (FREE, OCCUPIED), (-50.0, 50.0), -1.0)
        assert level.log_odds[5, 17] == pytest.approx(max(count * FREE, -1.0))
    assert level.log_odds[5, 16] == pytest.approx(9 * OCCUPIED)
    assert not level.log_odds[5, 18:].any()
    assert level.known == (4, 7, 9, 18)


def test_what_a_scan_sees_wins_over_what_lies_behind(level):
    """A cell behind one end that another beam crosses or ends in takes the step of that beam."""
    ends = np.array([[6.5, 0.5], [7.5, 0.5], [9.5, 0.5]])
    for _ in range(9):
        level.update(np.array([0.5, 0.5]), ends, NONE, (FREE, OCCUPIED), (-50.0, 50.0), -1.0)
    said = 9 * np.array([OCCUPIED, OCCUPIED, FREE, OCCUPIED])
    np.testing.assert_allclose(level.log_odds[5, 16:20], said, rtol=1e-5)


def test_a_cell_that_is_free_stays_free_behind_an_end(level):
    """The bound holds back the step, it does not undo what beams that crossed the cell have said."""
    for _ in range(9):
        update(level, (0.5, 0.5), [(9.5, 0.5)])
    level.update(np.array([0.5, 0.5]), np.array([[6.5, 0.5]]), NONE, (FREE, OCCUPIED), (-50.0, 50.0), -1.0)
    assert level.log_odds[5, 17] == pytest.approx(9 * FREE)


def resident() -> int:
    """Bytes of this process that are in memory."""
    return int(STATM.read_text().split()[1]) * os.sysconf("SC_PAGESIZE")


@pytest.mark.skipif(not STATM.exists(), reason="the system does not tell how much memory was touched")
def test_a_large_level_takes_memory_where_beams_go():
    """Of 184 MB next to nothing at first; a beam along a column takes one small page a row."""
    update(GridLevel(1.0, (64, 64), np.zeros(2)), (1.0, 1.0), [(9.0, 9.0)])  # to compile takes memory, too
    before = resident()
    level = GridLevel(0.05, (4096, 4096), np.zeros(2), surfels=True)
    assert level.nbytes > 180 * MEGABYTE
    assert resident() - before < 10 * MEGABYTE
    update(level, (100.0, 20.0), [(100.0, 120.0)])
    assert np.count_nonzero(level.log_odds[400:2400, 2000]) == 2000
    assert resident() - before < 40 * MEGABYTE


def test_a_large_level_and_its_copy_are_written_apart():
    """As small ones are."""
    level = GridLevel(0.05, (2048, 2048), np.zeros(2))
    other = level.copy()
    update(level, (50.0, 50.0), [(60.0, 50.0)])
    assert level.log_odds.any()
    assert level.cells.any()
    assert not other.log_odds.any()
    assert not other.cells.any()
