"""Where in its cells a surface lies: a straight piece of it a cell, seen from one side, and a match against those.

A cell of eq. (4) is occupied as a whole. The finest level keeps for each cell the mean line
through the ends of beams in it. Its 32 bits hold how many those were, the unit normal that looks at the laser, and
how far along it, from the middle of the cell, the line lies. (Surface elements as of Pfister et al. 2000, on a
lattice.)
"""

import math
from typing import Any

import numpy as np
from numba import njit

from slam_core.kernels import INNER
from slam_core.kernels.gauss_newton import TOGETHER, in_lattice, place, solve3, without
from slam_core.kernels.linear import assign
from slam_core.kernels.map_update import whole
from slam_core.kernels.memory import alias_scope, pair
from slam_core.kernels.surfaces import tangents

get, _ = alias_scope(0)
_, put = alias_scope(1)
_, put_too = alias_scope(2)
ZERO, HALF, ONE = np.float32(0.0), np.float32(0.5), np.float32(1.0)
# The word: 6 bits of the count, 7 of each component of the normal, 12 of the offset, from the lowest.
COUNT, LAST = np.int32(63), np.float32(60.0)
MOST = np.float32(2047.0)
IN_COMPONENTS, IN_OFFSETS = np.float32(63.0), np.float32(2047.0 / 0.75)  # of one, and of a cell
COMPONENT, OFFSET = np.float32(1.0 / 63.0), np.float32(0.75 / 2047.0)
TO_X, TO_Y, OF_COMPONENT, OF_OFFSET = np.int32(19), np.int32(12), np.int32(25), np.int32(20)
RIGHT = np.uint64(32)

STRAIGHT = 0.5  # of a surface around a beam's end, squared length of its tangent: less is no line
AGREE = np.float32(0.7)  # cosine of the angle between two normals of one surface
# Ends this far (cells) off the line through their surfels count half; so do surfels of this many beams.
APART = np.float32(1.0 / 0.2**2)
FEW = np.float32(10.0)


@njit(cache=True, error_model="numpy")
def write_surfels(surfels, corner, resolution, points, laser, ends, psi):
    """Take the ends of one scan into the surfels of their cells; lone ends and those on round things stay out.

    points: (n, 2) in the stabilised frame in the order of the sweep, whose heading in the map is psi. laser: (2,)
    and ends: (n, 2) the same points in the map, metres. A surfel that another surface contradicts loses a beam,
    and once it has none is replaced.
    """
    n = len(points)
    xs, ys = points[:, 0].copy(), points[:, 1].copy()
    along_x, along_y = np.empty_like(xs), np.empty_like(xs)
    tangents(xs, ys, along_x, along_y)
    where, lines = np.empty(n, np.int64), np.empty((3, n), np.float32)
    rows, columns = surfels.shape
    _lines((along_x, along_y), ends.reshape(-1), laser, psi, (rows, columns), corner, resolution, where, lines)
    flat, k = surfels.reshape(-1), 0
    while k < n:
        here, beams, x, y, offset = where[k], ZERO, ZERO, ZERO, ZERO
        while k < n and where[k] == here:  # beams that follow each other into a cell join it together
            beams, x, y, offset = beams + ONE, x + lines[0, k], y + lines[1, k], offset + lines[2, k]
            k += 1
        if here >= 0:
            flat[here] = _joined(flat[here], beams, x / beams, y / beams, offset / beams)


