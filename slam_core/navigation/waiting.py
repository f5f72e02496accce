"""Measurements of the motion wait for the scan before them: it comes later, at the end of its sweep.

The planar model cannot go back. Without this it was ahead of a scan by half a sweep, and by half a second at the
start, where scans wait for inertial data that may come.
"""

from bisect import insort
from operator import attrgetter

from slam_core.measurements import Measurement

LONGEST_NS = 2_000_000_000  # that one waits for a scan
SET_BACK_NS = 1_000_000_000  # an older stamp is by a clock that was set


class Waiting:
    """What came, in the order of its stamps."""

    def __init__(self) -> None:
        self._waiting: list[Measurement] = []

    def push(self, measurement: Measurement) -> list[Measurement]:
        """Another one; those that wait no longer."""
        newest_ns = self._waiting[-1].stamp_ns if self._waiting else measurement.stamp_ns
        released = self.flush() if measurement.stamp_ns < newest_ns - SET_BACK_NS else []
        insort(self._waiting, measurement, key=_STAMP)
        return released or self.until(self._waiting[-1].stamp_ns - LONGEST_NS)

    def until(self, time_ns: int) -> list[Measurement]:
        """Those up to a time."""
        count = 0
        while count < len(self._waiting) and self._waiting[count].stamp_ns <= time_ns:
            count += 1
        released, self._waiting = self._waiting[:count], self._waiting[count:]
        return released

    def flush(self) -> list[Measurement]:
        """All of them."""
        released, self._waiting = self._waiting, []
        return released


_STAMP = attrgetter("stamp_ns")
