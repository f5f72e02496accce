"""What is wrong with an inertial sample before the filter sees it.

It is no number, the gyro is clipped, the base is shaken hard, the driver sends the last one again, the clock was
set back.
"""

import numpy as np

from slam_core.config import NavigationConfig
from slam_core.kernels.imu_check import BROKEN, CLIPPED, FROZEN, SHAKEN, check
from slam_core.kernels.imu_propagation import COLUMNS, MAX_GAP_NS
from slam_core.measurements import Float64s, Imu

AT_RANGE = "gyro at the end of its range"
NO_NUMBER = "inertial sample without a plausible value"
SENT_AGAIN = "inertial sample that repeats the ones before"
AFTER_LEAP = "inertial sample of a base that is shaken"
FAULTS = {BROKEN: NO_NUMBER, CLIPPED: AT_RANGE, FROZEN: SENT_AGAIN, SHAKEN: AFTER_LEAP}
UNUSABLE = BROKEN, FROZEN
BACK_FOR_NS = 200_000_000  # of samples in order, all of them in the past


class ImuCheck:
    """Looks at one sample after the other; remembers just enough of those before."""

    def __init__(self) -> None:
        self._memory = np.zeros((6, 4))
        self._sample = np.zeros(COLUMNS)
        self._last_ns = 0
        self._behind: tuple[int, int] | None = None

    def check(self, imu: Imu, config: NavigationConfig, hit: float) -> tuple[Float64s | None, str]:
        """The sample as in `ImuBuffer` (None if it tells nothing), and what is wrong with it (empty if nothing).

        It holds until the next one is checked. hit: rad/s by which the base may have turned besides, just before.
        """
        dt = min(max(imu.stamp_ns - self._last_ns, 0), MAX_GAP_NS) * 1e-9
        rate, force = imu.angular_velocity, imu.linear_acceleration
        found = check(rate, force, dt, config.gyro_range, hit, self._memory, self._sample)
        if found != BROKEN:
            self._last_ns = imu.stamp_ns
        return self._sample if found not in UNUSABLE else None, FAULTS.get(found, "")

    def goes_on(self) -> None:
        """A sample was in order: none before it was of a clock that was set back."""
        self._behind = None

    def set_back(self, stamp_ns: int, newest_ns: int) -> bool:
        """Whether samples of the past have come in order for so long that the clock must have been set."""
        if newest_ns - stamp_ns < MAX_GAP_NS:
            self.goes_on()
            return False
        first_ns, last_ns = self._behind or (stamp_ns, stamp_ns)
        if not last_ns <= stamp_ns <= last_ns + MAX_GAP_NS:
            first_ns = stamp_ns
        self._behind = first_ns, stamp_ns
        return stamp_ns - first_ns >= BACK_FOR_NS
