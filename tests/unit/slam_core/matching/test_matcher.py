"""Equations (7)-(15) against plain numpy in double precision, finite differences and brute force."""

import math
from dataclasses import replace

import numpy as np
import pytest

from slam_core.config import MapConfig, MatcherConfig, SlamConfig, leaves
from slam_core.kernels import gauss_newton
from slam_core.kernels.coarse_to_fine import match_coarse_to_fine
from slam_core.kernels.gauss_newton import TOGETHER
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.matcher import (
    beams_of,
    coarse_to_fine,
    hessian_covariance,
    normal_equations,
    sampled_covariance,
)
from slam_core.results import PlanarGaussian
from slam_core.scan.stabilise import ScanConfig, stabilise
from tests.worlds import fit, in_parts, room_scan, smooth_level, standing

POSE = np.array([1.6, 1.5, 0.3])
ROOM = MapConfig(size=400, levels=3)


def scan_points(n=200, seed=0):
    """Endpoints within a metre of the sensor."""
    return np.random.default_rng(seed).uniform(-0.9, 0.9, (n, 2)).astype(np.float32)


def cost(level, points, pose):
    """Eq. (7) with (8) and (4) in plain double-precision numpy."""
    c, s = math.cos(pose[2]), math.sin(pose[2])
    world = points.astype(float) @ np.array([[c, s], [-s, c]]) + pose[:2]
    u, v = (world / level.resolution - 0.5).T
    i, j = np.floor(u).astype(int), np.floor(v).astype(int)
    fu, fv = u - i, v - j
    p = level.probability.astype(float)
    low = (1 - fu) * p[j, i] + fu * p[j, i + 1]
    high = (1 - fu) * p[j + 1, i] + fu * p[j + 1, i + 1]
    return (1 - ((1 - fv) * low + fv * high)), (world, u, v)


def jacobian(level, points, pose, h=1e-7):
    """D M(S_i(xi)) / d xi by central differences, (n, 3)."""
    columns = []
    for axis in np.eye(3):
        plus, _ = cost(level, points, pose + h * axis)
        minus, _ = cost(level, points, pose - h * axis)
        columns.append(-(plus - minus) / (2 * h))
    return np.column_stack(columns)


def room_points(pose, **kwargs):
    """The scan of the test room as endpoints."""
    return stabilise(room_scan(pose, **kwargs), standing, ScanConfig(range_min=0.1)).points


@pytest.fixture(scope="module")
def room():
    """A pyramid that has seen the test room from five places."""
    return mapped(3)


def mapped(levels):
    """The same with so many levels."""
    config = replace(ROOM, levels=levels)
    pyramid = Pyramid(config)
    for x, y, psi in [(0, 0, 0), (0.5, 0.2, 0.4), (-0.5, -0.3, 1.9), (1.0, -0.8, -2.0), (-1.2, 0.6, 3.0)]:
        pose = np.array([x, y, psi], float)
        pyramid.update(room_points(pose), np.empty((0, 2), np.float32), np.zeros(2), pose, config)
    return pyramid


def test_cost_is_equation_7():
    """The kernel's cost equals the sum of squared residuals in double precision."""
    level, points = smooth_level(), scan_points()
    errors, _ = cost(level, points, POSE)
    assert normal_equations(level, beams_of(points), POSE)[2] == pytest.approx(np.sum(errors**2), rel=1e-5)


def test_beams_are_added_up_however_many_they_are():
    """More than are looked at together: the sums are those of the parts, and every beam has its residual."""
    level, points = smooth_level(), scan_points(2 * TOGETHER + 77)
    hessian, right, whole = normal_equations(level, beams_of(points), POSE)
    errors, _ = cost(level, points, POSE)
    assert whole == pytest.approx(np.sum(errors**2), rel=1e-5)
    parts = [normal_equations(level, beams_of(part), POSE) for part in np.array_split(points, 7)]
    np.testing.assert_allclose(hessian, sum(part[0] for part in parts), rtol=1e-4, atol=1e-3)
    np.testing.assert_allclose(right, sum(part[1] for part in parts), rtol=1e-4, atol=1e-3)


