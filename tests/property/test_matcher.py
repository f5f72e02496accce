"""What must hold for every map, scan and pose."""

import numpy as np
from hypothesis import example, given, settings
from hypothesis import strategies as st

from slam_core.geometry import compose, inverse, transform_points
from slam_core.mapping.grid import GridLevel
from slam_core.matching.matcher import beams_of, hessian_covariance, normal_equations
from tests.worlds import smooth_level

seeds = st.integers(0, 10_000)
quarter_turns = st.integers(0, 3)


@settings(max_examples=60, deadline=None)
@given(seeds, st.floats(0.5, 2.7), st.floats(0.5, 2.7), st.floats(-7, 7), st.integers(1, 300))
def test_hessian_is_symmetric_and_positive_semidefinite(seed, x, y, psi, n):
    """H is a sum of squares: symmetric, no negative eigenvalue, for any scan anywhere on any map."""
    points = np.random.default_rng(seed).normal(0, 1.0, (n, 2)).astype(np.float32)
    hessian, _, cost = normal_equations(smooth_level(seed), beams_of(points), np.array([x, y, psi]))
    assert (hessian == hessian.T).all()
    assert np.linalg.eigvalsh(hessian).min() >= -1e-4 * max(1.0, np.abs(hessian).max())
    assert 0.0 <= cost <= n * 1.0001


@settings(max_examples=60, deadline=None)
@given(seeds, st.floats(0.01, 5.0))
@example(5969, 0.01171875)
def test_covariance_is_symmetric_and_positive(seed, sigma):
    """R of (15) is a covariance for every H, singular ones included."""
    J = np.random.default_rng(seed).normal(0, 30, (seed % 4, 3))
    covariance = hessian_covariance(J.T @ J, sigma)
    assert (covariance == covariance.T).all()
    assert np.linalg.eigvalsh(covariance).min() > 0


@settings(max_examples=40, deadline=None)
@given(seeds, quarter_turns, st.integers(-20, 20), st.integers(-20, 20))
def test_matching_turns_with_the_map(seed, turns, right, up):
    """Turn the map by quarters and shift it by cells: cost, H and b, and so every step, turn with it."""
    level = smooth_level(seed)
    points = np.random.default_rng(seed).uniform(-0.6, 0.6, (150, 2)).astype(np.float32)
    start = np.array([1.6, 1.6, 0.2])
    moved = GridLevel(level.resolution, level.shape, np.array([right, up]) * level.resolution)
    moved.cells[:] = np.rot90(level.cells, -turns)  # row 0 is the lowest y: this turns left
    side = level.shape[0] * level.resolution
    corner = np.array([(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)][turns])
    motion = np.array([*(corner + moved.origin), turns * np.pi / 2])
    turn = np.array(
        [[np.cos(motion[2]), -np.sin(motion[2]), 0], [np.sin(motion[2]), np.cos(motion[2]), 0], [0, 0, 1]]
    )
    a = normal_equations(level, beams_of(points), start)
    b = normal_equations(moved, beams_of(points), compose(motion, start))
    scale = np.abs(a[0]).max()
    assert np.isclose(a[2], b[2], rtol=1e-4)
    np.testing.assert_allclose(b[0], turn @ a[0] @ turn.T, atol=5e-3 * scale)
    np.testing.assert_allclose(b[1], turn @ a[1], atol=5e-3 * np.abs(a[1]).max() + 1e-2)


@settings(max_examples=40, deadline=None)
@given(seeds, st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), st.floats(-3, 3))
def test_matching_does_not_depend_on_the_frame_of_the_scan(seed, x, y, psi):
    """Express the same endpoints in another frame of the robot: the cost and its covariance at the map stay."""
    level = smooth_level(seed)
    points = np.random.default_rng(seed).uniform(-0.6, 0.6, (150, 2)).astype(np.float32)
    pose, mount = np.array([1.6, 1.6, 0.2]), np.array([x, y, psi])
    seen = transform_points(inverse(mount), points).astype(np.float32)
    a = normal_equations(level, beams_of(points), pose)
    b = normal_equations(level, beams_of(seen), compose(pose, mount))
    assert np.isclose(a[2], b[2], rtol=1e-4)
    np.testing.assert_allclose(a[0][:2, :2], b[0][:2, :2], rtol=2e-2, atol=2e-3 * np.abs(a[0]).max())
