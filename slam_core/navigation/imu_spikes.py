"""Spikes in inertial data: one sample far from the one before and from the one after, as of a disturbed link."""

from collections import Counter

import numpy as np

from slam_core.kernels.imu_propagation import MAX_GAP_NS
from slam_core.kernels.imu_spikes import FOLLOWED, WAITS, WAS_SPIKE, spike
from slam_core.measurements import Imu

SPIKE = "inertial sample far from those on both sides"
NEAR_NS = MAX_GAP_NS // 2  # the samples on both sides of a spike are no gap


class SpikeFilter:
    """Leaves them out: a sample that leaps waits for the next one, which tells whether the base moved like this.

    counts: takes how many there were.
    """

    def __init__(self, counts: Counter[str]) -> None:
        self._counts = counts
        self._memory = np.zeros((5, 6))
        self._passed_ns = 0
        self._waiting: list[Imu] = []  # none or one

    def admit(self, imu: Imu) -> list[Imu]:
        """The samples that may be used now that this one has come, in their order."""
        since_ns = imu.stamp_ns - self._passed_ns
        dt = 1e-9 * since_ns if 0 < since_ns <= NEAR_NS else 0.0
        verdict = spike(imu.angular_velocity, imu.linear_acceleration, dt, self._memory)
        passed = self._waiting if verdict & FOLLOWED else []
        if verdict & WAS_SPIKE:
            self._counts[SPIKE] += 1
        if verdict & WAITS:
            self._waiting = [imu]
        else:
            self._waiting, passed = [], [*passed, imu]
        if passed:
            self._passed_ns = passed[-1].stamp_ns
        return passed