def test_a_match_says_how_it_meets_the_coarsest_level(room):
    """Whatever the pose that it ended at, and with ends off the map."""
    points = np.concatenate([room_points(np.zeros(3)), [[50.0, 0.0]]]).astype(np.float32)
    for start in (np.zeros(3), np.array([0.1, -0.05, 0.02]), np.array([3.0, 1.0, 2.0])):
        match = coarse_to_fine(room, points, start, MatcherConfig())
        assert match.fit == fit(room.levels[-1], points, match.pose)
        assert match.fit.known < 1.0


def test_hessian_and_right_side_are_equations_12_to_14():
    """H is the sum over the beams of J^T J, and b that of J^T (1 - M), with J by finite differences."""
    level, points = smooth_level(), scan_points()
    J = jacobian(level, points, POSE)
    errors, _ = cost(level, points, POSE)
    hessian, right, _ = normal_equations(level, beams_of(points), POSE)
    np.testing.assert_allclose(hessian, J.T @ J, rtol=2e-3, atol=1e-3 * np.abs(J.T @ J).max())
    np.testing.assert_allclose(right, J.T @ errors, rtol=2e-3, atol=1e-3 * np.abs(J.T @ errors).max())


def test_right_side_is_the_downhill_gradient_of_the_cost():
    """B of (12) is minus half the gradient of (7): a small step along it lowers the cost."""
    level, points = smooth_level(3), scan_points()
    _, right, here = normal_equations(level, beams_of(points), POSE)
    there = np.sum(cost(level, points, POSE + 1e-5 * right / np.linalg.norm(right))[0] ** 2)
    assert there < np.sum(cost(level, points, POSE)[0] ** 2)
    assert here == pytest.approx(np.sum(cost(level, points, POSE)[0] ** 2), rel=1e-5)


def test_step_solves_the_normal_equations():
    """The closed-form 3x3 solution equals numpy's."""
    level, points = smooth_level(1), scan_points()
    H, b, _ = normal_equations(level, beams_of(points), POSE)
    *step, solved = gauss_newton.solve3(H[0, 0], H[0, 1], H[0, 2], H[1, 1], H[1, 2], H[2, 2], *b)
    assert solved
    np.testing.assert_allclose(step, np.linalg.solve(H, b), rtol=1e-8)


def test_singular_equations_are_left_alone():
    """Without any gradient (an unknown map) there is no step, and the start estimate comes back."""
    pyramid = Pyramid(MapConfig(size=128))
    start = np.array([0.1, -0.2, 0.3])
    result = coarse_to_fine(pyramid, scan_points(), start, MatcherConfig())
    np.testing.assert_allclose(result.pose, start)
    assert not result.converged
    assert np.linalg.eigvalsh(result.covariance).min() > 1.0


@pytest.mark.parametrize("offset", [(0.0, 0.0, 0.0), (0.15, -0.1, 0.08), (-0.25, 0.2, -0.12)])
def test_match_finds_the_pose(room, offset):
    """From a start off by decimetres the match comes within a fifth of a cell and 0.2 degrees."""
    truth = np.array([0.3, -0.2, 0.7])
    result = coarse_to_fine(room, room_points(truth), truth + offset, MatcherConfig(iterations_fine=15))
    assert np.hypot(*(result.pose - truth)[:2]) < 0.01
    assert abs(result.pose[2] - truth[2]) < math.radians(0.2)
    assert result.converged
    assert result.mean_residual < 0.35


def test_match_minimises_the_cost(room):
    """No pose of a fine grid around the match has a clearly lower cost."""
    truth = np.array([0.3, -0.2, 0.7])
    points = room_points(truth)
    pose = coarse_to_fine(room, points, truth, MatcherConfig(iterations_fine=30)).pose
    best = normal_equations(room.levels[0], beams_of(points), pose)[2]
    for dx in np.linspace(-0.02, 0.02, 9):
        for dy in np.linspace(-0.02, 0.02, 9):
            for dpsi in np.linspace(-0.01, 0.01, 5):
                there = normal_equations(room.levels[0], beams_of(points), pose + np.array([dx, dy, dpsi]))[2]
                assert there > 0.985 * best


