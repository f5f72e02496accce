"""How many beams fix a direction in the scan and in the map, too: what the map does not hold fixes nothing.

An opening that the map has not seen yet, or an end that lies on a wall along the direction, counts for the shape
of a scan. The match has nothing to hold it by, and takes the texture of walls in its place.
"""

import math

import numpy as np
from numba import njit

from slam_core.kernels.gauss_newton import in_lattice, normal_equations, place, workspace
from slam_core.kernels.surfaces import tangents, weakest_direction
from slam_core.kernels.surfels import four_around, unpacked

HIT = np.float32(0.5)  # residual of an end on an unknown cell: a wall has less
ZERO = np.float32(0.0)
_workspace = njit(inline="always")(workspace)


@njit(cache=True, error_model="numpy")
def confirmed_share(level, surfels, beams, pose):
    """sum_i d^T (I - a a^T) d of the ends on walls of the map, each times (n^T d)^2, by the number of all beams.

    d is the direction that the shape of the scan fixes worst, a the tangent around an end in the scan, and n the
    normal that is nearest to d of the surfels around it in the map. Without any the end counts as the scan has it.
    level: the finest `Level`. surfels: of its cells. beams: `Beams` in the order of the sweep. pose: (3,).
    """
    xs, ys = beams
    count, columns = len(xs), surfels.shape[1]
    residuals, along_x, along_y = np.empty_like(xs), np.empty_like(xs), np.empty_like(xs)
    tangents(xs, ys, along_x, along_y)
    _, left, up = weakest_direction(xs, ys, along_x, along_y)
    normal_equations(level, beams, pose, residuals, _workspace())
    where, arms = np.empty(count, np.uint32), (np.empty(count, np.float32), np.empty(count, np.float32))
    place(xs, ys, 0, count, in_lattice(level, pose), columns, where, arms)
    c, s, flat, total = math.cos(pose[2]), math.sin(pose[2]), surfels.reshape(-1), 0.0
    for i in range(count):
        if residuals[i] < HIT:
            ax, ay = along_x[i], along_y[i]
            way = ax * left + ay * up
            observed = 1.0 - (2.0 - ax * ax - ay * ay) * way * way
            total += observed * _in_map(flat, np.int64(where[i]), columns, c * left - s * up, s * left + c * up)
    return total / max(count, 1)


@njit(inline="always")
def _in_map(surfels, k, columns, x, y):
    """(n^T d)^2 of the surfels in four cells from k on, the largest; 1 without any."""
    known, nearest = False, 0.0
    for word in four_around(surfels, k, columns):
        beams, nx, ny, _ = unpacked(word)
        if beams > ZERO:
            known, nearest = True, max(nearest, (nx * x + ny * y) ** 2)
    return nearest if known else 1.0
