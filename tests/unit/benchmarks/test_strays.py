"""Beams that tell nothing of the walls."""

import numpy as np
import pytest

from benchmarks.cases import METHODS
from benchmarks.strays import NEAREST, Panes, astray, glass
from hectorscope.simulation import SceneOptions
from hectorscope.simulation.worlds import Surface, World, fence
from slam_core.mapping.grid import GridLevel
from slam_core.measurements import Imu, LaserScan

PANE = fence(np.array([(0.0, 0.0), (1.0, 0.0)]), -1.0, 1.0)


def test_so_many_beams_end_on_the_way_and_the_others_are_as_they_were() -> None:
    """A fifth of them, nowhere nearer than allowed and never behind the wall, or missing; other items go by."""
    scan = LaserScan(0, np.full(20000, 5.0, np.float32), 0.0, 1e-4)
    imu = Imu(1, np.zeros(3), np.zeros(3))
    struck, passed = astray([scan, imu], 0.2, seed=1)
    changed = struck.ranges != scan.ranges
    assert np.mean(changed) == pytest.approx(0.2, abs=0.01)
    assert NEAREST <= struck.ranges[changed].min() < struck.ranges[changed].max() <= 5.0
    assert passed is imu
    without, _ = astray([scan, imu], 0.2, seed=1, missing=True)
    assert np.array_equal(np.isnan(without.ranges), changed)
    assert np.array_equal(next(iter(astray([scan], 0.0, seed=1))).ranges, scan.ranges)


def test_cells_that_come_again_flicker() -> None:
    """Two cells of a pane that are occupied; one goes and comes back, the other goes for good."""
    panes = Panes(World([Surface(PANE, glass=True)]))
    level = GridLevel(0.05, (40, 40), np.array([-0.5, -1.0]))
    column, row = level.cell_of(0.51, 0.01)
    for here, there in ((1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)):
        level.log_odds[row, column], level.log_odds[row, column + 4] = here, there
        panes.look(level)
    assert panes.flicker == 0.5
    assert Panes(World([Surface(PANE, glass=True)])).flicker == 0.0


def test_without_glass_the_same_hall_has_walls() -> None:
    """A short drive: both halls are followed, and they are not the same."""
    outcomes = glass(SceneOptions(duration=5.0, beams=271, scan_rate=10.0), seed=1)
    assert set(outcomes) == set(METHODS)
    for each in outcomes.values():
        assert 0.0 < each.solid.raw < 0.1 > each.glass.raw > 0.0
        assert each.solid != each.glass
        assert 0.0 <= each.flicker <= 1.0