def test_pyramid_reaches_further_than_one_level(room):
    """A start that one fine level cannot recover from is recovered coarse to fine (section IV-C)."""
    truth = np.array([0.3, -0.2, 0.7])
    start, points = truth + np.array([0.3, 0.25, 0.2]), room_points(truth)
    fine = Pyramid(ROOM)
    fine.levels = room.levels[:1]
    config = MatcherConfig(iterations_fine=12, iterations_coarse=12)
    assert np.hypot(*(coarse_to_fine(room, points, start, config).pose - truth)[:2]) < 0.02
    assert np.hypot(*(coarse_to_fine(fine, points, start, config).pose - truth)[:2]) > 0.05


def test_another_number_of_levels_compiles_nothing():
    """Who moves that slider does not wait: one level and the most that there may be have the same kernel."""
    (most,) = [leaf.param.high for leaf in leaves(SlamConfig()) if leaf.name == "map.levels"]
    truth, compiled = np.array([0.3, -0.2, 0.7]), list[int]()
    for levels in (3, 1, int(most)):
        result = coarse_to_fine(mapped(levels), room_points(truth), truth + 0.02, MatcherConfig())
        np.testing.assert_allclose(result.pose, truth, atol=0.02)
        assert len(result.iterations) == levels
        compiled.append(len(match_coarse_to_fine.signatures))
    assert len(set(compiled)) == 1


def test_trace_holds_every_iterate(room):
    """On request each Gauss-Newton step of each level is kept, coarse first, ending at the match by cells."""
    truth, cells_alone = np.array([0.3, -0.2, 0.7]), MatcherConfig(surfel_weight=0.0)
    result = coarse_to_fine(room, room_points(truth), truth + 0.05, cells_alone, trace=True)
    assert len(result.trace) == sum(result.iterations)
    assert list(dict.fromkeys(result.trace[:, 0])) == [2.0, 1.0, 0.0]
    np.testing.assert_allclose(result.trace[-1, 1:], result.pose)


def test_converged_step_ends_early(room):
    """With an early exit fewer steps are taken and the pose moves by less than the threshold's order."""
    truth = np.array([0.3, -0.2, 0.7])
    points = room_points(truth)
    plain = coarse_to_fine(room, points, truth + 0.02, MatcherConfig(converged_step=0.0, iterations_fine=20))
    early = coarse_to_fine(room, points, truth + 0.02, MatcherConfig(converged_step=0.0005, iterations_fine=20))
    assert sum(early.iterations) < sum(plain.iterations)
    assert np.abs(early.pose - plain.pose).max() < 0.002


def corridor_end(wall_at):
    """Endpoints on a wall ahead and two at the sides, from the origin."""
    y, x = np.linspace(-1.5, 1.5, 400), np.linspace(-1.5, 2.0, 400)
    ahead = np.column_stack([np.full_like(y, wall_at), y])
    sides = [np.column_stack([x, np.full_like(x, side)]) for side in (1.52, -1.52)]
    return np.concatenate([ahead, *sides]).astype(np.float32)


@pytest.mark.parametrize(
    ("sigma", "prior_restart_sigmas", "far"), [(0.005, 0.0, True), (0.005, 3.0, False), (1.0, 3.0, True)]
)
def test_a_sure_prediction_is_a_second_start(sigma, prior_restart_sigmas, far):
    """A wall drawn twice leads the coarser levels away; a match near a sure prediction that costs less wins."""
    pyramid, nothing, origin = Pyramid(ROOM), np.empty((0, 2), np.float32), np.zeros(3)
    for wall_at in (2.12, 2.12, 2.12, 1.92):
        pyramid.update(corridor_end(wall_at), nothing, origin[:2], origin, ROOM)
    prior = PlanarGaussian(origin, np.diag([sigma, sigma, 0.002]) ** 2)
    config = MatcherConfig(prior_restart_sigmas=prior_restart_sigmas, surfel_weight=0.0)
    match = coarse_to_fine(pyramid, corridor_end(1.92), origin, config, prior=prior, trace=True)
    assert (match.pose[0] > 0.05) == far
    np.testing.assert_allclose(match.trace[-1, 1:], match.pose)


