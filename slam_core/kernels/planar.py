"""Small closed forms that run for every scan: numpy's general ones take longer to call than to compute."""

from typing import Any

import numpy as np
from numba import njit

from slam_core import geometry

_matrix: Any = njit(geometry.rotation_matrix)
_product: Any = njit(geometry.multiply)


@njit(cache=True, error_model="numpy")
def inverse3(A):
    """The inverse of a symmetric positive definite (3, 3), exactly symmetric."""
    c00 = A[1, 1] * A[2, 2] - A[1, 2] * A[1, 2]
    c01 = A[0, 2] * A[1, 2] - A[0, 1] * A[2, 2]
    c02 = A[0, 1] * A[1, 2] - A[0, 2] * A[1, 1]
    c11 = A[0, 0] * A[2, 2] - A[0, 2] * A[0, 2]
    c12 = A[0, 1] * A[0, 2] - A[0, 0] * A[1, 2]
    c22 = A[0, 0] * A[1, 1] - A[0, 1] * A[0, 1]
    scale = 1.0 / (A[0, 0] * c00 + A[0, 1] * c01 + A[0, 2] * c02)
    out = np.empty((3, 3))
    out[0, 0], out[1, 1], out[2, 2] = c00 * scale, c11 * scale, c22 * scale
    out[0, 1] = out[1, 0] = c01 * scale
    out[0, 2] = out[2, 0] = c02 * scale
    out[1, 2] = out[2, 1] = c12 * scale
    return out


@njit(cache=True, error_model="numpy")
def knots(positions, rotations, origin, turn, mount, level):
    """(k, 3, 4) transforms laser -> stabilised frame for base poses (k, 3) and (k, 4) during a sweep.

    origin: (3,) position and turn: (4,) opposite heading of the stabilised frame. mount: (4, 4) laser -> base.
    """
    out = np.zeros((len(positions), 3, 4))
    for k in range(len(positions)):
        rotation = rotations[k]
        if not level:
            rotation = np.array([rotation[0], 0.0, 0.0, rotation[3]]) / np.hypot(rotation[0], rotation[3])
        R = _matrix(_product(turn, rotation))
        shift = _matrix(turn)
        for i in range(3):
            for j in range(4):
                for m in range(3):
                    out[k, i, j] += R[i, m] * mount[m, j]
            for m in range(3):
                out[k, i, 3] += shift[i, m] * (positions[k, m] - origin[m])
    return out
