"""The map update of section IV: each cell changes at most once a scan, whatever the order of the beams.

Two passes give that without undoing anything: ends first, then the cells on the way, which skip what the scan
has touched already.
"""

import math

import numpy as np
from numba import njit


@njit(inline="always")
def _change(cells, probability, i, step, low, high):
    value = min(max(cells[i] + step, low), high)
    cells[i] = value
    probability[i] = np.float32(1.0) / (np.float32(1.0) + np.float32(math.exp(-value)))


@njit(cache=True, error_model="numpy")
def mark_ends(cells, probability, marks, mark, rows, columns, us, vs, step, low, high):
    """The end cell of every beam takes the occupied step once; ends off the map are left out."""
    for k in range(len(us)):
        u, v = us[k], vs[k]
        if 0 <= u < columns and 0 <= v < rows:
            i = v * columns + u
            if marks[i] != mark:
                marks[i] = mark
                _change(cells, probability, i, step, low, high)


@njit(cache=True, error_model="numpy")
def clear_rays(cells, probability, marks, mark, rows, columns, u0, v0, us, vs, step, low, high):
    """Cells from the laser up to each end, without it, take the free step once (Bresenham), clipped to the map."""
    for k in range(len(us)):
        du, dv = abs(us[k] - u0), abs(vs[k] - v0)
        su = 1 if us[k] > u0 else -1
        sv = columns if vs[k] > v0 else -columns
        along, across, n, short = (su, sv, du, dv) if du >= dv else (sv, su, dv, du)
        n = _steps_inside(rows, columns, u0, v0, us[k], vs[k], n)
        error = max(du, dv) >> 1
        full = max(du, dv)
        i = v0 * columns + u0
        for _ in range(n):
            if marks[i] != mark:
                marks[i] = mark
                _change(cells, probability, i, step, low, high)
            error -= short
            i += along
            if error < 0:
                error += full
                i += across


@njit(cache=True, error_model="numpy")
def _steps_inside(rows, columns, u0, v0, u1, v1, n):
    """How many of the n steps from the laser stay on the map; none when the laser itself is off it."""
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
