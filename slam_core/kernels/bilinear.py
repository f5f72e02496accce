"""Equations (4)-(6) for one point, inlined into the loops that need them."""

import numpy as np
from numba import njit


@njit(inline="always")
def bilinear(cells, columns, column, row, fu, fv):
    """M, dM/du, dM/dv at (column + fu, row + fv) of a flat row-major grid whose samples are one apart."""
    i = row * columns + column
    p00 = cells[i]
    p10 = cells[i + np.int32(1)]
    p01 = cells[i + columns]
    p11 = cells[i + columns + np.int32(1)]
    low = p00 + fu * (p10 - p00)
    high = p01 + fu * (p11 - p01)
    value = low + fv * (high - low)
    du = (p10 - p00) + fv * ((p11 - p01) - (p10 - p00))
    dv = high - low
    return value, du, dv


@njit(cache=True)
def bilinear_at(cells, rows, columns, us, vs, out):
    """The same for many points, clamped to the grid; `out` (n, 3) takes value and gradient."""
    for i in range(len(us)):
        column = np.int32(min(max(us[i], 0.0), columns - 2))
        row = np.int32(min(max(vs[i], 0.0), rows - 2))
        out[i, 0], out[i, 1], out[i, 2] = bilinear(
            cells, np.int32(columns), column, row, us[i] - np.float32(column), vs[i] - np.float32(row)
        )
