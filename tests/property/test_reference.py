"""The equations of the reference hold against their definitions."""

import subprocess
import sys

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from slam_core.config import NavigationConfig
from slam_core.geometry import from_rotation_vector, heading
from slam_core.reference import covariance_intersection as ci
from slam_core.reference.navigation_filter import State, initial_state, planar, predict
from slam_core.reference.occupancy_grid import OccupancyGrid, bresenham
from slam_core.reference.scan_matching import evaluate, hessian_covariance, match, sampled_covariance

seeds = st.integers(0, 10**6)
UNBOUNDED = NavigationConfig(
    tilt_threshold=1.0,
    height_threshold=100.0,
    zero_velocity_threshold=20.0,
    gyro_bias_sigma=0.2,
    accel_bias_sigma=2.0,
)


def smooth(seed: int) -> OccupancyGrid:
    """A grid of random log-odds, 0.1 m a cell."""
    rng = np.random.default_rng(seed)
    return OccupancyGrid(0.1, np.array([-20, -20]), rng.normal(0.0, 2.0, (40, 40)))


@given(seeds)
def test_the_gradient_is_the_derivative_of_m(seed: int):
    """Eqs. (5)-(6) against central differences of (4), within cells."""
    grid, rng, step = smooth(seed), np.random.default_rng(seed), 1e-6
    cells = rng.integers(-15, 15, (30, 2))
    points = (cells + 0.5 + rng.uniform(0.01, 0.99, (30, 2))) * 0.1
    _, gradient = grid.interpolate(points)
    for axis in (0, 1):
        shift = step * np.eye(2)[axis]
        difference = (grid.interpolate(points + shift)[0] - grid.interpolate(points - shift)[0]) / (2 * step)
        np.testing.assert_allclose(gradient[:, axis], difference, atol=1e-6)


@given(seeds)
def test_the_right_side_is_the_derivative_of_the_cost(seed: int):
    """B of (12) is minus half the gradient of (7) with respect to x, y and psi."""
    grid, rng, step = smooth(seed), np.random.default_rng(seed), 1e-7
    points, pose = rng.uniform(-1.0, 1.0, (50, 2)), rng.uniform(-0.3, 0.3, 3)
    found = evaluate(grid, points, pose)
    for k in range(3):
        shift = step * np.eye(3)[k]
        slope = (evaluate(grid, points, pose + shift).cost - evaluate(grid, points, pose - shift).cost) / (
            2 * step
        )
        np.testing.assert_allclose(found.b[k], -0.5 * slope, atol=2e-2 * max(1.0, np.abs(found.b).max()))


@given(seeds)
def test_h_is_symmetric_and_positive(seed: int):
    """H of (13) is a sum of outer products; (15) is its inverse."""
    rng = np.random.default_rng(seed)
    found = evaluate(smooth(seed), rng.uniform(-1.0, 1.0, (50, 2)), np.zeros(3))
    np.testing.assert_allclose(found.H, found.H.T)
    assert np.linalg.eigvalsh(found.H)[0] > 0.0
    np.testing.assert_allclose(hessian_covariance(found.H, 0.2) @ found.H, 0.04 * np.eye(3), atol=1e-9)


@given(seeds, st.floats(0.01, 0.99), st.integers(3, 15))
def test_both_forms_of_the_intersection_agree(seed: int, omega: float, n: int):
    """(18)-(20) give the state and covariance of (16)-(17)."""
    rng = np.random.default_rng(seed)
    A, B, C = rng.normal(size=(n, n)), rng.normal(size=(3, 3)), rng.normal(size=(3, n))
    P, R, x, xi = A @ A.T + np.eye(n), B @ B.T + np.eye(3), rng.normal(size=n), rng.normal(size=3)
    for one, other in zip(
        ci.intersect(x, P, C, xi, R, omega), ci.intersect_information(x, P, C, xi, R, omega), strict=True
    ):
        np.testing.assert_allclose(one, other, rtol=1e-6, atol=1e-6)


@given(st.integers(-30, 30), st.integers(-30, 30))
def test_a_line_is_connected_and_ends_before_its_end(du: int, dv: int):
    """From the start, steps of at most one cell along each axis, and one step from the end."""
    start, end = np.array([3, -2]), np.array([3 + du, -2 + dv])
    cells = bresenham(start, end)
    whole = np.vstack([cells, end])
    assert len(cells) == max(abs(du), abs(dv))
    assert (whole[0] == start).all()
    assert (np.abs(np.diff(whole, axis=0)).max(axis=1, initial=0) <= 1).all()


