"""Eqs. (1)-(3) with the noise of the configuration: the prediction of the filter."""

import numpy as np

from slam_core.config import NavigationConfig, PlatformConfig
from slam_core.kernels import imu_propagation
from slam_core.kernels.navigation import ERRORS
from slam_core.measurements import Float64s
from slam_core.navigation.imu_buffer import ImuBuffer

# Without inertial data the motion goes on straight, with white noise that stands for every turn and push.
UNAIDED_GYRO_NOISE = 0.5  # rad/s/√Hz
UNAIDED_ACCEL_NOISE = 2.0  # m/s²/√Hz

SMOOTHING = 0.5  # s: over which the specific force is smoothed to show where down is


class Strapdown:
    """The system equation for one configuration.

    constants: model, model without input, and bounds, as compiled code takes them.
    """

    def __init__(self, config: NavigationConfig, platform: PlatformConfig) -> None:
        walks = [config.gyro_bias_walk**2, config.accel_bias_walk**2]
        common = [config.gravity, SMOOTHING]
        limits = [float(platform.planar), float(platform.no_slip)]
        self.constants = (
            np.array([*common, config.gyro_noise**2, config.accel_noise**2, *walks, *limits]),
            np.array([*common, UNAIDED_GYRO_NOISE**2, UNAIDED_ACCEL_NOISE**2, *walks, *limits]),
            _bounds(config),
        )

    def predict(
        self, x: Float64s, P: Float64s, from_ns: int, to_ns: int, samples: ImuBuffer
    ) -> tuple[Float64s, Float64s]:
        """State and covariance at a later instant, through the samples between."""
        later: tuple[Float64s, Float64s] = imu_propagation.predict(
            x, P, from_ns, to_ns, samples.rows, self.constants
        )
        return later

    def coast(self, x: Float64s, P: Float64s, seconds: float) -> Float64s:
        """P of an estimate after so long without any input."""
        spread: Float64s = imu_propagation.coast(x, P, seconds, *self.constants[1:])[1]
        return spread


def _bounds(config: NavigationConfig) -> Float64s:
    """(15, 2) variance beyond which an error is pseudo-measured, and the noise variance of that."""
    bounds = np.full((ERRORS, 2), np.inf)
    bounds[0:2] = config.tilt_threshold, config.gravity_sigma
    bounds[5] = config.height_threshold
    bounds[6:9] = config.zero_velocity_threshold, config.zero_velocity_sigma
    bounds[9:12] = config.gyro_bias_sigma
    bounds[12:15] = config.accel_bias_sigma
    return bounds**2
