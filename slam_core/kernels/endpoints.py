"""Section IV: every beam of a sweep placed by the motion at its own time."""

import math

import numpy as np
from numba import njit

from slam_core.kernels import INNER
from slam_core.kernels.memory import alias_scope
from slam_core.kernels.rotations import cosines, product
from slam_core.kernels.structures import BeamLimits
from slam_core.measurements import Float32s

get, _ = alias_scope(0)
_, put = alias_scope(1)

FURTHEST = 1e4  # metres from the base: no beam ends there, nor where it is no number
# Metres to both sides of the end of a laser's range that noise on it reaches. It is noise if one beam in so many
# is at the end, and for so many of those another is before it: walls there are seen by fewer.
NOISE, ENDED, NOISY = 0.1, 50, 4


@njit(cache=True, error_model="numpy")
def place_beams(ranges, directions, poses, mount, level, limits, output):
    """Endpoints and heights in the stabilised frame, and the ends of beams without a return: how many of each.

    directions: cosines and sines (n,) of the beams. poses: (k + 1, 7) or wider, attitude and position of the base
    in equal steps of time over the sweep, and last the one of the stabilised frame. mount: (4, 4) laser -> base.
    level: whether roll and pitch count. limits: the fields of `BeamLimits`; clear_range 0 clears nothing. output:
    takes points (n, 2), heights (n,) over the middle of the laser's path, free ends (n, 2), and that middle (2,).
    """
    limits, (points, heights, free, laser) = BeamLimits(*limits), output
    low, high, no_return, clear_range, z_min, z_max = limits
    n = len(ranges)
    transforms = _knots(poses, mount, level)
    knot_step = max(n - 1, 1) / (len(transforms) - 1)
    xs, ys, zs, flat = np.empty(n), np.empty(n), np.empty(n), points.reshape(-1)
    laser[0], laser[1] = (
        0.5 * (transforms[0, 0, 3] + transforms[-1, 0, 3]),
        0.5 * (transforms[0, 1, 3] + transforms[-1, 1, 3]),
    )
    z_laser = 0.5 * (transforms[0, 2, 3] + transforms[-1, 2, 3])
    z_low, z_high, over = z_laser + z_min, z_laser + z_max, np.float32(z_laser)
    kept = cleared = end = 0
    for knot in range(len(transforms) - 1):  # piece by piece, which stays in the nearest cache
        begin, end = end, n if knot == len(transforms) - 2 else min(n, math.ceil((knot + 1) * knot_step))
        _place(ranges, directions, limits, int(begin), end, transforms, knot, knot_step, (xs, ys, zs))
        for i in range(end - begin):
            r, z = get(ranges, begin + i), zs[i]
            if not (z_low <= z <= z_high and abs(xs[i]) + abs(ys[i]) < FURTHEST):
                continue
            if low <= r < high:
                put(flat, 2 * kept, np.float32(xs[i]))
                put(flat, 2 * kept + 1, np.float32(ys[i]))
                put(heights, kept, np.float32(z) - over)
                kept += 1
            elif clear_range > 0.0 and r >= no_return:
                free[cleared, 0], free[cleared, 1] = xs[i], ys[i]
                cleared += 1
    return kept, cleared


@njit(cache=True, error_model="numpy")
def end_of_range(ranges: Float32s, range_max: float) -> float:
    """Where endpoints end, metres, for ranges (n,): at the end of the laser's range, infinite if it states none.

    Where nothing returns, some drivers send the end in place of infinity. Simulators add noise to it: then as many
    ranges are just before it, and none of these is an endpoint.
    """
    if not range_max > 0.0:
        return math.inf
    end, ended, near, empty = np.float32(range_max), 0, 0, 0
    for r in ranges:
        ended += end <= r <= end + NOISE
        near += end - NOISE <= r < end
        empty += r == math.inf
    noisy = empty == 0 and ended * ENDED >= len(ranges) and near * NOISY >= ended
    return float(end) - (NOISE if noisy else 0.0)


@njit(**INNER)
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


@njit(**INNER)
def _place(ranges, directions, limits, begin, end, knots, k, knot_step, output):
    """The ends of the beams of one piece, or how far they clear, by the transforms (k, 3, 4) of the knots."""
    (cosines, sines), (xs, ys, zs) = directions, output
    low, high, clear_range = limits.low, limits.high, limits.clear_range
    a, b = knots[k], knots[k + 1]
    for i in range(end - begin):
        r, share = get(ranges, begin + i), (begin + i) / knot_step - k
        reach = r if (low <= r) & (r < high) else clear_range
        x, y = reach * get(cosines, begin + i), reach * get(sines, begin + i)
        put(xs, i, _between(a[0, 0] * x + a[0, 1] * y + a[0, 3], b[0, 0] * x + b[0, 1] * y + b[0, 3], share))
        put(ys, i, _between(a[1, 0] * x + a[1, 1] * y + a[1, 3], b[1, 0] * x + b[1, 1] * y + b[1, 3], share))
        put(zs, i, _between(a[2, 0] * x + a[2, 1] * y + a[2, 3], b[2, 0] * x + b[2, 1] * y + b[2, 3], share))


@njit(inline="always")
def _between(a, b, share):
    return a + share * (b - a)