def test_equation_15():
    """R is sigma^2 times the inverse of H, in metres and radians."""
    H = np.array([[4e4, 100.0, 300.0], [100.0, 2e4, -50.0], [300.0, -50.0, 9e3]])
    np.testing.assert_allclose(hessian_covariance(H, 0.2), 0.04 * np.linalg.inv(H), rtol=1e-4)


def test_covariance_of_a_direction_without_information_is_bounded():
    """A Hessian with a null direction (a bare corridor) gives metres of sigma there, not infinity."""
    covariance = hessian_covariance(np.diag([0.0, 2e4, 9e3]), 0.2)
    assert math.sqrt(covariance[0, 0]) == pytest.approx(10.0)
    assert math.sqrt(covariance[1, 1]) < 0.01


def test_sampled_covariance_of_a_quadratic_cost_is_equation_15():
    """Where residuals are linear in the pose both covariances agree."""
    level = smooth_level()
    u, v = np.meshgrid(np.arange(64), np.arange(64))
    level.cells[:] = in_parts(1.0 - 0.008 * np.abs(u - 31.5) - 0.012 * np.abs(v - 31.5))
    # Points in the four quadrants of that tent, mirrored: moving one way improves as many as it worsens.
    corner = np.random.default_rng(2).uniform(0.3, 0.6, (100, 2))
    points = np.vstack([corner * signs for signs in [(1, 1), (1, -1), (-1, 1), (-1, -1)]]).astype(np.float32)
    pose = np.array([1.6, 1.6, 0.0])
    by_hessian = hessian_covariance(normal_equations(level, beams_of(points), pose)[0], 0.1)
    sampled = sampled_covariance(level, points, pose, 0.1)
    np.testing.assert_allclose(np.diag(sampled)[:2], np.diag(by_hessian)[:2], rtol=0.02)


def test_sampled_covariance_equals_the_integral_of_the_likelihood(room):
    """Along each axis it is the variance of exp(-dE / 2 sigma^2), as a dense integration finds it."""
    truth = np.array([0.3, -0.2, 0.7])
    points, sigma = room_points(truth, noise=0.01), 0.6
    pose = coarse_to_fine(room, points, truth, MatcherConfig(iterations_fine=30)).pose
    level = room.levels[0]
    H, _, best = normal_equations(level, beams_of(points), pose)
    by_hessian = hessian_covariance(H, sigma)
    sampled = sampled_covariance(level, points, pose, sigma)
    variances, axes = np.linalg.eigh(by_hessian)
    for j in range(3):
        offsets = np.linspace(-5, 5, 401) * math.sqrt(variances[j])
        extra = (
            np.array([normal_equations(level, beams_of(points), pose + o * axes[:, j])[2] for o in offsets]) - best
        )
        weights = np.exp(-np.maximum(extra, 0) / (2 * sigma**2))
        dense = np.sum(weights * offsets**2) / np.sum(weights)
        assert axes[:, j] @ sampled @ axes[:, j] == pytest.approx(dense, rel=0.3)


def test_sampled_covariance_is_a_choice(room):
    """The configuration picks the method; both are symmetric and positive."""
    truth = np.array([0.3, -0.2, 0.7])
    for method in ("hessian", "sampled"):
        result = coarse_to_fine(room, room_points(truth), truth, MatcherConfig(covariance=method))
        np.testing.assert_allclose(result.covariance, result.covariance.T)
        assert np.linalg.eigvalsh(result.covariance).min() > 0


def test_points_off_the_map_pull_nowhere():
    """Endpoints outside the map read 0.5 and add nothing to H and b."""
    level = smooth_level()
    inside = scan_points(100)
    outside = np.vstack([inside, inside + np.float32(500.0)])
    a, b = normal_equations(level, beams_of(inside), POSE), normal_equations(level, beams_of(outside), POSE)
    np.testing.assert_allclose(a[0], b[0], rtol=1e-5)
    np.testing.assert_allclose(a[1], b[1], rtol=1e-4, atol=1e-3)
    assert b[2] - a[2] == pytest.approx(25.0, rel=1e-4)


