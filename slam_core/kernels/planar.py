"""Small closed forms that run for every scan: numpy's general ones take longer to call than to compute."""

import math

import numpy as np
from numba import njit

TINY = 1e-14  # of a pivot: what rounding may leave of it


@njit(cache=True, error_model="numpy")
def inverse3(A):
    """The inverse of a symmetric positive definite (3, 3), exactly symmetric and positive however ill-conditioned.

    By Cholesky: cofactors cancel where one direction is a million times better known than another.
    """
    a = np.sqrt(A[0, 0])
    b, c = A[0, 1] / a, A[0, 2] / a
    d = np.sqrt(max(A[1, 1] - b * b, TINY * A[1, 1]))
    e = (A[1, 2] - b * c) / d
    f = np.sqrt(max(A[2, 2] - c * c - e * e, TINY * A[2, 2]))
    m00, m11, m22 = 1.0 / a, 1.0 / d, 1.0 / f
    m10 = -b * m00 * m11
    m21 = -e * m11 * m22
    m20 = -(c * m00 + e * m10) * m22
    out = np.empty((3, 3))
    out[0, 0] = m00 * m00 + m10 * m10 + m20 * m20
    out[1, 1] = m11 * m11 + m21 * m21
    out[2, 2] = m22 * m22
    out[0, 1] = out[1, 0] = m10 * m11 + m20 * m21
    out[0, 2] = out[2, 0] = m20 * m22
    out[1, 2] = out[2, 1] = m21 * m22
    return out


@njit(inline="always")
def whole_turns(angle):
    """What to take from an angle to have it in [-pi, pi), radians."""
    return 2.0 * math.pi * np.floor(angle / (2.0 * math.pi) + 0.5)


@njit(cache=True, error_model="numpy")
def transform_points(pose, points):
    """`geometry.transform_points`, in a tenth of its time."""
    c, s = math.cos(pose[2]), math.sin(pose[2])
    out = np.empty((len(points), 2))
    for k in range(len(points)):
        x, y = np.float64(points[k, 0]), np.float64(points[k, 1])
        out[k, 0] = c * x - s * y + pose[0]
        out[k, 1] = s * x + c * y + pose[1]
    return out


@njit(cache=True, error_model="numpy")
def sigmas_apart(a, P, b, R):
    """Mahalanobis distance of two poses (3,) with covariances (3, 3), across the seam of the heading."""
    both, d = np.empty((3, 3)), np.empty(3)
    for i in range(3):  # numpy's own arithmetic takes long to compile
        d[i] = a[i] - b[i]
        for j in range(3):
            both[i, j] = P[i, j] + R[i, j]
    information = inverse3(both)
    d[2] -= whole_turns(d[2])
    total = 0.0
    for i in range(3):
        for j in range(3):
            total += d[i] * information[i, j] * d[j]
    return math.sqrt(max(total, 0.0))
