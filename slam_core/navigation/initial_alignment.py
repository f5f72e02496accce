"""Initial alignment: roll and pitch from the mean specific force of the first samples; reset to a planar pose."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from slam_core import geometry
from slam_core.config import NavigationConfig, PlatformConfig
from slam_core.kernels import navigation as kernels
from slam_core.kernels.fusion import planar_observer
from slam_core.measurements import Float64s
from slam_core.results import PlanarGaussian

# Below these standard deviations of single samples the base is taken to stand still.
STILL_GYRO = 0.03  # rad/s
STILL_ACCEL = 0.25  # m/s²
MOVING_ACCEL = 0.7  # m/s²: the mean acceleration of a base that moves
SPEED_SIGMA = 1.0  # m/s
HEIGHT_SIGMA = 0.01  # m: the height is 0 by definition
# Half a turn of tilt is as good as unknown before gravity is seen.
UNKNOWN_TILT = 1.0  # rad


def is_still(samples: Float64s, config: NavigationConfig) -> bool:
    """Whether inertial samples (n, 6) may be those of a base at rest."""
    mean, spread = samples.mean(axis=0), samples.std(axis=0)
    return bool(
        (spread[:3] < STILL_GYRO).all()
        and (spread[3:] < STILL_ACCEL).all()
        and (np.abs(mean[:3]) < 3.0 * config.gyro_bias_sigma).all()
    )


def initial_state(
    samples: Float64s, config: NavigationConfig, platform: PlatformConfig
) -> tuple[Float64s, Float64s] | None:
    """(x, P) at the last of the samples (n, 6), at the origin with heading 0; None if there is no gravity in them.

    A base that stands still shows its gyro biases; one that moves begins with biases and a velocity unknown.
    """
    mean, spread = samples.mean(axis=0), samples.std(axis=0)
    still = is_still(samples, config)
    variance = 0.02**2 + float(np.max(spread[3:]) / 3.0) ** 2
    if still:
        gyro_sigma = config.gyro_noise / math.sqrt(config.level_time)
        return _levelled(mean, (0.05, gyro_sigma, variance), config, platform)
    return _levelled([0.0, 0.0, 0.0, *mean[3:]], (SPEED_SIGMA, config.gyro_bias_sigma, variance), config, platform)


def moving_state(
    samples: Float64s, stamps: Sequence[int], config: NavigationConfig, platform: PlatformConfig
) -> tuple[Float64s, Float64s] | None:
    """The same of a base that is known to move: turns do not count, and the force holds an acceleration."""
    mean = [0.0, 0.0, 0.0, *_turned_along(samples, stamps).mean(axis=0)]
    return _levelled(mean, (SPEED_SIGMA, config.gyro_bias_sigma, MOVING_ACCEL**2), config, platform)


def _levelled(
    mean: ArrayLike, uncertainty: tuple[float, float, float], config: NavigationConfig, platform: PlatformConfig
) -> tuple[Float64s, Float64s] | None:
    """The estimate by the mean bias of the gyros and the mean force, (6,).

    uncertainty: standard deviations of velocity and gyro bias, and the variance of the force.
    """
    mean = np.asarray(mean, np.float64)
    speed_sigma, gyro_sigma, variance = uncertainty
    force, size = mean[3:], float(np.linalg.norm(mean[3:]))
    if size < 0.1 * config.gravity:
        return None
    x = np.zeros(kernels.STATES)
    x[:4] = upright(force)
    x[10:13] = mean[:3]
    x[16:19] = force
    sigma = np.repeat([UNKNOWN_TILT, HEIGHT_SIGMA, speed_sigma, gyro_sigma, config.accel_bias_sigma], 3)
    sigma[2] = 0.001  # the first heading is 0 by definition
    # Gravity through the filter's own measurement, so that tilt and accelerometer bias start correlated.
    x, P = kernels.level(x, np.diag(sigma**2), size, variance)
    if platform.planar:
        kernels.flatten.py_func(x, P)  # once a run: compiling it for this caller takes 0.2 s at each start
    return x, P


def _turned_along(samples: Float64s, stamps: Sequence[int]) -> Float64s:
    """The specific forces (n, 3) of samples (n, 6) in the axes of the body at the last of them, by the gyros."""
    turned, turn = samples[:, 3:].copy(), np.array([1.0, 0.0, 0.0, 0.0])
    for k in range(len(samples) - 2, -1, -1):
        step = 0.5 * (samples[k, :3] + samples[k + 1, :3]) * (stamps[k + 1] - stamps[k]) / 1e9
        turn = geometry.multiply(geometry.from_rotation_vector(step), turn)
        turned[k] = geometry.rotate(geometry.conjugate(turn), samples[k : k + 1, 3:])[0]
    return turned


def with_pose(x: Float64s, P: Float64s, pose: PlanarGaussian) -> tuple[Float64s, Float64s]:
    """An estimate turned about the vertical and moved to a planar pose, with the covariance of the pose.

    The former position and heading are dropped; tilt, height, biases and the motion of the body stay.
    """
    turn = geometry.yaw_quaternion(pose.mean[2] - geometry.heading(x[:4]))
    R = geometry.rotation_matrix(turn)
    x, T = x.copy(), np.eye(kernels.ERRORS)
    x[:4] = geometry.multiply(turn, x[:4])
    x[4:6], x[7:10] = pose.mean[:2], R @ x[7:10]
    for i in (0, 3, 6):
        T[i : i + 3, i : i + 3] = R
    moved = np.eye(kernels.ERRORS)[:, [3, 4, 2]]  # changes x, y, heading and nothing else
    T -= moved @ (planar_observer(x) @ T)
    P = T @ P @ T.T + moved @ pose.covariance @ moved.T
    return x, 0.5 * (P + P.T)


def upright(force: Float64s) -> Float64s:
    """The attitude (4,) of heading 0 in which the specific force (3,) points up."""
    f = force / np.linalg.norm(force)
    if f[2] < -1.0 + 1e-9:
        return np.array([0.0, 1.0, 0.0, 0.0])
    q = np.array([1.0 + f[2], f[1], -f[0], 0.0])
    normed: Float64s = q / np.linalg.norm(q)
    return normed
