"""Inertial samples in order of time, in arrays that compiled code runs through."""

import numpy as np

from slam_core.kernels.imu_propagation import COLUMNS
from slam_core.measurements import Float64s, Int64s

FIRST_SIZE = 256


class ImuBuffer:
    """The rows [begin, end) of two arrays; what is dropped in front makes room for what comes.

    last_ns: stamp of the latest.
    """

    def __init__(self) -> None:
        self._stamps = np.empty(FIRST_SIZE, np.int64)
        self._values = np.empty((FIRST_SIZE, COLUMNS))
        self._begin = self._end = 0
        self.last_ns = 0

    @property
    def rows(self) -> tuple[Int64s, Float64s, int, int]:
        """Stamps (n,) in ns, values (n, 8) as `kernels.imu_propagation` takes them, and the range."""
        return self._stamps, self._values, self._begin, self._end

    @property
    def last(self) -> Float64s:
        """The latest (8,)."""
        latest: Float64s = self._values[self._end - 1].copy()
        return latest

    def append(self, stamp_ns: int, value: Float64s) -> None:
        """One later than all before: (8,)."""
        if self._end == len(self._stamps):
            self._make_room()
        self._stamps[self._end] = self.last_ns = stamp_ns
        self._values[self._end] = value
        self._end += 1

    def until(self, time_ns: int) -> int:
        """Stamp of the last that is not later than an instant, or of the first of all."""
        i = np.searchsorted(self._stamps[self._begin : self._end], time_ns, side="right")
        return int(self._stamps[self._begin + max(int(i) - 1, 0)])

    def drop_before(self, stamp_ns: int) -> None:
        """Forget those earlier than a stamp, but for the latest of all."""
        i = np.searchsorted(self._stamps[self._begin : self._end], stamp_ns)
        self._begin = min(self._begin + int(i), self._end - 1)

    def _make_room(self) -> None:
        kept = slice(self._begin, self._end)
        size = max(FIRST_SIZE, 2 * (self._end - self._begin))
        stamps, values = np.empty(size, np.int64), np.empty((size, COLUMNS))
        self._end -= self._begin
        stamps[: self._end], values[: self._end] = self._stamps[kept], self._values[kept]
        self._stamps, self._values, self._begin = stamps, values, 0
