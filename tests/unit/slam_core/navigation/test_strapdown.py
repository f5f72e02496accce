import numpy as np
import pytest

from slam_core import geometry
from slam_core.config import NavigationConfig, PlatformConfig
from slam_core.kernels.navigation import ERRORS, STATES, advance, bound, inject, level, move, transition, workspace
from slam_core.navigation.imu_buffer import ImuBuffer
from slam_core.navigation.state_buffer import StateBuffer
from slam_core.navigation.strapdown import Strapdown
from tests.motions import GRAVITY, cross_matrix

G = 9.80665
NO_BOUNDS = np.full((ERRORS, 2), np.inf)


def start(seed: int = 0) -> np.ndarray:
    """A state in general position."""
    rng = np.random.default_rng(seed)
    x = rng.normal(size=STATES)
    x[:4] /= np.linalg.norm(x[:4])
    x[10:16] *= 0.1
    return x


def inputs(t: float) -> np.ndarray:
    """A smooth input: rates of some rad/s, forces around gravity."""
    rate = [0.8 * np.sin(3 * t), 0.6 * np.cos(2 * t), 0.9 * np.sin(t + 1)]
    force = [2 * np.sin(5 * t), 1.5 * np.cos(3 * t), G + 2 * np.sin(4 * t)]
    return np.array(rate + force)


def runge_kutta(derivative, y: np.ndarray, seconds: float, steps: int) -> np.ndarray:
    """Classic fourth order integration of dy/dt = derivative(t, y)."""
    h = seconds / steps
    for k in range(steps):
        t = k * h
        a = derivative(t, y)
        b = derivative(t + h / 2, y + h / 2 * a)
        c = derivative(t + h / 2, y + h / 2 * b)
        d = derivative(t + h, y + h * c)
        y = y + h / 6 * (a + 2 * b + 2 * c + d)
    return y


def moved(x: np.ndarray, seconds: float, rate: float) -> np.ndarray:
    """The kernel driven by the mean input of each interval."""
    dt = 1.0 / rate
    for k in range(round(seconds * rate)):
        x = move(x, 0.5 * (inputs(k * dt) + inputs((k + 1) * dt)), dt, G, 0.5)
    return x


def test_attitude_follows_equation_1() -> None:
    """Turning by quaternions agrees with the integral of E_Omega omega, while pitch stays away from 90 degrees."""
    x = np.zeros(STATES)
    x[:4] = geometry.from_euler(0.1, -0.2, 0.5)
    euler = runge_kutta(
        lambda t, y: geometry.euler_rates(y[0], y[1]) @ inputs(t)[:3], np.array([0.1, -0.2, 0.5]), 2.0, 4000
    )
    difference = geometry.multiply(geometry.conjugate(geometry.from_euler(*euler)), moved(x, 2.0, 1000.0)[:4])
    assert np.linalg.norm(geometry.to_rotation_vector(difference)) < 2e-6


