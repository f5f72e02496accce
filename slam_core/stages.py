"""A belief and those that follow from it at the samples after it, in arrays that compiled code runs through."""

from bisect import bisect_right

import numpy as np

from slam_core.kernels.navigation import ERRORS, STATES
from slam_core.measurements import Float64s, Int64s
from slam_core.samples import Samples
from slam_core.strapdown import Strapdown

FIRST_SIZE = 8


class Stages:
    """What it hands out are views of its rows: they hold until it begins anew."""

    def __init__(self, stamp_ns: int, x: Float64s, P: Float64s) -> None:
        self._known = np.empty(FIRST_SIZE, np.int64)
        self._xs, self._Ps = np.empty((FIRST_SIZE, STATES)), np.empty((FIRST_SIZE, ERRORS, ERRORS))
        self.begin(stamp_ns, x, P)

    def begin(self, stamp_ns: int, x: Float64s, P: Float64s) -> None:
        """Begin anew with another belief: a copy of it, in the memory of the rows before."""
        self._stamps = [stamp_ns]
        self._known[0], self._xs[0], self._Ps[0] = stamp_ns, x, P

    def reach(self, time_ns: int, model: Strapdown, samples: Samples) -> None:
        """Go on up to the last sample that is not later than an instant."""
        while self._stamps[-1] < time_ns:
            n = len(self._stamps)
            rows = slice(n - 1, None)
            added = model.predict_each(self._xs[rows], self._Ps[rows], self._known[rows], time_ns, samples) - 1
            self._stamps += self._known[n : n + added].tolist()
            if len(self._stamps) < len(self._known):
                break
            self._make_room()

    def until(self, time_ns: int) -> tuple[Float64s, Int64s]:
        """States (k, 19) and stamps (k,) up to an instant, the first of all in any case."""
        k = max(bisect_right(self._stamps, time_ns), 1)
        return self._xs[:k], self._known[:k]

    def last(self, time_ns: int) -> tuple[int, Float64s, Float64s]:
        """Stamp, x and P of the last row up to an instant, or of the first."""
        k = max(bisect_right(self._stamps, time_ns), 1) - 1
        return self._stamps[k], self._xs[k], self._Ps[k]

    def since(self, stamp_ns: int, x: Float64s, P: Float64s) -> "Stages":
        """Those later than a stamp, after a belief that takes the place of those before."""
        other = Stages(stamp_ns, x, P)
        k = bisect_right(self._stamps, stamp_ns)
        other._stamps += self._stamps[k:]
        other._known = np.append(other._known[:1], self._known[k:])
        other._xs, other._Ps = np.append(x[None], self._xs[k:], 0), np.append(P[None], self._Ps[k:], 0)
        return other

    def copy(self) -> "Stages":
        """An independent copy."""
        other = Stages.__new__(Stages)
        other._stamps, other._known = self._stamps.copy(), self._known.copy()
        other._xs, other._Ps = self._xs.copy(), self._Ps.copy()
        return other

    def _make_room(self) -> None:
        n = len(self._stamps)
        known, xs, Ps = self._known, self._xs, self._Ps
        self._known = np.empty(2 * n, np.int64)
        self._xs, self._Ps = np.empty((2 * n, STATES)), np.empty((2 * n, ERRORS, ERRORS))
        self._known[:n], self._xs[:n], self._Ps[:n] = known, xs, Ps
