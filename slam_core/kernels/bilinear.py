"""Equations (4)-(6) for one point, inlined into the loops that need them.

A cell keeps its probability in parts of 2^16, less 2^15: what nobody saw is 0, as new memory is. The two
neighbours in a row are one word of 32 bits, so that two loads fetch four cells.
"""

import numpy as np
from numba import njit

from slam_core.kernels.memory import pair

WHOLE = 65536.0  # the parts of a probability of 1, which is rounded to one part less
UNKNOWN = np.int16(0)  # as a cell keeps it
UNKNOWN_PARTS = 32768
UNKNOWN_PAIR = np.uint32(0x80008000)  # those in both halves of a word
LEFT_HALF, RIGHT_SHIFT = np.uint32(0xFFFF), np.uint32(16)


@njit(inline="always")
def bilinear(lower, upper, fu, fv):
    """M, dM/du, dM/dv in parts, fu and fv of the way between four samples one apart: two rows, as words."""
    lower, upper = lower ^ UNKNOWN_PAIR, upper ^ UNKNOWN_PAIR  # to parts: adds 2^15 to either half
    p00, p10 = np.float32(np.int32(lower & LEFT_HALF)), np.float32(np.int32(lower >> RIGHT_SHIFT))
    p01, p11 = np.float32(np.int32(upper & LEFT_HALF)), np.float32(np.int32(upper >> RIGHT_SHIFT))
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
        column = np.int32(min(columns - 2, max(0.0, us[i])))
        row = np.int32(min(rows - 2, max(0.0, vs[i])))
        k = row * np.int32(columns) + column
        out[i, 0], out[i, 1], out[i, 2] = bilinear(
            pair(cells, k), pair(cells, k + np.int32(columns)), us[i] - np.float32(column), vs[i] - np.float32(row)
        )
