"""Eqs. (1)-(3) with the noise of the configuration: the prediction of the filter."""

import numpy as np

from slam_core.config import NavigationConfig, PlatformConfig
from slam_core.kernels.imu_propagation import COLUMNS, MAX_GAP_NS, Recorded, propagate
from slam_core.kernels.navigation import ERRORS, STATES
from slam_core.measurements import Float64s
from slam_core.navigation.imu_buffer import ImuBuffer

# Without inertial data the motion goes on straight, with white noise that stands for every turn and push.
UNAIDED_GYRO_NOISE = 0.5  # rad/s/√Hz
UNAIDED_ACCEL_NOISE = 2.0  # m/s²/√Hz

# One sample, too long ago to say anything.
NOTHING_RECORDED: Recorded = np.array([-2 * MAX_GAP_NS]), np.zeros((1, COLUMNS)), 0, 1
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
        return self._propagated(x, P, from_ns, to_ns, samples.rows)

    def coast(self, x: Float64s, P: Float64s, seconds: float) -> Float64s:
        """P of an estimate after so long without any input."""
        return self._propagated(x, P, 0, round(seconds * 1e9), NOTHING_RECORDED)[1]

    def _propagated(
        self, x: Float64s, P: Float64s, from_ns: int, to_ns: int, recorded: Recorded
    ) -> tuple[Float64s, Float64s]:
        rows = x[None].copy(), P[None].copy(), np.array([from_ns])
        output = np.empty((0, STATES)), np.empty(STATES), np.empty((ERRORS, ERRORS))
        propagate(rows, 1, from_ns, np.empty(0, np.int64), to_ns, recorded, self.constants, output)
        return output[1:]


def _bounds(config: NavigationConfig) -> Float64s:
    """(15, 2) variance beyond which an error is pseudo-measured, and the noise variance of that."""
    bounds = np.full((ERRORS, 2), np.inf)
    bounds[0:2] = config.tilt_threshold, config.gravity_sigma
    bounds[5] = config.height_threshold
    bounds[6:9] = config.zero_velocity_threshold, config.zero_velocity_sigma
    bounds[9:12] = config.gyro_bias_sigma
    bounds[12:15] = config.accel_bias_sigma
    return bounds**2
