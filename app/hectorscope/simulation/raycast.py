"""Rays against a soup of triangles, found through a grid of square columns in plan."""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from slam_core.measurements import Float64s

Ints = NDArray[np.int64]
MISS = -1
_TOUCH = 1e-9  # m: slack at the edges, so that no ray slips between neighbouring triangles


class ColumnGrid(NamedTuple):
    """Which triangles stand over which square of the ground.

    origin: (2,) and cell: metres. shape: squares in x and y. starts, items: the triangles of square i are
    items[starts[i]:starts[i + 1]]. corners: (n, 9) first corner and the two edges that leave it.
    """

    origin: Float64s
    cell: float
    shape: tuple[int, int]
    starts: Ints
    items: Ints
    corners: Float64s


def column_grid(triangles: Float64s, cell: float) -> ColumnGrid:
    """Sort (n, 3, 3) triangles into squares of `cell` metres, by their bounding boxes in plan."""
    low, high = triangles[:, :, :2].min(axis=1), triangles[:, :, :2].max(axis=1)
    origin = low.min(axis=0) - cell
    nx, ny = (np.ceil((high.max(axis=0) + cell - origin) / cell)).astype(np.int64)
    first = np.floor((low - _TOUCH - origin) / cell).astype(np.int64)
    last = np.floor((high + _TOUCH - origin) / cell).astype(np.int64)
    squares, owners = _spread(first, last, int(nx))
    order = np.argsort(squares, kind="stable")
    starts = np.searchsorted(squares[order], np.arange(nx * ny + 1)).astype(np.int64)
    a, b, c = triangles.transpose(1, 0, 2)
    corners = np.ascontiguousarray(np.concatenate((a, b - a, c - a), axis=1))
    return ColumnGrid(origin, cell, (int(nx), int(ny)), starts, owners[order], corners)


def _spread(first: Ints, last: Ints, nx: int) -> tuple[Ints, Ints]:
    squares: list[int] = []
    owners: list[int] = []
    for owner, ((x0, y0), (x1, y1)) in enumerate(zip(first.tolist(), last.tolist(), strict=True)):
        covered = [y * nx + x for y in range(y0, y1 + 1) for x in range(x0, x1 + 1)]
        squares += covered
        owners += [owner] * len(covered)
    return np.array(squares, np.int64), np.array(owners, np.int64)


@njit(cache=True)
def _hit(corner: Float64s, o: Float64s, d: Float64s) -> float:
    """Distance along o + t d to one triangle (Cramer's rule on the barycentric equation); inf when missed."""
    e1x, e1y, e1z = corner[3], corner[4], corner[5]
    e2x, e2y, e2z = corner[6], corner[7], corner[8]
    px, py, pz = d[1] * e2z - d[2] * e2y, d[2] * e2x - d[0] * e2z, d[0] * e2y - d[1] * e2x
    det = e1x * px + e1y * py + e1z * pz
    if abs(det) < 1e-12:
        return np.inf
    sx, sy, sz = o[0] - corner[0], o[1] - corner[1], o[2] - corner[2]
    a = (sx * px + sy * py + sz * pz) / det
    if a < -_TOUCH or a > 1.0 + _TOUCH:
        return np.inf
    qx, qy, qz = sy * e1z - sz * e1y, sz * e1x - sx * e1z, sx * e1y - sy * e1x
    b = (d[0] * qx + d[1] * qy + d[2] * qz) / det
    if b < -_TOUCH or a + b > 1.0 + _TOUCH:
        return np.inf
    t = (e2x * qx + e2y * qy + e2z * qz) / det
    return t if t > 0.0 else np.inf


@njit(cache=True)
def _entry(grid: ColumnGrid, o: Float64s, d: Float64s) -> float:
    """Distance at which the ray comes over the grid: 0 inside, inf when it never does (slab method)."""
    first, last = 0.0, np.inf
    for k in range(2):
        low, high = grid.origin[k] - o[k], grid.origin[k] + grid.shape[k] * grid.cell - o[k]
        if d[k] == 0.0:
            if low > 0.0 or high < 0.0:
                return np.inf
        else:
            a, b = low / d[k], high / d[k]
            first, last = max(first, min(a, b)), min(last, max(a, b))
    return first if first <= last else np.inf


@njit(cache=True)
def cast(grid: ColumnGrid, origins: Float64s, directions: Float64s, reach: float) -> tuple[Float64s, Ints]:
    """(n,) distances along unit `directions` (n, 3) from `origins` (n, 3), inf beyond `reach`, and what was hit.

    Walks the squares under each ray in order and stops at the first square that ends behind a hit.
    """
    n = len(origins)
    distances = np.full(n, np.inf)
    hits = np.full(n, MISS, np.int64)
    nx, ny = grid.shape
    step = np.empty(2, np.int64)
    exit_at = np.empty(2)
    stride = np.empty(2)
    square = np.empty(2, np.int64)
    for i in range(n):
        o, d = origins[i], directions[i]
        entered = _entry(grid, o, d)
        if entered == np.inf:
            continue
        for k in range(2):
            place = (o[k] + entered * d[k] - grid.origin[k]) / grid.cell
            square[k] = min(max(int(np.floor(place)), 0), grid.shape[k] - 1)
            step[k] = 1 if d[k] > 0.0 else -1
            stride[k] = grid.cell / abs(d[k]) if d[k] != 0.0 else np.inf
            ahead = square[k] + 1 - place if d[k] > 0.0 else place - square[k]
            exit_at[k] = entered + ahead * stride[k] if d[k] != 0.0 else np.inf
        best, hit = reach, MISS
        while entered < best and 0 <= square[0] < nx and 0 <= square[1] < ny:
            where = square[1] * nx + square[0]
            for j in range(grid.starts[where], grid.starts[where + 1]):
                t = _hit(grid.corners[grid.items[j]], o, d)
                if t < best:
                    best, hit = t, grid.items[j]
            axis = 0 if exit_at[0] < exit_at[1] else 1
            entered = exit_at[axis]
            exit_at[axis] += stride[axis]
            square[axis] += step[axis]
        if hit != MISS:
            distances[i], hits[i] = best, hit
    return distances, hits
