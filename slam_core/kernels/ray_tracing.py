"""The cells that the beams of a scan pass on their way."""

import numpy as np
from numba import njit

from slam_core.kernels import INNER

FREE = np.uint8(1)
# A walk counts in parts of 2^-40 of a cell: exact for beams shorter than 2^19 cells, and longer ones draw no ray.
PARTS = 40
LONGEST = 1 << 19


@njit(cache=True, error_model="numpy")
def trace_rays(marks, rows, columns, laser, ends):
    """Cells from the laser up to each end, without it (Bresenham), clipped to the map.

    Beams cross the cells near the laser together, so each starts its ray where no other does: of beams that
    follow each other into the same cell one is drawn, and of those every second begins where its neighbours have
    parted, every fourth where the next two beams on either side have, and so on. In a room of 30 m that leaves
    half of all steps at 0.05 m, a third at 0.1 m and a fifth at 0.2 m. A step takes 0.65 ns.
    """
    u0, v0 = laser[0, 0], laser[1, 0]
    picked = np.empty(ends.shape[1], np.int64)
    n = _distinct(ends[0], ends[1], picked)
    rays, first = np.empty((n, 5), np.int64), np.empty(n, np.int64)
    for k in range(n):
        u, v = ends[0, picked[k]], ends[1, picked[k]]
        _ray(u - u0, v - v0, marks.shape[1], _steps_inside(rows, columns, u0, v0, u, v), rays[k])
    for k in range(n):
        apart = k & -k
        first[k] = _parting(rays[k - apart], rays[k], rays[k + apart]) if 0 < k < n - apart else 0
    flat = marks.reshape(-1)
    for k in range(n):
        _walk(flat, v0 * marks.shape[1] + u0, rays[k], first[k])


@njit(**INNER)
def _distinct(us, vs, picked):
    """Into `picked` (n,) the ends that are not in the same cell as the one before: how many; without a branch."""
    n = 0
    for k in range(len(us)):
        picked[n] = k
        n += (k == 0) | (us[k] != us[k - 1]) | (vs[k] != vs[k - 1])
    return n


@njit(inline="always")
def _ray(du, dv, stride, steps, ray):
    """(5,) steps; bytes along and across in one; the slope in parts, and once more as it is among all rays."""
    upright = abs(dv) > abs(du)
    long, short = (abs(dv), abs(du)) if upright else (abs(du), abs(dv))
    su, sv = 1 if du > 0 else -1, 1 if dv > 0 else -1
    part = (short << PARTS) // max(long, 1) if long < LONGEST else 0
    ray[0] = steps if long < LONGEST else 0
    ray[1], ray[2] = (sv * stride, su) if upright else (su, sv * stride)
    ray[3] = part
    # Rays in the four directions lie more than a slope of 1 apart, so that none lies between two of another one.
    ray[4] = part * (su if upright else sv) + ((sv if upright else 3 * su) << (PARTS + 1))


@njit(inline="always")
def _parting(a, ray, b):
    """The first step at which a ray may leave both of its neighbours a and b.

    A step's place across the ray is its number times the slope, rounded. As long as the places on a and b differ
    by a cell at most, a slope between theirs gives one of the two.
    """
    low, high = min(a[4], b[4]), max(a[4], b[4])
    if not low <= ray[4] <= high:
        return 0
    return int(min(a[0], b[0], (1 << PARTS) / max(high - low, 1)))


@njit(inline="always")
def _walk(flat, start, ray, first):
    """Mark the cells from step `first` on. The place across is the step times the slope, halves rounded down.

    It is summed in parts of a cell, a step at a time without a branch: what the slope's division cut off, a part a
    step at most, never adds up to the distance from a half to the nearest other place.
    """
    n, along, across, part = ray[0], ray[1], ray[2], ray[3]
    place = (1 << PARTS - 1) - 1 + first * part
    i = start + first * along
    for _ in range(first, n):
        flat[np.uint64(i + (place >> PARTS) * across)] = FREE
        place += part
        i += along


@njit(**INNER)
def _steps_inside(rows, columns, u0, v0, u1, v1):
    """How many of the steps from the laser to the end stay on the map; none when the laser itself is off it."""
    n = max(abs(u1 - u0), abs(v1 - v0))
    if not (0 <= u0 < columns and 0 <= v0 < rows):
        return 0
    if 0 <= u1 < columns and 0 <= v1 < rows:
        return n
    fraction = 1.0
    for start, end, last in ((u0, u1, columns - 1), (v0, v1, rows - 1)):
        if end < 0:
            fraction = min(fraction, start / (start - end))
        elif end > last:
            fraction = min(fraction, (last - start) / (end - start))
    return max(0, int(n * fraction) - 1)
