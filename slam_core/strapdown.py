"""Eqs. (1)-(3) with the noise of the configuration: what the filter believes a moment later."""

import math

import numpy as np

from slam_core import geometry
from slam_core.config import NavigationConfig
from slam_core.kernels import navigation as kernels
from slam_core.measurements import Float64s

# Without inertial data the motion goes on straight, with white noise that stands for every turn and push.
BLIND_GYRO_NOISE = 0.5  # rad/s/√Hz
BLIND_ACCEL_NOISE = 2.0  # m/s²/√Hz
BLIND_STEP = 0.05  # s
BLIND_SPAN = 10.0  # s, after which nothing more can be forgotten

SMOOTHING = 0.5  # s: over which the specific force is smoothed to show where down is


class Strapdown:
    """The system equation for one configuration. u is (6,) angular rate and specific force, or None if unknown."""

    def __init__(self, config: NavigationConfig) -> None:
        walks = [config.gyro_bias_walk**2, config.accel_bias_walk**2]
        common = [config.gravity, SMOOTHING]
        self.gravity = config.gravity
        self.patience_ns = round(config.gate_patience * 1e9)
        self.bounds = _bounds(config)
        self._model = np.array([*common, config.gyro_noise**2, config.accel_noise**2, *walks])
        self._blind = np.array([*common, BLIND_GYRO_NOISE**2, BLIND_ACCEL_NOISE**2, *walks])

    def advance(self, x: Float64s, P: Float64s, u: Float64s | None, dt: float) -> tuple[Float64s, Float64s]:
        """State and covariance `dt` seconds later."""
        if u is None:
            return self._advance_blind(x, P, dt)
        later: tuple[Float64s, Float64s] = kernels.advance(x, P, u, dt, self._model, self.bounds)
        return later

    def move(self, x: Float64s, u: Float64s | None, dt: float) -> Float64s:
        """The state alone, `dt` seconds later."""
        if u is None:
            return self._advance_blind(x, np.zeros((kernels.ERRORS, kernels.ERRORS)), dt)[0]
        later: Float64s = kernels.move(x, u, dt, self.gravity, SMOOTHING)
        return later

    def _advance_blind(self, x: Float64s, P: Float64s, dt: float) -> tuple[Float64s, Float64s]:
        dt = min(dt, BLIND_SPAN)
        steps = max(1, math.ceil(dt / BLIND_STEP))
        for _ in range(steps):
            x, P = kernels.advance(x, P, self._straight(x), dt / steps, self._blind, self.bounds)
        return x, P

    def _straight(self, x: Float64s) -> Float64s:
        """The input of a base that neither turns nor accelerates."""
        up = geometry.rotation_matrix(x[:4])[2]
        return np.concatenate([x[10:13], x[13:16] + self.gravity * up])


def _bounds(config: NavigationConfig) -> Float64s:
    """(15, 2) variance beyond which an error is pseudo-measured, and the noise variance of that."""
    bounds = np.full((kernels.ERRORS, 2), np.inf)
    bounds[0:2] = config.tilt_threshold, config.gravity_sigma
    bounds[5] = config.height_threshold
    bounds[6:9] = config.zero_velocity_threshold, config.zero_velocity_sigma
    bounds[9:12] = config.gyro_bias_sigma
    bounds[12:15] = config.accel_bias_sigma
    return bounds**2
