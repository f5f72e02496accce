"""Measurements of the motion wait for the scan before them: it comes later, at the end of its sweep.

The planar model cannot go back. Without this it was ahead of a scan by half a sweep, and by half a second at the
start, where scans wait for inertial data that may come.
"""

from bisect import bisect_right, insort
from operator import attrgetter

from slam_core.measurements import Measurement
from slam_core.navigation.planar_motion import SET_BACK_NS

LONGEST_NS = 2_000_000_000  # that one waits for a scan
STAMP = attrgetter("stamp_ns")


class Waiting:
    """What came, in the order of its stamps."""

    def __init__(self) -> None:
        self._waiting: list[Measurement] = []

    def push(self, measurement: Measurement) -> list[Measurement]:
        """Another one; those that wait no longer."""
        set_back = bool(self._waiting) and measurement.stamp_ns < self._waiting[-1].stamp_ns - SET_BACK_NS
        released = self.flush() if set_back else []
        insort(self._waiting, measurement, key=STAMP)
        return released + self.until(self._waiting[-1].stamp_ns - LONGEST_NS)

    def until(self, time_ns: int) -> list[Measurement]:
        """Those up to a time."""
        count = bisect_right(self._waiting, time_ns, key=STAMP)
        released, self._waiting = self._waiting[:count], self._waiting[count:]
        return released

    def flush(self) -> list[Measurement]:
        """All of them."""
        released, self._waiting = self._waiting, []
        return released
