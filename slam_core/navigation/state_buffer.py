"""An estimate and its propagation to the samples after it, in arrays that compiled code runs through."""

import numpy as np

from slam_core.kernels.imu_propagation import Rows, propagate
from slam_core.kernels.navigation import ERRORS, STATES
from slam_core.measurements import Float64s, Int64s
from slam_core.navigation.imu_buffer import ImuBuffer
from slam_core.navigation.strapdown import Strapdown

FIRST_SIZE = 8
NO_INSTANT = np.empty(0, np.int64)


class StateBuffer:
    """Its rows are computed when a time beyond them is requested."""

    def __init__(self, stamp_ns: int, x: Float64s, P: Float64s) -> None:
        self._rows = _rows(FIRST_SIZE)
        self.begin(stamp_ns, x, P)

    @property
    def stamps(self) -> Int64s:
        """Of the rows that are known, (n,)."""
        return self._rows[2][: self._count]

    def begin(self, stamp_ns: int, x: Float64s, P: Float64s) -> None:
        """Begin anew with another estimate: a copy of it, in the memory of the rows before."""
        xs, Ps, stamps = self._rows
        xs[0], Ps[0], stamps[0] = x, P, stamp_ns
        self._count = 1

    def estimate(
        self, time_ns: int, model: Strapdown, samples: ImuBuffer, from_ns: int = 0, since_ns: Int64s = NO_INSTANT
    ) -> tuple[Float64s, Float64s, Float64s]:
        """The x and P at an instant, those of the first row for one before it; (k, 19) x at from_ns + since_ns."""
        x, P, states = np.empty(STATES), np.empty((ERRORS, ERRORS)), np.empty((len(since_ns), STATES))
        times, output = (from_ns, since_ns, time_ns), (states, x, P)
        while True:
            self._count = propagate(self._rows, self._count, *times, samples.rows, model.constants, output)
            if self._count < len(self._rows[2]):
                return x, P, states
            self._make_room()  # it may have lacked some

    def since(self, stamp_ns: int, x: Float64s, P: Float64s) -> "StateBuffer":
        """States newer than `stamp_ns`, re-based on a new state."""
        other = self.copy()
        first = int(np.searchsorted(self.stamps, stamp_ns, side="right"))
        other.begin(stamp_ns, x, P)
        for rows, later in zip(other._rows, self._rows, strict=True):
            rows[1 : 1 + self._count - first] = later[first : self._count]
        other._count += self._count - first
        return other

    def copy(self) -> "StateBuffer":
        """An independent copy."""
        other = StateBuffer.__new__(StateBuffer)
        (xs, Ps, stamps), other._count = self._rows, self._count
        other._rows = xs.copy(), Ps.copy(), stamps.copy()
        return other

    def _make_room(self) -> None:
        grown = _rows(2 * len(self._rows[2]))
        for rows, known in zip(grown, self._rows, strict=True):
            rows[: self._count] = known[: self._count]
        self._rows = grown


def _rows(n: int) -> Rows:
    return np.empty((n, STATES)), np.empty((n, ERRORS, ERRORS)), np.empty(n, np.int64)