@given(seeds)
def test_the_transition_is_the_derivative_of_the_motion(seed: int):
    """Phi carries errors of attitude, position, velocity and biases on as eqs. (1)-(3) do, to second order."""
    rng, dt, step = np.random.default_rng(seed), 0.01, 1e-5
    q = from_rotation_vector(rng.normal(0.0, 0.5, 3))
    state = State(
        q,
        *rng.normal(0.0, 1.0, (2, 3)),
        *rng.normal(0.0, 0.01, (2, 3)),
        np.array([0.0, 0.0, 9.8]),
        np.eye(15) * 1e-6,
    )
    u = np.concatenate([rng.normal(0.0, 1.0, 3), rng.normal(0.0, 3.0, 3)])
    moved = predict(state, u, dt, UNBOUNDED)
    for k in range(15):
        error = step * np.eye(15)[k]
        other = predict(state.corrected(error, state.P), u, dt, UNBOUNDED)
        shifted = np.concatenate([other.p - moved.p, other.v - moved.v, other.b_omega - moved.b_omega]) / step
        column = np.linalg.multi_dot([np.eye(15)[3:12], _phi(state, u, dt), np.eye(15)[:, k]])
        np.testing.assert_allclose(shifted, column, atol=2e-3)


def _phi(state: State, u: np.ndarray, dt: float) -> np.ndarray:
    """The transition of a step, from P of two predictions that differ in one error each."""
    from slam_core import geometry  # noqa: PLC0415
    from slam_core.reference.navigation_filter import transition  # noqa: PLC0415

    turned = geometry.multiply(state.q, from_rotation_vector((u[:3] - state.b_omega) * dt))
    after = geometry.rotation_matrix(turned)
    middle = 0.5 * (geometry.rotation_matrix(state.q) + after)
    return transition(middle, after, u[3:] - state.b_a, dt)


def room(seed: int) -> tuple[OccupancyGrid, np.ndarray]:
    """A square room seen once from its middle, and the endpoints of that scan."""
    angles = np.linspace(-np.pi, np.pi, 721)[:-1]
    ranges = 1.53 / np.maximum(np.abs(np.cos(angles)), np.abs(np.sin(angles)))
    points = ranges[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
    grid = OccupancyGrid(0.05, np.array([-64, -64]), np.zeros((128, 128)))
    grid.update(
        np.zeros(2), points + np.random.default_rng(seed).normal(0.0, 0.002, points.shape), (-0.4, 2.2), 50.0
    )
    return grid, points


@given(st.floats(-0.03, 0.03), st.floats(-0.03, 0.03), st.floats(-0.02, 0.02))
def test_the_matcher_returns_from_a_wrong_start(x: float, y: float, psi: float):
    """From half a cell off, the iterations end within half a cell of the pose that the map was written at."""
    grid, points = room(1)
    *_, last = match([grid], points, np.array([x, y, psi]), (0, 12))
    assert np.hypot(*last.pose[:2]) < 0.025
    assert abs(last.pose[2]) < 0.02


def test_a_quadratic_cost_samples_to_its_hessian_covariance():
    """Around a match with sub-cell noise the sampled covariance is of the size of (15)."""
    grid, points = room(2)
    *_, last = match([grid], points, np.zeros(3), (0, 8))
    sampled, exact = sampled_covariance(grid, points, last.pose, 0.02), hessian_covariance(last.H, 0.02)
    ratios = np.diag(sampled) / np.diag(exact)
    assert (ratios > 0.2).all() and (ratios < 5.0).all()


def test_initial_alignment_levels_and_measures_the_gyro_bias():
    """Samples of a tilted base at rest give its roll and pitch, and its rates as biases."""
    config, tilt = NavigationConfig(), from_rotation_vector(np.array([0.2, -0.1, 0.0]))
    from slam_core.geometry import conjugate, rotate, rotation_matrix  # noqa: PLC0415

    force = rotate(conjugate(tilt), np.array([0.0, 0.0, 9.80665]))
    state = initial_state(np.tile(np.concatenate([[0.01, 0.0, -0.01], force]), (50, 1)), config)
    np.testing.assert_allclose(rotation_matrix(state.q)[2], rotation_matrix(tilt)[2], atol=1e-6)
    np.testing.assert_allclose(state.b_omega, [0.01, 0.0, -0.01])
    assert planar(state)[0][2] == heading(state.q)


def test_the_reference_does_not_load_numba():
    """It is plain numpy, also by way of what it imports."""
    code = "import slam_core.reference, sys; assert not {'numba', 'llvmlite', 'scipy'} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60)
