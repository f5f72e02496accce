"""Section IV: every beam of a sweep placed by the motion at its own time."""

import math

import numpy as np
from numba import njit

from slam_core.kernels.memory import lane

get, _ = lane(0)
_, put = lane(1)


@njit(cache=True, error_model="numpy")
def place_beams(
    ranges,
    cosines,
    sines,
    knots,
    knot_step,
    low,
    high,
    no_return,
    clear_range,
    z_low,
    z_high,
    points,
    zs,
    free,
):
    """Endpoints (n, 2) and heights (n,) in the stabilised frame, and free ends: returns how many of each.

    knots: (k, 3, 4) transforms laser -> stabilised frame every `knot_step` beams. A range in [low, high)
    is an endpoint; one of at least `no_return` clears up to `clear_range`, if that is not 0. z_low <= z <= z_high.
    """
    n = len(ranges)
    reaches, ends = np.empty(n), np.empty((3, n))
    for i in range(n):
        r = ranges[i]
        reaches[i] = r if (low <= r) & (r < high) else clear_range
    for j in range(3):
        _place(reaches, cosines, sines, knots[:, j], knot_step, ends[j])
    kept = cleared = 0
    for i in range(n):
        r, z = ranges[i], ends[2, i]
        if z < z_low or z > z_high:
            continue
        if low <= r < high:
            points[kept, 0], points[kept, 1], zs[kept] = ends[0, i], ends[1, i], z
            kept += 1
        elif clear_range > 0.0 and r >= no_return:
            free[cleared, 0], free[cleared, 1] = ends[0, i], ends[1, i]
            cleared += 1
    return kept, cleared


@njit(cache=True, error_model="numpy")
def _place(reaches, cosines, sines, knots, knot_step, out):
    """One coordinate of every end, (n,), by the rows (k, 4) of the knots' transforms; without a branch."""
    n, begin = len(reaches), 0
    for k in range(len(knots) - 1):
        end = n if k == len(knots) - 2 else min(n, math.ceil((k + 1) * knot_step))
        ax, ay, at = knots[k, 0], knots[k, 1], knots[k, 3]
        bx, by, bt = knots[k + 1, 0], knots[k + 1, 1], knots[k + 1, 3]
        for i in range(begin, end):
            reach = get(reaches, i)
            lx, ly = reach * get(cosines, i), reach * get(sines, i)
            p = ax * lx + ay * ly + at
            q = bx * lx + by * ly + bt
            put(out, i, p + (i / knot_step - k) * (q - p))
        begin = end
