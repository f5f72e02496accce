"""Directions of the surfaces that a scan saw, from the neighbours of each endpoint, in one pass."""

import math

import numpy as np
from numba import njit

# A spread across the surface this share of the one along it, or more, makes it no line at all.
ROUND = 1.0 / 9.0
# Neighbours on either side of an endpoint, and how far apart they may lie: a wall seen at a glance, not a room.
WINDOW = 8
GAP = 0.3


@njit(cache=True, error_model="numpy")
def tangents(xs, ys, along_x, along_y):
    """Unit vectors along the surface, times the root of how straight it is; zero for a lone or round one.

    The neighbours are up to WINDOW beams on either side, each within GAP metres of the one before.
    """
    n = len(xs)
    sums = np.zeros((n + 1, 5))
    first = np.zeros(n, np.int64)
    last = np.full(n, n - 1, np.int64)
    for i in range(n):
        x, y = float(xs[i]), float(ys[i])
        sums[i + 1, 0] = sums[i, 0] + x
        sums[i + 1, 1] = sums[i, 1] + y
        sums[i + 1, 2] = sums[i, 2] + x * x
        sums[i + 1, 3] = sums[i, 3] + x * y
        sums[i + 1, 4] = sums[i, 4] + y * y
        if i > 0:
            dx, dy = xs[i] - xs[i - 1], ys[i] - ys[i - 1]
            first[i] = first[i - 1] if dx * dx + dy * dy <= GAP * GAP else i
    for i in range(n - 2, -1, -1):
        last[i] = last[i + 1] if first[i + 1] == first[i] else i
    for i in range(n):
        a, b = max(first[i], i - WINDOW), min(last[i], i + WINDOW) + 1
        along_x[i] = along_y[i] = 0.0
        if b - a >= 4:
            along_x[i], along_y[i] = _direction(sums[b] - sums[a], b - a)


@njit(cache=True, error_model="numpy")
def _direction(s, n):
    """The long axis of the scatter with these sums, shortened by its roundness."""
    mx, my = s[0] / n, s[1] / n
    xx, xy, yy = s[2] / n - mx * mx, s[3] / n - mx * my, s[4] / n - my * my
    difference = math.sqrt((xx - yy) ** 2 + 4.0 * xy * xy)
    long, short = 0.5 * (xx + yy + difference), 0.5 * (xx + yy - difference)
    straight = 1.0 - max(short, 0.0) / (ROUND * long) if long > 1e-9 else 0.0
    if straight <= 0.0:
        return 0.0, 0.0
    double = (xx - yy) / difference  # cosine of twice the direction
    length = math.sqrt(straight)
    return length * math.sqrt(0.5 * (1.0 + double)), math.copysign(length * math.sqrt(0.5 * (1.0 - double)), xy)
