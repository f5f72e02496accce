"""Section IV: every beam of a sweep placed by the motion at its own time."""

import math

import numpy as np
from numba import njit

from slam_core.kernels.memory import lane
from slam_core.kernels.rotations import cosines, product

get, _ = lane(0)
_, put = lane(1)


@njit(cache=True, error_model="numpy")
def place_beams(
    ranges,
    cosines,
    sines,
    poses,
    mount,
    level,
    low,
    high,
    no_return,
    clear_range,
    z_min,
    z_max,
    points,
    heights,
    free,
    laser,
):
    """Endpoints (n, 2) and heights (n,) in the stabilised frame, and free ends: returns how many of each.

    poses: (k + 1, 7) or wider, attitude and position of the base in equal steps of time over the sweep, and last
    the one of the stabilised frame. mount: (4, 4) laser -> base. level: whether roll and pitch count. A range in
    [low, high) is an endpoint; one of at least `no_return` clears up to `clear_range`, unless that is 0. Heights
    are over the middle of the laser's way, whose place `laser` (2,) takes, from z_min to z_max.
    """
    n = len(ranges)
    way = _knots(poses, mount, level)
    knot_step = max(n - 1, 1) / (len(way) - 1)
    reaches, ends = np.empty(n), np.empty((3, n))
    laser[0], laser[1] = 0.5 * (way[0, 0, 3] + way[-1, 0, 3]), 0.5 * (way[0, 1, 3] + way[-1, 1, 3])
    z_laser = 0.5 * (way[0, 2, 3] + way[-1, 2, 3])
    z_low, z_high, over = z_laser + z_min, z_laser + z_max, np.float32(z_laser)
    kept = cleared = end = 0
    for knot in range(len(way) - 1):  # piece by piece, which stays in the nearest cache
        begin, end = end, n if knot == len(way) - 2 else min(n, math.ceil((knot + 1) * knot_step))
        for i in range(end - begin):
            r = ranges[begin + i]
            reaches[i] = r if (low <= r) & (r < high) else clear_range
        for j in range(3):
            _place(reaches, cosines, sines, begin, end, way[:, j], knot, knot_step, ends[j])
        for i in range(end - begin):
            r, z = ranges[begin + i], ends[2, i]
            if z < z_low or z > z_high:
                continue
            if low <= r < high:
                points[kept, 0], points[kept, 1], heights[kept] = ends[0, i], ends[1, i], np.float32(z) - over
                kept += 1
            elif clear_range > 0.0 and r >= no_return:
                free[cleared, 0], free[cleared, 1] = ends[0, i], ends[1, i]
                cleared += 1
    return kept, cleared


@njit(cache=True, error_model="numpy")
def _knots(poses, mount, level):
    """(k, 3, 4) transforms laser -> stabilised frame at all poses but the last, which is that frame's."""
    out, here = np.zeros((len(poses) - 1, 3, 4)), poses[-1]
    half = math.atan2(here[3], here[0])
    turn = math.cos(half), 0.0, 0.0, -math.sin(half)
    shift = cosines(turn)
    for k in range(len(out)):
        w, x, y, z = poses[k, 0], poses[k, 1], poses[k, 2], poses[k, 3]
        if not level:
            upright = np.hypot(w, z)
            w, x, y, z = w / upright, 0.0, 0.0, z / upright
        R = cosines(product(turn, (w, x, y, z)))
        for i in range(3):
            for j in range(4):
                for m in range(3):
                    out[k, i, j] += R[3 * i + m] * mount[m, j]
            for m in range(3):
                out[k, i, 3] += shift[3 * i + m] * (poses[k, 4 + m] - here[4 + m])
    return out


@njit(cache=True, error_model="numpy")
def _place(reaches, cosines, sines, begin, end, knots, k, knot_step, out):
    """One coordinate of the ends of the beams of one piece, by the rows (k, 4) of the knots' transforms."""
    ax, ay, at = knots[k, 0], knots[k, 1], knots[k, 3]
    bx, by, bt = knots[k + 1, 0], knots[k + 1, 1], knots[k + 1, 3]
    for i in range(end - begin):
        reach = get(reaches, i)
        lx, ly = reach * get(cosines, begin + i), reach * get(sines, begin + i)
        p = ax * lx + ay * ly + at
        q = bx * lx + by * ly + bt
        put(out, i, p + ((begin + i) / knot_step - k) * (q - p))
