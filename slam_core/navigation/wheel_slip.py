"""Whether wheels roll: readings that no base can follow, or scans, show that they slip, spin, or are stuck."""

import math

from slam_core.measurements import Float64s, Odometry

HARDEST = 10.0  # m/s^2: no base on wheels brakes or gathers speed so fast
LEAST = 0.3  # m/s: what is less may be noise of two readings
NEAR = 0.2  # m/s: readings that agree with the motion again
IN_A_ROW = 3  # scans that contradict the wheels: one or two may be led astray
SHORTEST_NS = 300_000_000  # in which scans correct the speed that such readings have left
LONGEST_NS = 3_000_000_000  # a base that was stopped by an obstacle is believed after that


class WheelSlip:
    """One for each run."""

    def __init__(self) -> None:
        self._last: Odometry | None = None
        self._contradicted = 0  # by so many scans in a row
        self._since_ns: int | None = None
        self._until_ns = 0  # at the earliest

    def rolls(self, odometry: Odometry, velocity: Float64s) -> bool:
        """Whether a reading can be the motion of the base; take the next one.

        velocity: (2,) forward and left by the estimate before it, m/s. Readings that are in doubt count again once
        they agree with the estimate, which matches correct meanwhile, or after LONGEST_NS.
        """
        last, self._last = self._last, odometry
        if last is not None and _leaps(last, odometry):
            self._since_ns = odometry.stamp_ns
        if self._since_ns is not None:
            off = math.hypot(*(odometry.velocity - velocity))
            agrees = off < NEAR and odometry.stamp_ns >= self._until_ns
            if agrees or not 0 <= odometry.stamp_ns - self._since_ns <= LONGEST_NS:
                self._since_ns = None
        return self._since_ns is None

    def judge(self, time_ns: int, *, slips: bool) -> None:
        """Whether a scan of this time shows that they slip."""
        self._contradicted = self._contradicted + 1 if slips else 0
        if self._contradicted >= IN_A_ROW:
            self._since_ns, self._until_ns = time_ns, time_ns + SHORTEST_NS

    def copy(self) -> "WheelSlip":
        """An independent copy."""
        other = WheelSlip()
        other._last, other._contradicted = self._last, self._contradicted
        other._since_ns, other._until_ns = self._since_ns, self._until_ns
        return other


def _leaps(last: Odometry, odometry: Odometry) -> bool:
    lapse_s = 1e-9 * (odometry.stamp_ns - last.stamp_ns)
    jump = math.hypot(*(odometry.velocity - last.velocity))
    return lapse_s > 0.0 and jump > max(LEAST, HARDEST * lapse_s)