def test_the_prior_holds_what_the_scan_leaves_open():
    """On an unknown map the match is the prior; on a known one a loose prior changes nothing."""
    pyramid = Pyramid(MapConfig(size=128))
    prior = PlanarGaussian(np.array([0.4, -0.3, 0.2]), np.diag([0.01, 0.01, 0.01]))
    held = coarse_to_fine(pyramid, scan_points(), np.zeros(3), MatcherConfig(), prior=prior)
    np.testing.assert_allclose(held.pose, prior.mean, atol=1e-6)


def test_a_loose_prior_changes_nothing(room):
    """A prior of metres next to a scan of millimetres leaves the match alone, also across the wrap of psi."""
    truth = np.array([0.3, -0.2, 3.1])
    points, loose = room_points(truth), np.diag([4.0, 4.0, 4.0])
    alone = coarse_to_fine(room, points, truth, MatcherConfig(iterations_fine=20))
    prior = PlanarGaussian(truth + np.array([0.0, 0.0, 0.1 - 2 * math.pi]), loose)
    joined = coarse_to_fine(room, points, truth, MatcherConfig(iterations_fine=20), prior=prior)
    np.testing.assert_allclose(joined.pose, alone.pose, atol=1e-4)


def test_a_corridor_keeps_to_the_prediction():
    """Between two bare walls the match follows the prior along them and says that it does not know."""
    rng = np.random.default_rng(3)
    pyramid, config = Pyramid(ROOM), MatcherConfig()

    def walls(x):
        along = np.linspace(-4, 4, 300)
        sides = np.concatenate([np.full(300, 1.02), np.full(300, -1.02)]) + 0.01 * rng.standard_normal(600)
        return np.column_stack([np.concatenate([along, along]), sides]).astype(np.float32)

    pyramid.update(walls(0), np.empty((0, 2), np.float32), np.zeros(2), np.zeros(3), ROOM)
    prior = PlanarGaussian(np.array([0.1, 0.0, 0.0]), np.diag([1e-4, 1e-4, 1e-4]))
    result = coarse_to_fine(pyramid, walls(0.1), prior.mean, config, prior=prior)
    assert result.pose[0] == pytest.approx(0.1, abs=0.005)
    assert abs(result.pose[1]) < 0.02
    assert math.sqrt(result.covariance[0, 0]) > 10 * math.sqrt(result.covariance[1, 1])
    np.testing.assert_allclose(np.abs(result.unobservable), [1.0, 0.0], atol=1e-3)
    for method in ("hessian", "sampled"):
        alone = coarse_to_fine(pyramid, walls(0.1), prior.mean, MatcherConfig(covariance=method))
        assert alone.pose[0] == pytest.approx(0.1, abs=1e-4)
        assert alone.weakest_sigma > 9.0
    plain = MatcherConfig(degeneracy_threshold=0.0)
    assert not coarse_to_fine(pyramid, walls(0.1), prior.mean, plain, prior=prior).leaves_direction


@pytest.mark.parametrize("sides", [(0, 2, 0, 2), (6, 0, 20, 0), (2, 62, 2, 2)])
def test_matching_does_not_depend_on_how_far_the_window_reaches(room, sides):
    """With more unknown tiles on any side, pose, Hessian and residuals are the same to the last bit."""
    larger, (row0, row1, column0, column1) = room.copy(), room.window
    larger.move((row0 - sides[0], row1 + sides[1], column0 - sides[2], column1 + sides[3]))
    points = room_points(np.array([0.3, -0.2, 0.7]), noise=0.01)
    start = np.array([0.35, -0.25, 0.75])
    a, b = (coarse_to_fine(pyramid, points, start, MatcherConfig()) for pyramid in (room, larger))
    assert (a.pose == b.pose).all()
    assert (a.hessian == b.hessian).all()
    assert (a.residuals == b.residuals).all()
