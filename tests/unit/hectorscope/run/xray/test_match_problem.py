"""One scan with the map before it: what the X-ray steps through is what the core did."""

import itertools
from dataclasses import replace

import numpy as np

from hectorscope.run.settings import Settings
from hectorscope.run.xray.match_problem import problem_of
from slam_core.reference.scan_matching import transformed
from slam_core.slam import HectorSlam
from tests.xray import PAPER, problem, scanned


def test_the_iterations_are_those_of_the_core():
    """Under the paper's settings every iterate of the reference is that of the fast core, to a tenth of a mm."""
    found = problem()
    steps = found.iterations(found.start)
    trace = found.end(found.start, trace=True).trace
    assert [each.level for each in steps[:-1]] == trace[:, 0].tolist()
    after = np.array([each.pose for each in steps[1:]])
    np.testing.assert_allclose(after, trace[:, 1:], atol=1e-4)


def test_they_end_at_the_pose_of_the_run():
    """The start is that of the run and the map is the one before the scan: the run's match comes out again."""
    _, result = scanned()
    found = problem()
    assert result.match is not None
    np.testing.assert_allclose(found.iterations(found.start)[-1].pose, result.match.pose, atol=1e-4)
    np.testing.assert_allclose(found.matched, result.match.pose, atol=1e-6)


def test_a_direction_that_the_run_left_to_the_prediction_is_left_to_it_here():
    """The pose moves across the direction only, as that of the run did."""
    found = problem()
    held = replace(found, match=found.match._replace(unobservable=found.match.weakest_direction))
    along = held.end(held.start).unobservable
    np.testing.assert_allclose(np.linalg.norm(along), 1.0)
    assert abs((found.matched - found.start)[:2] @ along) > 1e-4
    assert abs((held.matched - held.start)[:2] @ along) < 1e-9


def test_beams_that_the_run_left_out_are_left_out_here():
    """Else the X-ray would show another match than that of the run."""
    rework, result = scanned()
    assert result.match is not None
    left_out = np.arange(20)
    without = result._replace(match=result.match._replace(left_out=left_out))
    found = problem_of(rework.before(Settings(PAPER)), without, PAPER)
    assert found is not None
    np.testing.assert_array_equal(found.points, result.points[20:])


def test_each_step_leads_to_the_next_pose():
    """Pose and step of an iteration add up to the pose of the next; the cost falls from level to level's end."""
    found = problem()
    steps = found.iterations(found.start)
    for before, after in itertools.pairwise(steps):
        np.testing.assert_allclose(before.pose + before.step, after.pose, atol=1e-12)
    assert steps[-1].cost <= next(each for each in steps if each.level == 0).cost


def test_arrows_are_finite_differences_of_the_map():
    """The gradient of each beam, where its difference crosses no edge between two patches of the map."""
    found = problem()
    now = found.iterations(found.start)[-1]
    grid, ends = found.grids[now.level], transformed(found.points.astype(float), now.pose)
    step = 1e-5 * grid.resolution
    for axis in (0, 1):
        offset = step * np.eye(2)[axis]
        up, down = grid.interpolate(ends + offset)[0], grid.interpolate(ends - offset)[0]
        edge = np.floor((ends + offset) / grid.resolution - 0.5) != np.floor(
            (ends - offset) / grid.resolution - 0.5
        )
        inside = ~edge.any(axis=1)
        assert inside.sum() > 300
        np.testing.assert_allclose(((up - down) / (2 * step))[inside], now.gradients[inside, axis], atol=1e-4)


def test_the_map_of_the_run_is_not_touched():
    """Looking inside works on a map of its own: the run goes on to the same bytes."""
    rework, _ = scanned()
    first = rework.before(Settings(PAPER)).slam.map.levels[0].cells.copy()
    problem().end(np.array([100.0, 50.0, 1.0]))
    assert np.array_equal(rework.before(Settings(PAPER)).slam.map.levels[0].cells, first)


def test_the_start_estimate_of_the_core_is_its_prediction():
    """By default a match begins at the filter's prediction."""
    found = problem()
    np.testing.assert_array_equal(HectorSlam(PAPER).start_estimate(found.prior, PAPER), found.prior.mean)
