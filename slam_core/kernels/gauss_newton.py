"""Equations (7)-(14) as loops over the beams: float32 and branch-free, so that LLVM makes vectors of them.

Poses are float64 (x, y, psi) in metres and radians; `inverse` is cells a metre. Beams are placed in the lattice:
float32 rounds finely near the map's start, and in the same way however far the map reaches.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from slam_core.kernels import INNER
from slam_core.kernels.bilinear import WHOLE, bilinear
from slam_core.kernels.memory import alias_scope, pair
from slam_core.kernels.structures import LatticePose
from slam_core.measurements import Float32s

ZERO = np.float32(0.0)
HALF = np.float32(0.5)
ONE = np.float32(1.0)
PART = np.float32(1.0 / WHOLE)
TOGETHER = 2048  # beams whose workspace stays in the nearest cache
get, _ = alias_scope(0)  # what is read
_, put = alias_scope(1)
_, put_too = alias_scope(2)


def workspace() -> tuple[NDArray[np.uint32], Float32s]:
    """Memory for the cells and endpoints of the beams that `normal_equations` takes together."""
    return np.empty((3, TOGETHER), np.uint32), np.empty((2, TOGETHER), np.float32)


@njit(cache=True, fastmath=True, error_model="numpy")
def normal_equations(level, beams, pose, residuals, workspace):
    """H of (13) as its six upper entries, the right side of (12), and the cost of (7); metres and radians.

    level: a `Level`. beams: `Beams`. pose: (3,).
    residuals: (n,) takes 1 - M(S_i(xi)) of every beam. Points off the map read 0.5 (unknown) with no gradient.
    workspace: as of `workspace`.
    """
    frame = in_lattice(level, pose)
    flat, columns = level.cells.reshape(-1), level.cells.shape[1]
    words, arms = workspace
    where, cells, ends = words[0], (words[1], words[2]), (arms[0], arms[1])
    h00 = h01 = h02 = h11 = h12 = h22 = b0 = b1 = b2 = cost = ZERO
    for begin in range(0, len(beams.xs), TOGETHER):
        n = min(TOGETHER, len(beams.xs) - begin)
        place(beams.xs, beams.ys, begin, n, frame, columns, where, ends)
        _fetch(flat, columns, where, n, cells[0], cells[1])
        s00, s01, s02, s11, s12, s22, t0, t1, t2, e = _add_up(cells, ends, begin, n, frame, residuals)
        h00, h01, h02, h11, h12, h22 = h00 + s00, h01 + s01, h02 + s02, h11 + s11, h12 + s12, h22 + s22
        b0, b1, b2, cost = b0 + t0, b1 + t1, b2 + t2, cost + e
    # Gradients were summed in parts of the probability a cell.
    p = 1.0 / WHOLE
    k = level.inverse * p
    return (
        h00 * k * k, h01 * k * k, h02 * k * p, h11 * k * k, h12 * k * p, h22 * p * p,
        b0 * k, b1 * k, b2 * p, np.float64(cost),
    )  # fmt: skip


@njit(inline="always")
def in_lattice(level, pose):
    """A pose (3,) in the cells of a level."""
    inverse = level.inverse
    turn = np.float32(math.cos(pose[2]) * inverse), np.float32(math.sin(pose[2]) * inverse)
    shift = np.float32(pose[0] * inverse - 0.5), np.float32(pose[1] * inverse - 0.5)
    rows, columns = level.cells.shape
    left, low = np.int32(level.corner[0]), np.int32(level.corner[1])
    box = np.float32(left), np.float32(left + columns - 2), np.float32(low), np.float32(low + rows - 2)
    return LatticePose(turn, shift, box)


@njit(cache=True, fastmath={"contract", "reassoc", "nsz", "arcp", "afn"}, error_model="numpy")
def place(xs, ys, begin, n, frame, columns, where, ends):
    """Of n beams the first of the four cells around the endpoint, and the endpoint from the robot, in cells.

    No number is placed, too: `max` gives what it is given first then, unless LLVM may take everything for numbers.
    """
    (turn, shift, box), (arm_u, arm_v) = frame, ends
    left, low, width = np.int32(box[0]), np.int32(box[2]), np.int32(columns)
    for i in range(n):
        j = np.int32(i)
        px, py = get(xs, begin + j), get(ys, begin + j)
        u, v = turn[0] * px - turn[1] * py, turn[1] * px + turn[0] * py
        put(arm_u, j, u)
        put_too(arm_v, j, v)
        column = np.int32(np.floor(min(box[1], max(box[0], u + shift[0])))) - left
        row = np.int32(np.floor(min(box[3], max(box[2], v + shift[1])))) - low
        put(where, j, np.uint32(row * width + column))


@njit(**INNER)
def _fetch(cells, columns, where, n, lower, upper):
    """Two rows of two cells each, one by one: a vector would gather them, which is slow on many processors.

    Plain stores keep it so: for all that LLVM knows they may change what is read next.
    """
    for i in range(n):
        first = np.int64(where[i])
        lower[i], upper[i] = pair(cells, first), pair(cells, first + columns)


@njit(fastmath=True, **INNER)
def _add_up(cells, ends, begin, n, frame, residuals):
    """The sums over n beams, in parts of the probability and in cells."""
    (lower, upper), (arm_u, arm_v) = cells, ends
    _, shift, box = frame
    first_u, last_u, first_v, last_v = box
    h00 = h01 = h02 = h11 = h12 = h22 = b0 = b1 = b2 = cost = ZERO
    for i in range(n):
        j = np.int32(i)
        pu, pv = get(arm_u, j), get(arm_v, j)
        u, v = pu + shift[0], pv + shift[1]
        inside = (u >= first_u) & (v >= first_v) & (u < last_u + ONE) & (v < last_v + ONE)
        floor_u = np.floor(min(max(u, first_u), last_u))
        floor_v = np.floor(min(max(v, first_v), last_v))
        value, du, dv = bilinear(get(lower, j), get(upper, j), u - floor_u, v - floor_v)
        weight = ONE if inside else ZERO
        gu, gv = du * weight, dv * weight
        error = ONE - PART * value if inside else HALF
        gp = gv * pu - gu * pv
        put(residuals, begin + j, error)
        h00 += gu * gu
        h01 += gu * gv
        h02 += gu * gp
        h11 += gv * gv
        h12 += gv * gp
        h22 += gp * gp
        b0 += gu * error
        b1 += gv * error
        b2 += gp * error
        cost += error * error
    return h00, h01, h02, h11, h12, h22, b0, b1, b2, cost


@njit(cache=True, error_model="numpy")
def solve3(h00, h01, h02, h11, h12, h22, b0, b1, b2):
    """Solution of the symmetric 3x3 system by cofactors, and whether it is well posed."""
    c00 = h11 * h22 - h12 * h12
    c01 = h02 * h12 - h01 * h22
    c02 = h01 * h12 - h02 * h11
    det = h00 * c00 + h01 * c01 + h02 * c02
    if not det > 1e-12 * max(h00 * h11 * h22, 1e-30):
        return 0.0, 0.0, 0.0, False
    c11 = h00 * h22 - h02 * h02
    c12 = h01 * h02 - h00 * h12
    c22 = h00 * h11 - h01 * h01
    return (
        (c00 * b0 + c01 * b1 + c02 * b2) / det,
        (c01 * b0 + c11 * b1 + c12 * b2) / det,
        (c02 * b0 + c12 * b1 + c22 * b2) / det,
        True,
    )


@njit(cache=True, error_model="numpy")
def without(unobservable, h00, h01, h02, h11, h12, h22, b0, b1, b2):
    """The same equations for a step that has no part along `unobservable`, a unit vector in the plane or zero."""
    x, y = -unobservable[1], unobservable[0]
    if x == 0.0 and y == 0.0:
        return h00, h01, h02, h11, h12, h22, b0, b1, b2
    across = x * x * h00 + 2.0 * x * y * h01 + y * y * h11
    with_turn, right = x * h02 + y * h12, x * b0 + y * b1
    # Along it the equations have `across` too, which makes them well posed, and a step of 0.
    return across, 0.0, x * with_turn, across, y * with_turn, h22, x * right, y * right, b2


@njit(cache=True, error_model="numpy")
def gauss_newton(level, beams, pose, prior, unobservable, limits, residuals, trace, workspace, matched):
    """Iterate (12) on one level; `pose` (3,) is updated in place and every iterate goes to `trace` (k, 3).

    prior: (4, 3), information of a predicted pose in units of the cost, and below it that pose; zeros for none.
    unobservable: (2,) unit vector in which no step is taken, zeros for none. limits: `Limits`.
    matched: (6,) takes the upper entries of H with the prior in it, as of the last step.
    Ends early when a step is shorter than `converged_step` metres (its yaw counted at one metre's arm).
    Returns the number of steps taken and whether the last one was that short.
    """
    steps = 0
    for k in range(limits.iterations):
        h00, h01, h02, h11, h12, h22, b0, b1, b2, _ = normal_equations(level, beams, pose, residuals, workspace)
        e0, e1, e2 = prior[3, 0] - pose[0], prior[3, 1] - pose[1], prior[3, 2] - pose[2]
        matched[0], matched[1], matched[2] = h00 + prior[0, 0], h01 + prior[0, 1], h02 + prior[0, 2]
        matched[3], matched[4], matched[5] = h11 + prior[1, 1], h12 + prior[1, 2], h22 + prior[2, 2]
        dx, dy, dpsi, solved = solve3(
            *without(
                unobservable,
                matched[0],
                matched[1],
                matched[2],
                matched[3],
                matched[4],
                matched[5],
                b0 + prior[0, 0] * e0 + prior[0, 1] * e1 + prior[0, 2] * e2,
                b1 + prior[1, 0] * e0 + prior[1, 1] * e1 + prior[1, 2] * e2,
                b2 + prior[2, 0] * e0 + prior[2, 1] * e1 + prior[2, 2] * e2,
            )
        )
        if not solved:
            return steps, False
        pose[0] += dx
        pose[1] += dy
        pose[2] += dpsi
        steps += 1
        if k < len(trace):
            trace[k, 0], trace[k, 1], trace[k, 2] = pose[0], pose[1], pose[2]
        if max(abs(dx), abs(dy), abs(dpsi)) < limits.converged_step:
            return steps, True
    return steps, limits.converged_step == 0.0


@njit(cache=True, error_model="numpy")
def joint_cost(level, beams, pose, prior, residuals, workspace):
    """The cost of (7) at a pose (3,) with that of the prior, as in `gauss_newton`."""
    return normal_equations(level, beams, pose, residuals, workspace)[9] + prior_cost(prior, pose)


@njit(cache=True, error_model="numpy")
def prior_cost(prior, pose):
    """(xi - mean)^T P^-1 (xi - mean) in units of the cost, with the prior of `gauss_newton`, at a pose (3,)."""
    sum_ = 0.0
    for i in range(3):
        for j in range(3):
            sum_ += prior[i, j] * (pose[i] - prior[3, i]) * (pose[j] - prior[3, j])
    return sum_
