"""Fewer points for a plot, without losing a peak."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Column = NDArray[np.float64]
Indices = NDArray[np.intp]


def decimate(x: Column, columns: Sequence[Column], limit: int, first: int = 0) -> tuple[Column, list[Column]]:
    """At most `limit` points: of every run of samples its smallest and largest value, in their order.

    x: (n,) ascending. columns: (n,) each; NaN is passed over, and stays where a whole run is NaN.
    first: the number of x[0] in the whole series; runs begin at fixed numbers, else a moving curve shimmers.
    """
    if len(x) <= limit:
        return x, list(columns)
    starts, ends = _runs(len(x), limit // 2, first)
    at = np.stack([starts, (starts + ends) // 2], axis=1).ravel()
    at[-1] = len(x) - 1
    return x[at], [_extremes(column, starts, ends) for column in columns]


def _runs(n: int, most: int, first: int) -> tuple[Indices, Indices]:
    """Where each run begins and ends; at most `most` runs of a power of two samples, the outer two shorter."""
    size = 1
    while -(-n // size) + 1 > most:
        size *= 2
    starts = np.maximum(np.arange(-(first % size), n, size), 0)
    return starts, np.append(starts[1:], n)


def _extremes(column: Column, starts: Indices, ends: Indices) -> Column:
    """(2 runs,) low and high of each run, low first where the run rises."""
    low, high = np.fmin.reduceat(column, starts), np.fmax.reduceat(column, starts)
    rising = column[ends - 1] >= column[starts]
    return np.stack([np.where(rising, low, high), np.where(rising, high, low)], axis=1).ravel()
