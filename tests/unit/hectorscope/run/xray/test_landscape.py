"""The cost over a plane of poses, and its basin."""

import numpy as np
import pytest

from hectorscope.run.xray.landscape import FAILED, FOUND, SIDE, UNTRIED, Around, Basin, is_same, landscape
from slam_core.reference.scan_matching import evaluate
from tests.xray import problem

PLANES = [Around("xy", 0.3), Around("xyaw", 0.3)]


@pytest.mark.parametrize("around", PLANES)
def test_the_lowest_cost_of_the_finest_level_is_at_the_matched_pose(around: Around):
    """Within a step of the grid of poses."""
    found, matched = landscape(problem(), 0, around), problem().matched
    along, up = around.step
    apart = np.abs(found.lowest - matched)
    assert apart[0] <= 1.01 * along
    assert apart[1 if around.plane == "xy" else 2] <= 1.01 * up


@pytest.mark.parametrize("level", [0, 1, 2])
def test_costs_are_those_of_the_reference(level: int):
    """Eq. (7) in float64, at some poses of the plane, on each level; a float32 sum differs by its rounding."""
    around = Around("xy", 1.0, 0.2)
    found, poses = landscape(problem(), level, around), around.poses(problem().matched)
    for row, column in ((0, 0), (30, 30), (12, 55)):
        there = evaluate(problem().grids[level], problem().points.astype(float), poses[row, column])
        assert found.costs[row, column] == pytest.approx(there.cost, rel=1e-3)


def test_rows_go_along_y_or_yaw_and_columns_along_x():
    """The middle is the matched pose; the yaw that was asked for turns all poses of the plane of x and y."""
    centre = np.array([1.0, 2.0, 0.5])
    plane = Around("xy", 3.0, 0.1).poses(centre)
    np.testing.assert_allclose(plane[SIDE // 2, SIDE // 2], [1.0, 2.0, 0.6])
    np.testing.assert_allclose(plane[0, -1], [4.0, -1.0, 0.6])
    np.testing.assert_allclose(Around("xyaw", 3.0).poses(centre)[-1, 0], [-2.0, 2.0, 1.0])


def test_a_basin_says_where_each_start_ends():
    """Every start once, the matched pose among those that end there; each outcome is that of the matcher."""
    around = Around("xy", 1.5)
    basin, found = Basin(problem(), around), problem()
    for _ in range(40):
        basin.try_next()
    assert basin.tried == 40 == (basin.outcome != UNTRIED).sum()
    assert (basin.coarse() != UNTRIED).all()
    while not basin.whole:
        basin.try_next()
    assert basin.outcome[SIDE // 2, SIDE // 2] == FOUND
    assert {FOUND, FAILED} == set(np.unique(basin.outcome).tolist())
    poses = around.poses(found.matched)
    for row, column in ((0, 0), (25, 33), (60, 7)):
        same = is_same(found, found.end(poses[row, column]).pose)
        assert basin.outcome[row, column] == (FOUND if same else FAILED)
    np.testing.assert_array_equal(basin.coarse(), basin.outcome)
