"""Beams that cross walls and end on none: where many of them do, the scan was not made."""

import math

import numpy as np
from numba import njit

from slam_core.kernels.bilinear import UNKNOWN


@njit(cache=True, error_model="numpy")
def count_crossing(cells, corner, inverse, points, laser, pose, slack, every):
    """How many beams of a scan at a pose (3,) the map knows something of, and how many of them cross walls.

    Those that end on a wall do not count as crossing: glass is seen and seen through. points: (n, 2) endpoints, of
    which each `every`th counts, laser: (2,), metres in the frame of the pose. The last `slack` cells of a beam do
    not count. Places are rounded in the lattice, as they are in every window.
    """
    c, s = math.cos(pose[2]) * inverse, math.sin(pose[2]) * inverse
    shift_u, shift_v = pose[0] * inverse, pose[1] * inverse
    u0, v0 = c * laser[0] - s * laser[1] + shift_u, s * laser[0] + c * laser[1] + shift_v
    longest = np.float64(cells.shape[0] + cells.shape[1])  # a beam from within has left the cells by then
    known = crossing = 0
    for k in range(0, len(points), every):
        x, y = np.float64(points[k, 0]), np.float64(points[k, 1])
        u, v = c * x - s * y + shift_u, s * x + c * y + shift_v
        end = _cell(cells, corner, u, v)
        crosses = False
        if end <= UNKNOWN:
            length = math.hypot(x - laser[0], y - laser[1]) * inverse
            for step in range(1, int(min(length - slack, longest))):
                t = step / length
                if _cell(cells, corner, u0 + t * (u - u0), v0 + t * (v - v0)) > UNKNOWN:
                    crosses = True
                    break
        crossing += crosses
        known += crosses or end != UNKNOWN
    return known, crossing


@njit(inline="always")
def _cell(cells, corner, u, v):
    rows, columns = cells.shape
    if not (corner[0] <= u < corner[0] + columns and corner[1] <= v < corner[1] + rows):
        return np.int64(UNKNOWN)
    return np.int64(cells[int(np.floor(v)) - corner[1], int(np.floor(u)) - corner[0]])
