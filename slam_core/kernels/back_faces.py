"""Ends of beams on walls that are seen from behind, where no wall can be seen.

Where a robot first sees the other side of a wall, that side is unknown, and the mapped one is the thickness of the
wall away: eq. (7) draws the scan there. The surfels tell from where a wall was seen. (Variants of ICP reject pairs
of points whose normals contradict each other: Rusinkiewicz and Levoy 2001.)
"""

import math

import numpy as np
from numba import njit

from slam_core.kernels.gauss_newton import TOGETHER, in_lattice, joint_cost, place
from slam_core.kernels.structures import Beams
from slam_core.kernels.surfels import four_around, unpacked

AWAY = np.float32(0.2)  # cosine of beam and normal of a surface that looks away
AT_UNKNOWN = np.float32(0.5)  # residual of an end on an unknown cell
ZERO = np.float32(0.0)


@njit(cache=True, error_model="numpy")
def count_behind(walls, beams, pose, behind):
    """Into `behind` (n,) which ends have surfels around them that all look away from the robot. How many.

    walls: a `Level` of surfels. pose: (3,).
    """
    frame, n, room = in_lattice(walls, pose), len(beams.xs), min(TOGETHER, len(beams.xs))
    flat, columns = walls.cells.reshape(-1), walls.cells.shape[1]
    where, arms = np.empty(room, np.uint32), np.empty((2, room), np.float32)
    count = 0
    for begin in range(0, n, TOGETHER):
        m = min(TOGETHER, n - begin)
        place(beams.xs, beams.ys, begin, m, frame, columns, where, (arms[0], arms[1]))
        for i in range(m):
            k, x, y = np.int64(where[i]), arms[0, i], arms[1, i]
            away, hidden = AWAY * np.sqrt(x * x + y * y), False
            for word in four_around(flat, k, columns):
                seen, nx, ny, _ = unpacked(word)
                if seen > ZERO:
                    hidden = nx * x + ny * y > away
                    if not hidden:
                        break
            behind[begin + i] = hidden
            count += hidden
    return count


@njit(cache=True, error_model="numpy")
def find_behind(walls, beams, ends, poses, place, behind):
    """`count_behind` of the beams of many scans: those of scan k are from ends[k] to ends[k + 1].

    poses: (m, 3) of the scans in a frame that lies at `place` (3,) in the map.
    """
    c, s, pose = math.cos(place[2]), math.sin(place[2]), np.empty(3)
    for k in range(len(poses)):
        x, y, a, b = poses[k, 0], poses[k, 1], ends[k], ends[k + 1]
        pose[0], pose[1], pose[2] = place[0] + c * x - s * y, place[1] + s * x + c * y, place[2] + poses[k, 2]
        count_behind(walls, Beams(beams.xs[a:b], beams.ys[a:b]), pose, behind[a:b])


@njit(cache=True, error_model="numpy")
def cost_in_front(level, beams, pose, term, residuals, behind, workspace):
    """`joint_cost` where ends `behind` (n,) count as on unknown cells, at least."""
    cost = joint_cost(level, beams, pose, term, residuals, workspace)
    for k in range(len(behind)):
        if behind[k]:
            cost += max(ZERO, AT_UNKNOWN * AT_UNKNOWN - residuals[k] * residuals[k])
    return cost


@njit(inline="always")
def as_unknown(residuals, behind):
    """The residuals (n,) of ends `behind` (n,) are those of unknown cells, at least."""
    for k in range(len(behind)):
        if behind[k]:
            residuals[k] = max(residuals[k], AT_UNKNOWN)