def reference(x: np.ndarray, seconds: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Eqs. (2)-(3) with dR/dt = R [omega] x, by Runge-Kutta on the matrix: R, v, p."""

    def derivative(t: float, y: np.ndarray) -> np.ndarray:
        R, v = y[:9].reshape(3, 3), y[9:12]
        u = inputs(t) - x[10:16]
        return np.concatenate([(R @ cross_matrix(u[:3])).ravel(), R @ u[3:] + GRAVITY, v])

    y = np.concatenate([geometry.rotation_matrix(x[:4]).ravel(), x[7:10], x[4:7]])
    y = runge_kutta(derivative, y, seconds, 4000)
    return y[:9].reshape(3, 3), y[9:12], y[12:]


@pytest.mark.parametrize("seed", range(3))
def test_velocity_and_position_follow_equations_2_and_3(seed: int) -> None:
    """Two seconds of turning and shaking agree with an independent integration, biases taken off."""
    x = start(seed)
    R, v, p = reference(x, 2.0)
    found = moved(x, 2.0, 1000.0)
    assert np.allclose(geometry.rotation_matrix(found[:4]), R, atol=5e-6)
    assert np.allclose(found[7:10], v, atol=2e-4) and np.allclose(found[4:7], p, atol=2e-4)


def test_the_error_falls_with_the_square_of_the_interval() -> None:
    """Twice the rate leaves a quarter of the error: the integration is of second order."""
    x = start()
    _, v, p = reference(x, 2.0)
    coarse, fine = (np.linalg.norm(moved(x, 2.0, rate)[4:10] - np.concatenate([p, v])) for rate in (100.0, 200.0))
    assert 3.5 < coarse / fine < 4.5


@pytest.mark.parametrize("seed", range(5))
def test_transition_is_the_derivative_of_the_motion(seed: int) -> None:
    """Phi agrees with central differences of the nonlinear step in all fifteen errors, at any attitude."""
    x, u, dt = start(seed), inputs(0.3 + seed), 0.01
    ahead = move(x, u, dt, G, 0.5)

    def error(y: np.ndarray) -> np.ndarray:
        turn = geometry.multiply(y[:4], geometry.conjugate(ahead[:4]))
        return np.concatenate([geometry.to_rotation_vector(turn), y[4:16] - ahead[4:16]])

    h = 1e-5
    columns = [
        (error(move(inject(x, h * e), u, dt, G, 0.5)) - error(move(inject(x, -h * e), u, dt, G, 0.5))) / (2 * h)
        for e in np.eye(ERRORS)
    ]
    Phi = np.eye(ERRORS)
    transition(x, ahead, u, dt, Phi)
    assert np.allclose(Phi, np.array(columns).T, atol=2e-6)


@pytest.mark.parametrize("seed", range(5))
def test_the_covariance_is_carried_on_by_the_whole_transition(seed: int) -> None:
    """Phi P Phi^T where there is no noise and no bound: no element that is not empty is left out."""
    root = np.random.default_rng(seed).normal(size=(ERRORS, ERRORS))
    x, u, dt, P = start(seed), inputs(0.3 + seed), 0.01, root @ root.T
    ahead, later = x.copy(), P.copy()
    advance(ahead, later, u, dt, np.array([G, 0.5, *np.zeros(6)]), NO_BOUNDS, workspace())
    Phi = np.eye(ERRORS)
    transition(x, ahead, u, dt, Phi)
    np.testing.assert_allclose(later, Phi @ P @ Phi.T, rtol=0, atol=1e-12 * np.abs(P).max())


def fed(u: np.ndarray, seconds: float) -> ImuBuffer:
    """The same input a hundred times a second."""
    samples = ImuBuffer()
    for k in range(round(100 * seconds) + 1):
        samples.append(k * 10_000_000, np.append(u, [0.0, 0.0]))
    return samples


def test_covariance_grows_as_white_noise_does() -> None:
    """At rest for ten seconds from certainty: angle, velocity and position grow by their closed forms."""
    config = NavigationConfig(gyro_bias_walk=1e-7, accel_bias_walk=1e-6)
    model = Strapdown(config, PlatformConfig())
    model.constants = *model.constants[:2], NO_BOUNDS
    x, P = np.zeros(STATES), np.zeros((ERRORS, ERRORS))
    x[0] = 1.0
    x, P = model.predict(x, P, 0, 10_000_000_000, fed(np.array([0.0, 0.0, 0.0, 0.0, 0.0, G]), 10.0))
    T = 10.0
    gyro, accel = config.gyro_noise**2, config.accel_noise**2
    assert np.isclose(P[2, 2], gyro * T, rtol=1e-3)
    assert np.isclose(P[6, 6], accel * T + G**2 * gyro * T**3 / 3, rtol=1e-2)
    assert np.isclose(P[8, 8], accel * T, rtol=1e-3)
    assert np.isclose(P[5, 5], accel * T**3 / 3, rtol=1e-2)
    assert np.isclose(P[3, 3], accel * T**3 / 3 + G**2 * gyro * T**5 / 20, rtol=2e-2)


def test_unknown_motion_goes_straight_and_forgets() -> None:
    """Without input the attitude stays, the velocity goes on, and every uncertainty grows more than with one."""
    model, x, P = Strapdown(NavigationConfig(), PlatformConfig()), start(), 1e-6 * np.eye(ERRORS)
    later, spread = model.predict(x, P, 0, 400_000_000, fed(inputs(0.0), 0.0))
    assert np.allclose(later[:4], x[:4]) and np.allclose(later[7:10], x[7:10])
    assert np.allclose(later[4:7], x[4:7] + 0.4 * x[7:10])
    alone = StateBuffer(0, x, P).estimate(0, model, fed(inputs(0.0), 0.0), 0, np.array([400_000_000]))[2]
    assert np.allclose(later, alone[0], atol=1e-12)
    known = model.predict(x, P, 0, 400_000_000, fed(inputs(0.0), 0.4))[1]
    assert (np.diag(spread)[:9] > np.diag(known)[:9]).all()


def test_unknown_motion_over_a_year_costs_no_more_than_over_ten_seconds() -> None:
    """A broken clock cannot make the filter step for ever or overflow."""
    model, x = Strapdown(NavigationConfig(), PlatformConfig()), start()
    later, spread = model.predict(x, 1e-6 * np.eye(ERRORS), 0, 30_000_000 * 10**9, fed(inputs(0.0), 0.0))
    assert np.isfinite(later).all() and np.isfinite(spread).all()


@pytest.mark.parametrize("i", range(5, ERRORS))
def test_an_error_past_its_bound_is_pulled_to_zero(i: int) -> None:
    """A height, velocity or bias less certain than its bound moves towards zero and becomes more certain."""
    x, P, bounds = start(), 0.01 * np.eye(ERRORS), NO_BOUNDS.copy()
    bounds[i] = 1.0, 1.0
    P[i, i] = 4.0
    pulled, reduced = bound(x, P, G, bounds)
    assert np.isclose(pulled[1 + i], 0.2 * x[1 + i]) and np.isclose(reduced[i, i], 0.8)
    P[i, i] = 0.99
    assert (bound(x, P, G, bounds)[0] == x).all()


def test_tilt_past_its_bound_is_read_from_gravity() -> None:
    """A base that feels gravity aslant takes on that tilt, and only while it feels gravity alone."""
    true = geometry.from_euler(0.05, -0.03, 0.0)
    x, P, bounds = np.zeros(STATES), 1e-6 * np.eye(ERRORS), NO_BOUNDS.copy()
    x[0], x[16:19] = 1.0, geometry.rotate(geometry.conjugate(true), np.array([0.0, 0.0, G]))
    P[:2, :2] = 0.1 * np.eye(2)
    bounds[:2] = 0.01, 0.01
    leveled, reduced = bound(x, P, G, bounds)
    assert np.allclose(geometry.to_euler(leveled[:4])[:2], [0.05, -0.03], atol=2e-3)
    assert reduced[0, 0] < 1e-3
    x[16:19] *= 1.3
    assert (bound(x, P, G, bounds)[0] == x).all()


def test_leveling_ties_tilt_to_the_accelerometer_bias() -> None:
    """After gravity was seen, a tilt and the bias that would explain it are the same uncertainty."""
    x = np.zeros(STATES)
    x[0], x[18] = 1.0, G
    P = np.diag([1.0] * 3 + [1e-6] * 9 + [0.01] * 3)
    _, P = level(x, P, G, 1e-6)
    assert np.isclose(np.sqrt(P[0, 0]), 0.1 / G, rtol=1e-2)
    assert abs(P[0, 13]) / np.sqrt(P[0, 0] * P[13, 13]) > 0.99


def test_smoothed_force_follows_the_body_not_the_map() -> None:
    """While the base turns at rest, the smoothed force turns with it and keeps pointing up."""
    x, dt = np.zeros(STATES), 0.01
    x[0], x[18] = 1.0, G
    for _ in range(150):
        up = geometry.rotate(geometry.conjugate(x[:4]), np.array([0.0, 0.0, G]))
        x = move(x, np.array([1.0, 0.0, 0.0, *up]), dt, G, 0.5)
    assert np.allclose(geometry.rotate(x[:4], x[16:19]), [0.0, 0.0, G], atol=0.15)


def test_smoothed_force_takes_in_nothing_while_the_base_is_shaken() -> None:
    """The push that is felt then does not move what shows where down is."""
    x = np.zeros(STATES)
    x[0], x[18] = 1.0, G
    moved = move(x, np.array([0.0, 0.0, 0.0, 40.0, 0.0, G]), 0.01, G, np.inf)
    assert (moved[16:19] == x[16:19]).all() and moved[7] > 0.3
