"""The loops of the wide search: how well endpoints hit a level at many poses. Cells are read, not blended."""

import math

import numpy as np
from numba import njit

from slam_core.kernels.bilinear import UNKNOWN, UNKNOWN_PARTS, WHOLE
from slam_core.kernels.memory import alias_scope

get, _ = alias_scope(0)
_, put = alias_scope(1)


@njit(cache=True, error_model="numpy")
def count_hits(cells, corner, inverse, points, pose):
    """How many endpoints lie on known cells, and how many of those on occupied ones."""
    (rows, columns), flat, where = cells.shape, cells.reshape(-1), np.empty(len(points), np.int32)
    cells_at(rows, columns, corner, inverse, points.reshape(-1), pose, 0, where)
    known = hits = np.int32(0)
    for i in range(len(where)):
        if where[i] >= 0:
            value = flat[where[i]]
            known += np.int32(value != UNKNOWN)
            hits += np.int32(value > UNKNOWN)
    return known, hits


@njit(cache=True, error_model="numpy")
def count_near_hits(cells, corner, inverse, points, poses, out):
    """As `count_hits`, at each pose (m, 3) into `out` (m, 2). The fullest of the four nearest cells counts."""
    (rows, columns), left, low = cells.shape, corner[0], corner[1]
    for k in range(len(poses)):
        c, s = math.cos(poses[k, 2]) * inverse, math.sin(poses[k, 2]) * inverse
        shift_u, shift_v = poses[k, 0] * inverse - 0.5, poses[k, 1] * inverse - 0.5
        known = hits = 0
        for i in range(len(points)):
            u = c * points[i, 0] - s * points[i, 1] + shift_u
            v = s * points[i, 0] + c * points[i, 1] + shift_v
            if left <= u < left + columns - 1 and low <= v < low + rows - 1:
                column, row = int(np.floor(u)) - left, int(np.floor(v)) - low
                below = max(cells[row, column], cells[row, column + 1])
                most = max(below, cells[row + 1, column], cells[row + 1, column + 1])
                known += most != UNKNOWN
                hits += most > UNKNOWN
        out[k, 0], out[k, 1] = known, hits


@njit(cache=True, error_model="numpy")
def cells_at(rows, columns, corner, inverse, ends, pose, edge, where):
    """The cells of endpoints (2n,) at a pose into `where` (n,), -1 within `edge` cells of the edge and beyond it.

    Without a branch. Places are rounded in the lattice, as they are in every window.
    """
    c, s = math.cos(pose[2]) * inverse, math.sin(pose[2]) * inverse
    shift_u, shift_v, left, low = pose[0] * inverse, pose[1] * inverse, np.int32(corner[0]), np.int32(corner[1])
    first_u, last_u = np.float64(corner[0] + edge), np.float64(corner[0] + columns - edge)
    first_v, last_v = np.float64(corner[1] + edge), np.float64(corner[1] + rows - edge)
    for i in range(len(where)):
        x, y = np.float64(get(ends, 2 * i)), np.float64(get(ends, 2 * i + 1))
        u, v = c * x - s * y + shift_u, s * x + c * y + shift_v
        inside = (u >= first_u) & (u < last_u) & (v >= first_v) & (v < last_v)
        column, row = np.int32(np.floor(u)) - left, np.int32(np.floor(v)) - low
        put(where, i, row * np.int32(columns) + column if inside else np.int32(-1))


@njit(cache=True, error_model="numpy")
def score(cells, corner, inverse, points, poses, out):
    """Mean of M over the endpoints at each pose (m, 3), into `out` (m,); 0.5 off the map."""
    (rows, columns), left, low = cells.shape, corner[0], corner[1]
    for k in range(len(poses)):
        c, s = math.cos(poses[k, 2]) * inverse, math.sin(poses[k, 2]) * inverse
        shift_u, shift_v = poses[k, 0] * inverse, poses[k, 1] * inverse
        total = np.int64(0)
        for i in range(len(points)):
            u = c * points[i, 0] - s * points[i, 1] + shift_u
            v = s * points[i, 0] + c * points[i, 1] + shift_v
            inside = left <= u < left + columns and low <= v < low + rows
            total += cells[int(np.floor(v)) - low, int(np.floor(u)) - left] if inside else UNKNOWN
        out[k] = (total + UNKNOWN_PARTS * len(points)) / (WHOLE * len(points))
