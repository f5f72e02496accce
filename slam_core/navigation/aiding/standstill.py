"""Whether the base stands still, by its inertial data alone: then what the gyros read is their bias.

A base at rest shows the noise of its sensors, which is white: the variance equals half the mean square of the
differences between neighbours (von Neumann). Slow motion, such as that of a boat on calm water, adds to the first
and not to the second.
"""

from typing import NamedTuple

import numpy as np

from slam_core.kernels.imu_check import moments
from slam_core.measurements import Float64s, Imu
from slam_core.navigation.initial_alignment import STILL_ACCEL, STILL_GYRO

WINDOW_NS = 2_000_000_000  # as long as a slow wave
LEAST = 20  # samples in a window
WHITE = 1.5  # of the ratio of the variances: that of 200 samples of noise deviates from 1 by 0.07
LIMITS = np.array([STILL_GYRO] * 3 + [STILL_ACCEL] * 3)


class Rest(NamedTuple):
    """The mean rate (3,) and force (3,) of a window without motion, and the variance of these means."""

    rate: Float64s
    force: Float64s
    rate_variance: float
    force_variance: float


class StandstillDetector:
    """Judges one window of inertial data after the other."""

    def __init__(self) -> None:
        self._begin_ns: int | None = None
        self._samples: list[Float64s] = []

    def add(self, imu: Imu) -> Rest | None:
        """Take in a sample; what was measured at rest, when a window ends in which nothing moved."""
        stamp_ns = imu.stamp_ns
        if self._begin_ns is None or not 0 <= stamp_ns - self._begin_ns <= 2 * WINDOW_NS:
            self._begin_ns, self._samples = stamp_ns, []
        self._samples += imu.angular_velocity, imu.linear_acceleration
        if stamp_ns - self._begin_ns < WINDOW_NS:
            return None
        rest = at_rest(np.concatenate(self._samples).reshape(-1, 6))
        self._begin_ns, self._samples = stamp_ns, []
        return rest


def at_rest(samples: Float64s) -> Rest | None:
    """The means of a window (n, 6) of rates and forces; None if the base moved in it."""
    n = len(samples)
    if n < LEAST:
        return None
    mean, variance, noise = moments(samples)
    if not ((variance <= LIMITS**2) & (variance <= WHITE * noise)).all():  # so, too, where it is no number
        return None
    return Rest(mean[:3], mean[3:], float(noise[:3].max()) / n, float(noise[3:].max()) / n)
