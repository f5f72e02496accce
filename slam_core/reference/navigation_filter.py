"""Section V-A: the navigation filter, an extended Kalman filter on attitude, position, velocity and biases.

The attitude is a quaternion, whose kinematics are those of eq. (1) without its singularity; its error is a small
rotation about the axes of the map. So the state has 16 numbers, and P is (15, 15).
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from slam_core import geometry
from slam_core.config import NavigationConfig
from slam_core.measurements import Float64s
from slam_core.reference.covariance_intersection import kalman_update

ATTITUDE, POSITION, VELOCITY, GYRO_BIAS, ACCEL_BIAS = (slice(i, i + 3) for i in range(0, 15, 3))  # of the errors
UNMEASURED = 1.0  # m/s, standard deviation of the vertical velocity where nothing measures the height
SMOOTHING = 0.5  # s, of the specific force that shows where down is
NEAR_GRAVITY = 0.1  # share of gravity by which its size may differ
# Standard deviations of samples below which the base stands still at the start: rad/s, m/s^2.
STILL = 0.03, 0.25


@dataclass(frozen=True)
class State:
    """x and P at one time.

    q: (4,) w, x, y, z. p: (3,) metres. v: (3,) m/s. b_omega, b_a: (3,) biases, rad/s and m/s^2. f: (3,) specific
    force in body axes, smoothed, m/s^2. P: (15, 15).
    """

    q: Float64s
    p: Float64s
    v: Float64s
    b_omega: Float64s
    b_a: Float64s
    f: Float64s
    P: Float64s

    def corrected(self, error: Float64s, P: Float64s) -> "State":
        """The state with an error (15,) added, and the covariance after that."""
        q = geometry.multiply(geometry.from_rotation_vector(error[ATTITUDE]), self.q)
        return State(
            q / np.linalg.norm(q), self.p + error[POSITION], self.v + error[VELOCITY],
            self.b_omega + error[GYRO_BIAS], self.b_a + error[ACCEL_BIAS], self.f, P,
        )  # fmt: skip


def predict(state: State, u: Float64s, dt: float, config: NavigationConfig) -> State:
    """Eqs. (1)-(3) over dt seconds of constant input u = (omega, a) (6,), and P with the noise of that."""
    omega, a = u[:3] - state.b_omega, u[3:] - state.b_a
    turn = geometry.from_rotation_vector(omega * dt)
    q = geometry.multiply(state.q, turn)  # (1)
    q = q / np.linalg.norm(q)
    before, after = geometry.rotation_matrix(state.q), geometry.rotation_matrix(q)
    R = 0.5 * (before + after)
    v = state.v + dt * (R @ a - np.array([0.0, 0.0, config.gravity]))  # (3)
    p = state.p + 0.5 * dt * (state.v + v)  # (2)
    f = geometry.rotate(geometry.conjugate(turn), state.f)
    f = f + -math.expm1(-dt / SMOOTHING) * (u[3:] - f)
    Phi = transition(R, after, a, dt)
    P = Phi @ state.P @ Phi.T + noise(dt, config)
    return bounded(State(q, p, v, state.b_omega, state.b_a, f, 0.5 * (P + P.T)), config)


def transition(R: Float64s, after: Float64s, a: Float64s, dt: float) -> Float64s:
    """The Jacobian (15, 15) of (1)-(3) with respect to the errors, exact to second order in dt."""
    Phi = np.eye(15)
    Phi[ATTITUDE, GYRO_BIAS] = -dt * R
    Phi[VELOCITY, ATTITUDE] = -dt * cross(R @ a)
    Phi[VELOCITY, GYRO_BIAS] = 0.5 * dt**2 * cross(after @ a) @ R
    Phi[VELOCITY, ACCEL_BIAS] = -dt * R
    Phi[POSITION] += 0.5 * dt * (Phi[VELOCITY] - np.eye(15)[VELOCITY])
    Phi[POSITION, VELOCITY] = dt * np.eye(3)
    return Phi


def noise(dt: float, config: NavigationConfig) -> Float64s:
    """Q (15, 15) of white noise on the input, and of random walks of the biases, over dt seconds."""
    Q, eye, acceleration = np.zeros((15, 15)), np.eye(3), config.accel_noise**2
    Q[ATTITUDE, ATTITUDE] = config.gyro_noise**2 * dt * eye
    Q[POSITION, POSITION] = acceleration * dt**3 / 3.0 * eye
    Q[POSITION, VELOCITY] = Q[VELOCITY, POSITION] = acceleration * dt**2 / 2.0 * eye
    Q[VELOCITY, VELOCITY] = acceleration * dt * eye
    Q[GYRO_BIAS, GYRO_BIAS] = config.gyro_bias_walk**2 * dt * eye
    Q[ACCEL_BIAS, ACCEL_BIAS] = config.accel_bias_walk**2 * dt * eye
    return Q


def bounded(state: State, config: NavigationConfig) -> State:
    """Pseudo measurements of what is less certain than its threshold: gravity, zero velocity, height and bias."""
    if max(state.P[0, 0], state.P[1, 1]) > config.tilt_threshold**2:
        state = levelled(state, config.gravity, config.gravity_sigma**2)
    if state.P[5, 5] > config.height_threshold**2:  # nothing measures the height
        P = state.P.copy()
        P[8, 8] = max(P[8, 8], UNMEASURED**2)
        state = replace(state, P=P)
    thresholds = np.repeat([np.inf, np.inf, config.zero_velocity_threshold, config.gyro_bias_sigma,
                            config.accel_bias_sigma], 3)  # fmt: skip
    sigmas = thresholds.copy()
    thresholds[5] = sigmas[5] = config.height_threshold
    sigmas[VELOCITY] = config.zero_velocity_sigma
    for i in range(5, 15):
        if state.P[i, i] > thresholds[i] ** 2:
            value = np.concatenate([np.zeros(3), state.p, state.v, state.b_omega, state.b_a])[i]
            C = np.eye(15)[i : i + 1]
            state = state.corrected(*kalman_update(state.P, C, np.array([[sigmas[i] ** 2]]), np.array([-value])))
    return state


def levelled(state: State, gravity: float, variance: float) -> State:
    """Roll and pitch corrected by the direction of the smoothed specific force, where that is mostly gravity."""
    R = geometry.rotation_matrix(state.q)
    force = R @ (state.f - state.b_a)
    if abs(float(np.linalg.norm(force)) - gravity) > NEAR_GRAVITY * gravity:
        return state
    C = np.zeros((2, 15))
    C[:, ATTITUDE], C[:, ACCEL_BIAS] = -cross(force)[:2], -R[:2]
    C[:, 2] = 0.0  # the heading turns nothing of what is vertical
    return state.corrected(*kalman_update(state.P, C, variance * np.eye(2), -force[:2]))


def initial_state(samples: Float64s, config: NavigationConfig) -> State:
    """Initial alignment: roll and pitch from the mean force of samples u (n, 6), at the origin with heading 0."""
    mean, spread = samples.mean(axis=0), samples.std(axis=0)
    omega, force = mean[:3], mean[3:]
    still = (spread[:3] < STILL[0]).all() and (spread[3:] < STILL[1]).all()
    still = bool(still and (np.abs(omega) < 3.0 * config.gyro_bias_sigma).all())
    up = force / np.linalg.norm(force)
    q = np.array([1.0 + up[2], up[1], -up[0], 0.0])
    bias_sigma = config.gyro_noise / math.sqrt(config.level_time) if still else config.gyro_bias_sigma
    sigma = np.repeat([1.0, 0.01, 0.05 if still else 1.0, bias_sigma, config.accel_bias_sigma], 3)
    sigma[2] = 0.001  # the heading at the start is 0 by definition
    b_omega = omega if still else np.zeros(3)
    state = State(q / np.linalg.norm(q), np.zeros(3), np.zeros(3), b_omega, np.zeros(3), force, np.diag(sigma**2))
    variance = 0.02**2 + float(np.max(spread[3:]) / 3.0) ** 2
    return levelled(state, float(np.linalg.norm(force)), variance)


def planar(state: State) -> tuple[Float64s, Float64s]:
    """Section V-B: C x (3,), position in the plane and heading, and the observer C (3, 15) of its errors."""
    C = np.zeros((3, 15))
    C[0, 3] = C[1, 4] = 1.0
    C[2, :3] = geometry.heading_gradient(state.q)
    return np.array([state.p[0], state.p[1], geometry.heading(state.q)]), C


def cross(a: Float64s) -> Float64s:
    """The matrix (3, 3) that takes b to the cross product of a and b."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])
