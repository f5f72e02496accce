"""A belief and those that follow from it at the samples after it, in arrays that compiled code runs through."""

from collections.abc import Callable
from typing import Any

import numpy as np

from slam_core.kernels import passage
from slam_core.kernels.navigation import ERRORS, STATES
from slam_core.measurements import Float64s, Int64s
from slam_core.samples import Samples
from slam_core.strapdown import Strapdown

FIRST_SIZE = 8

Rows = tuple[Float64s, Float64s, Int64s]
"""Beliefs: x (n, 19), P (n, 15, 15), and stamps (n,)."""


class Stages:
    """Its rows are worked out when somebody asks for an instant beyond them."""

    def __init__(self, stamp_ns: int, x: Float64s, P: Float64s) -> None:
        self._rows = _rows(FIRST_SIZE)
        self.begin(stamp_ns, x, P)

    @property
    def stamps(self) -> Int64s:
        """Of the rows that are known, (n,)."""
        return self._rows[2][: self._count]

    def begin(self, stamp_ns: int, x: Float64s, P: Float64s) -> None:
        """Begin anew with another belief: a copy of it, in the memory of the rows before."""
        xs, Ps, stamps = self._rows
        xs[0], Ps[0], stamps[0] = x, P, stamp_ns
        self._count = 1

    def belief(self, time_ns: int, model: Strapdown, samples: Samples) -> tuple[Float64s, Float64s]:
        """The x and P at an instant; those of the first row for one before it."""
        x, P = np.empty(STATES), np.empty((ERRORS, ERRORS))
        self._work(passage.believe, time_ns, *samples.rows, *model.constants, x, P)
        return x, P

    def states(self, times_ns: Int64s, model: Strapdown, samples: Samples) -> Float64s:
        """The x alone at several instants, (k, 19)."""
        states = np.empty((len(times_ns), STATES))
        self._work(passage.predict_states, times_ns, *samples.rows, *model.constants, states)
        return states

    def since(self, stamp_ns: int, x: Float64s, P: Float64s) -> "Stages":
        """Those later than a stamp, after a belief that takes the place of those before."""
        other = self.copy()
        first = int(np.searchsorted(self.stamps, stamp_ns, side="right"))
        other.begin(stamp_ns, x, P)
        for rows, later in zip(other._rows, self._rows, strict=True):
            rows[1 : 1 + self._count - first] = later[first : self._count]
        other._count += self._count - first
        return other

    def copy(self) -> "Stages":
        """An independent copy."""
        other = Stages.__new__(Stages)
        (xs, Ps, stamps), other._count = self._rows, self._count
        other._rows = xs.copy(), Ps.copy(), stamps.copy()
        return other

    def _work(self, kernel: Callable[..., int], *given: Any) -> None:
        """Call a kernel of `passage`; anew as long as it used up all rows, as then it may have lacked some."""
        self._count = kernel(*self._rows, self._count, *given)
        while self._count == len(self._rows[2]):
            self._make_room()
            self._count = kernel(*self._rows, self._count, *given)

    def _make_room(self) -> None:
        grown = _rows(2 * len(self._rows[2]))
        for rows, known in zip(grown, self._rows, strict=True):
            rows[: self._count] = known[: self._count]
        self._rows = grown


def _rows(n: int) -> Rows:
    return np.empty((n, STATES)), np.empty((n, ERRORS, ERRORS)), np.empty(n, np.int64)
