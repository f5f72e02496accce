"""Spikes in inertial data: samples far from the one before and from the one after, as of a disturbed link."""

from collections import Counter

import numpy as np

from slam_core.kernels.imu_propagation import MAX_GAP_NS
from slam_core.kernels.imu_spikes import WAITS, WERE_SPIKE, spike
from slam_core.measurements import Imu

SPIKE = "inertial sample far from those on both sides"
NEAR_NS = MAX_GAP_NS // 2  # the samples on both sides of a spike are no gap
FASTEST_HIT = 1.0  # rad/s that a base may have turned with in what passed for a spike


class SpikeFilter:
    """Leaves them out: samples that leap wait for the next ones, which tell whether the base moved like this.

    counts: takes how many there were. hit: rad/s by which the base may have turned before the sample that was
    admitted last, in a spike that was left out; 0 if there was none.
    """

    def __init__(self, counts: Counter[str]) -> None:
        self.hit = 0.0
        self._counts = counts
        self._memory = np.zeros((4, 6))
        self._passed_ns = 0
        self._waiting: list[Imu] = []

    def admit(self, imu: Imu) -> list[Imu]:
        """The samples that may be used now that this one has come, in their order."""
        since_ns = imu.stamp_ns - self._passed_ns
        dt = 1e-9 * since_ns if 0 < since_ns <= NEAR_NS else 0.0
        verdict = spike(imu.angular_velocity, imu.linear_acceleration, dt, len(self._waiting), self._memory)
        if verdict == WAITS:
            self._waiting.append(imu)
            return []
        self._passed_ns, self.hit = imu.stamp_ns, 0.0
        if not self._waiting:
            return [imu]
        waited, self._waiting = self._waiting, []
        if verdict != WERE_SPIKE:
            return [*waited, imu]
        self._counts[SPIKE] += len(waited)
        turned = max(np.abs(each.angular_velocity - imu.angular_velocity).max() for each in waited)
        self.hit = min(float(turned), FASTEST_HIT)
        return [imu]