@njit(**INNER)
def _lines(along, ends, laser, psi, shape, corner, resolution, where, lines):
    """Of n ends (2n,) the cells, -1 for those that stay out, and `lines` (3, n): normals, offsets; no branch."""
    (along_x, along_y), (rows, columns) = along, shape
    n, inverse, flat = len(where), 1.0 / resolution, lines.reshape(-1)
    c, s, left, low = math.cos(psi), math.sin(psi), corner[0], corner[1]
    for k in range(n):
        ax, ay = np.float64(get(along_x, k)), np.float64(get(along_y, k))
        x, y = get(ends, 2 * k), get(ends, 2 * k + 1)
        straight = ax * ax + ay * ay
        nx, ny = -(s * ax + c * ay), c * ax - s * ay
        away = nx * (x - laser[0]) + ny * (y - laser[1])
        length = math.sqrt(max(straight, STRAIGHT))
        length = length if away < 0.0 else -length
        nx, ny = nx / length, ny / length
        u, v = x * inverse, y * inverse
        floor_u, floor_v = np.floor(u), np.floor(v)
        column, row = whole(floor_u) - left, whole(floor_v) - low
        counts = (straight >= STRAIGHT) & (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
        put(where, k, row * columns + column if counts else -1)
        put_too(flat, k, np.float32(nx))
        put_too(flat, n + k, np.float32(ny))
        put_too(flat, 2 * n + k, np.float32(nx * (u - floor_u - 0.5) + ny * (v - floor_v - 0.5)))


@njit(**INNER)
def _joined(word, beams, nx, ny, offset):
    """A surfel with more beams in it, whose mean normal and offset are given."""
    n, old_x, old_y, old = unpacked(np.int32(word))
    if n == ZERO or old_x * nx + old_y * ny < AGREE:
        if n > beams:
            return word - np.uint32(beams)
        n, old_x, old_y, old, beams = ZERO, nx, ny, offset, beams - n
    count = min(n + beams, LAST)
    share = beams / max(count, ONE)
    nx, ny = old_x + (nx - old_x) * share, old_y + (ny - old_y) * share
    length = max(np.sqrt(nx * nx + ny * ny), HALF)
    return _packed(count, nx / length, ny / length, old + (offset - old) * share)


@njit(inline="always")
def four_around(surfels, k, columns):
    """The words of cells k and k + 1, and of those in the next row."""
    low, high = pair(surfels, k), pair(surfels, k + columns)
    return np.int32(low), np.int32(low >> RIGHT), np.int32(high), np.int32(high >> RIGHT)


@njit(inline="always")
def unpacked(word: Any) -> tuple[Any, Any, Any, Any]:
    """Beams, normal, and offset in cells, of the word as an int32, or of an array of them in numpy."""
    return (
        np.float32(np.int32(word & COUNT)),
        np.float32(np.int32(np.int32(word << TO_X) >> OF_COMPONENT)) * COMPONENT,
        np.float32(np.int32(np.int32(word << TO_Y) >> OF_COMPONENT)) * COMPONENT,
        np.float32(np.int32(word >> OF_OFFSET)) * OFFSET,
    )


@njit(inline="always")
def _packed(n, nx, ny, offset):
    x, y = np.int32(np.floor(nx * IN_COMPONENTS + HALF)) & 127, np.int32(np.floor(ny * IN_COMPONENTS + HALF)) & 127
    far = np.int32(np.floor(min(max(offset * IN_OFFSETS, -MOST), MOST) + HALF)) & 4095
    return np.uint32(np.int32(n) | x << 6 | y << 13 | far << 20)


@njit(cache=True, error_model="numpy")
def settle(level, halves, pose, matched, weight, unobservable):
    """Move a matched pose (3,) to where the beams' ends lie on the surfels too, at most a cell on.

    Minimises (xi - pose)^T H (xi - pose) + weight sum_i w_i r_i^2 by Gauss-Newton, where r_i is the distance in
    cells of end i from the mean line of the surfels in the four cells around it that look at the robot. Each step
    takes one of `halves` (xs, ys), every other beam: neighbours carry nearly the same information.
    level: a `Level` of surfels. matched: (6,) upper entries of H of the match. unobservable: as in `gauss_newton`.
    """
    settled, inverse = pose.copy(), level.inverse
    m00, m01, m02, m11, m12, m22 = matched
    weight *= len(halves)
    k, kk = weight * inverse, weight * inverse * inverse
    for xs, ys in halves:
        h00, h01, h02, h11, h12, h22, b0, b1, b2 = normal_equations(level, xs, ys, settled)
        e0, e1, e2 = pose[0] - settled[0], pose[1] - settled[1], pose[2] - settled[2]
        dx, dy, dpsi, solved = solve3(
            *without(
                unobservable,
                m00 + kk * h00,
                m01 + kk * h01,
                m02 + k * h02,
                m11 + kk * h11,
                m12 + k * h12,
                m22 + weight * h22,
                k * b0 + m00 * e0 + m01 * e1 + m02 * e2,
                k * b1 + m01 * e0 + m11 * e1 + m12 * e2,
                weight * b2 + m02 * e0 + m12 * e1 + m22 * e2,
            )
        )
        if not solved:
            return
        settled[0], settled[1], settled[2] = settled[0] + dx, settled[1] + dy, settled[2] + dpsi
    if math.hypot(settled[0] - pose[0], settled[1] - pose[1]) * inverse < 1.0:
        assign(pose, settled)


@njit(cache=True, error_model="numpy")
def normal_equations(level, xs, ys, pose):
    """The six upper entries and the right side of what `settle` minimises, in cells and radians."""
    frame, surfels = in_lattice(level, pose), level.cells
    flat, columns, room = surfels.reshape(-1), surfels.shape[1], min(TOGETHER, len(xs))
    where, words, arms = np.empty(room, np.uint32), np.empty((4, room), np.int32), np.empty((2, room), np.float32)
    h00 = h01 = h02 = h11 = h12 = h22 = b0 = b1 = b2 = ZERO
    for begin in range(0, len(xs), TOGETHER):
        n = min(TOGETHER, len(xs) - begin)
        place(xs, ys, begin, n, frame, columns, where, (arms[0], arms[1]))
        _fetch(flat, columns, where, n, words[0], words[1], words[2], words[3])
        s00, s01, s02, s11, s12, s22, t0, t1, t2 = _add_up(
            words[0], words[1], words[2], words[3], arms[0], arms[1], n, frame.shift, frame.box
        )
        h00, h01, h02, h11, h12, h22 = h00 + s00, h01 + s01, h02 + s02, h11 + s11, h12 + s12, h22 + s22
        b0, b1, b2 = b0 + t0, b1 + t1, b2 + t2
    return h00, h01, h02, h11, h12, h22, b0, b1, b2


@njit(**INNER)
def _fetch(surfels, columns, where, n, first, right, above, across):
    """The four surfels around each end, one by one, as `gauss_newton` fetches its cells."""
    for i in range(n):
        k = np.int64(where[i])
        low, high = pair(surfels, k), pair(surfels, k + columns)
        first[i], right[i] = np.int32(low), np.int32(low >> RIGHT)
        above[i], across[i] = np.int32(high), np.int32(high >> RIGHT)


@njit(fastmath=True, **INNER)
def _add_up(first, right, above, across, arm_u, arm_v, n, shift, box):
    """The sums over n beams, in cells and radians."""
    first_u, last_u, first_v, last_v = box
    h00 = h01 = h02 = h11 = h12 = h22 = b0 = b1 = b2 = ZERO
    for i in range(n):
        j = np.int32(i)
        pu, pv = get(arm_u, j), get(arm_v, j)
        u, v = pu + shift[0], pv + shift[1]
        fu = u - np.floor(min(max(u, first_u), last_u))
        fv = v - np.floor(min(max(v, first_v), last_v))
        n0, x0, y0, r0 = _seen(get(first, j), fu, fv, pu, pv)
        n1, x1, y1, r1 = _seen(get(right, j), fu - ONE, fv, pu, pv)
        n2, x2, y2, r2 = _seen(get(above, j), fu, fv - ONE, pu, pv)
        n3, x3, y3, r3 = _seen(get(across, j), fu - ONE, fv - ONE, pu, pv)
        beams = n0 + n1 + n2 + n3
        share = ONE / max(beams, ONE)
        nx, ny = (x0 + x1 + x2 + x3) * share, (y0 + y1 + y2 + y3) * share
        r = (r0 + r1 + r2 + r3) * share
        weight = beams / ((beams + FEW) * (ONE + APART * r * r))
        turned = ny * pu - nx * pv
        wx, wy, wp = weight * nx, weight * ny, weight * turned
        h00 += wx * nx
        h01 += wx * ny
        h02 += wx * turned
        h11 += wy * ny
        h12 += wy * turned
        h22 += wp * turned
        b0 += wx * r
        b1 += wy * r
        b2 += wp * r
    return h00, h01, h02, h11, h12, h22, b0, b1, b2


@njit(inline="always")
def _seen(word, fu, fv, pu, pv):
    """Beams of a surfel, and its normal and the distance to it times that; zeros where it looks away."""
    n, nx, ny, offset = unpacked(word)
    n = n if nx * pu + ny * pv < ZERO else ZERO
    return n, n * nx, n * ny, n * (offset - nx * fu - ny * fv)
