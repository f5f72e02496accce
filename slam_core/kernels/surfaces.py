"""The surfaces that a scan saw, from the neighbours of each endpoint, and how well they fix the position."""

import math

import numpy as np
from numba import njit

from slam_core.kernels import INNER
from slam_core.kernels.memory import alias_scope

get, _ = alias_scope(0)
_, put = alias_scope(1)

# Surface on either side of an endpoint that gives its direction: enough of it that the noise of the ranges does
# not turn it. In picometres, as whole numbers are compared sooner than others; or this many neighbours: where
# beams graze a wall these lie metres apart.
REACH = 500_000_000_000
NEIGHBOURS = 3
FEWEST = 4  # endpoints that make a surface
# Neighbours this near (metres) lie on one surface; and further ones, where two steps from one to the next go the
# same way (cosine of the angle between them), and differ by no more than this factor or meet so near the straight
# line through their other ends (metres): beams without an echo leave gaps of all lengths in a wall. The noise of
# the ranges gives a step that is shorter than the last number (metres) any direction.
GAP = 0.3
STRAIGHT = 0.95
GROWTH = 2.5
FLAT = 0.02
DIRECTED = 0.06
# A spread across the surface this share of the one along it, or more, makes it no line at all, but for the noise
# of the ranges (metres).
ROUND = 1.0 / 9.0
NOISE = 0.02
ORIGIN = (0.0, 0.0)
# Radians between beams from which on a scanner counts as coarse: one with a beam a degree does.
COARSE = math.radians(0.9)
COS_OPEN = math.cos(0.2)  # of the angle, radians, between two endpoints between which nothing is seen


@njit(cache=True, error_model="numpy")
def tangents(xs, ys, along_x, along_y):
    """Unit vectors along the surface, times the root of how straight it is; zero for a lone or round one.

    xs, ys: (n,) endpoints in the order of the sweep.
    """
    n = len(xs)
    first, end = np.empty(n, np.int32), np.empty(n, np.int32)
    _neighbours(xs, ys, first, end)
    sums = np.zeros((5, n + 1))
    sx = sy = sxx = sxy = syy = 0.0
    for i in range(n):
        x, y = float(xs[i]), float(ys[i])
        sx, sy, sxx, sxy, syy = sx + x, sy + y, sxx + x * x, sxy + x * y, syy + y * y
        sums[0, i + 1], sums[1, i + 1], sums[2, i + 1], sums[3, i + 1], sums[4, i + 1] = sx, sy, sxx, sxy, syy
    _directions(sums[0], sums[1], sums[2], sums[3], sums[4], first, end, along_x, along_y)


@njit(cache=True, error_model="numpy")
def between(points, step, longest):
    """(m, 2) points on the straight surface between neighbours of points (n, 2) that lie on it.

    They divide gaps longer than `step` and no longer than `longest` evenly, in parts no longer than a step.
    The gap and the gaps beside it must go on straight, in even steps: four neighbours on one line.
    """
    n, m = len(points), 0
    parts = np.zeros(n, np.int64)
    straight_before = False
    for i in range(2, n):
        dx, dy = points[i, 0] - points[i - 1, 0], points[i, 1] - points[i - 1, 1]
        ux, uy = points[i - 1, 0] - points[i - 2, 0], points[i - 1, 1] - points[i - 2, 1]
        gap, before = math.sqrt(dx * dx + dy * dy), math.sqrt(ux * ux + uy * uy)
        straight = max(gap, before) <= GROWTH * min(gap, before) and dx * ux + dy * uy >= STRAIGHT * gap * before
        if straight and straight_before and step < before <= longest:
            parts[i - 1] = np.int64(math.ceil(before / step))
            m += parts[i - 1] - 1
        straight_before = straight
    found, k = np.empty((m, 2), points.dtype), 0
    for i in range(1, n):
        for j in range(1, parts[i]):
            share = j / parts[i]
            found[k, 0] = points[i - 1, 0] + share * (points[i, 0] - points[i - 1, 0])
            found[k, 1] = points[i - 1, 1] + share * (points[i, 1] - points[i - 1, 1])
            k += 1
    return found


@njit(cache=True, error_model="numpy")
def is_coarse(points, laser):
    """Whether more than half of the endpoints (n, 2) are COARSE or more from the one before, as the laser sees it.

    laser: (2,). Metres.
    """
    coarse, limit = 0, math.tan(COARSE)
    for i in range(1, len(points)):
        x0, y0, x1, y1 = _from(points[i - 1], laser) + _from(points[i], laser)
        coarse += abs(x0 * y1 - y0 * x1) > limit * (x0 * x1 + y0 * y1)  # always so above a right angle
    return 2 * coarse > max(len(points) - 1, 0)


@njit(inline="always")
def _from(point, laser):
    return point[0] - laser[0], point[1] - laser[1]


@njit(cache=True, error_model="numpy")
def foreground(points, gap, extent, fewest, beside, sees_past):
    """(n,) which endpoints (n, 2), in the order of the sweep, are on an object that stands before what is around.

    An object is `fewest` endpoints or more, none further than `gap` from the next, in a box with a diagonal below
    `extent`; it is nearer than what is seen on both sides of it, by more than `gap`. At an end of the scan, where
    half of it may be out of view, it is nearer than what is seen on one side, and than `beside`. sees_past: where
    nothing returns beside it, the laser sees as far as to the farthest endpoint. Metres.
    """
    n, begin = len(points), 0
    found, farthest = np.zeros(n, np.bool_), _farthest(points) if sees_past else 0.0
    for end in range(1, n + 1):
        if end < n and _distance(points[end], points[end - 1]) <= gap:
            continue
        if fewest <= end - begin < n + sees_past and _diagonal(points[begin:end]) < extent:
            before = _seen(points[begin - 1], points[begin], farthest) if begin > 0 else beside + gap
            after = _seen(points[end], points[end - 1], farthest) if end < n else beside + gap
            first, last = _distance(points[begin], ORIGIN), _distance(points[end - 1], ORIGIN)
            found[begin:end] = min(before - first, after - last) > gap
        begin = end
    return found


@njit(inline="always")
def _seen(neighbour, point, farthest):
    """How far one sees beside an endpoint: to its neighbour, or to the farthest if nothing is between the two."""
    away = _distance(neighbour, ORIGIN)
    along = np.float64(point[0]) * neighbour[0] + np.float64(point[1]) * neighbour[1]
    is_open = along < COS_OPEN * away * _distance(point, ORIGIN)
    return max(away, farthest) if is_open else away


@njit(inline="always")
def _farthest(points):
    """The distance of the farthest of points (n, 2)."""
    square = 0.0
    for i in range(len(points)):
        x, y = np.float64(points[i, 0]), np.float64(points[i, 1])
        square = max(square, x * x + y * y)
    return math.sqrt(square)


@njit(inline="always")
def _distance(a, b):
    return math.hypot(np.float64(a[0]) - b[0], np.float64(a[1]) - b[1])


@njit(inline="always")
def _diagonal(points):
    """Of the box around points (n, 2)."""
    xs, ys = points[:, 0], points[:, 1]
    return math.hypot(np.float64(xs.max()) - xs.min(), np.float64(ys.max()) - ys.min())


@njit(cache=True, error_model="numpy")
def weakest_direction(xs, ys, along_x, along_y):
    """How the shape of a scan fixes its position: the share of beams that do in the worst direction, and that.

    J_i = (I - a a^T) [I | e_z x p_i] is what beam i on a surface along a observes of x, y, psi, as in a match of
    points to lines; sum J_i^T J_i without what may be a turn has the smallest eigenvalue n times the share. The
    map has no part in it: the texture of its cells is no landmark. (Censi 2009; Zhang, Kaess, Singh 2016.)
    """
    xx = xy = yy = xp = yp = pp = 0.0
    for i in range(len(xs)):
        ax, ay = along_x[i], along_y[i]
        k = 2.0 - ax * ax - ay * ay
        a, b, c = 1.0 - k * ax * ax, -k * ax * ay, 1.0 - k * ay * ay
        u, v = b * xs[i] - a * ys[i], c * xs[i] - b * ys[i]
        xx, xy, yy = xx + a, xy + b, yy + c
        xp, yp, pp = xp + u, yp + v, pp + xs[i] * v - ys[i] * u
    if pp > 0.0:
        xx, xy, yy = xx - xp * xp / pp, xy - xp * yp / pp, yy - yp * yp / pp
    smallest = 0.5 * (xx + yy - math.hypot(xx - yy, 2.0 * xy))
    angle = 0.5 * math.atan2(2.0 * xy, xx - yy)
    return smallest / max(len(xs), 1), -math.sin(angle), math.cos(angle)


@njit(cache=True, error_model="numpy")
def _neighbours(xs, ys, first, end):
    """The endpoints on the surface around each: from `first` up to before `end`.

    There is no branch on where a surface ends: it would be mispredicted.
    """
    n = len(xs)
    joined, way = np.empty(n, np.uint8), np.zeros(n + 1, np.int64)
    _join(xs, ys, joined, way)
    i = low = here = behind = 0
    while i < n:  # either is one further after each round
        far, next_here, next_behind = here - behind > REACH, way[i + 1], way[low + 1]
        first[i], end[low] = low, i
        here, behind = here if far else next_here, next_behind if far else behind
        low, i = low + far, i + (not far)
    for i in range(low, n):
        end[i] = n
    begin, stop = 0, n
    for i in range(n):
        begin = begin if joined[i] else i
        first[i] = max(min(first[i], i - NEIGHBOURS), begin)
    for i in range(n - 1, -1, -1):
        end[i] = min(max(end[i], i + 1 + NEIGHBOURS), stop)
        stop = stop if joined[i] else i


@njit(**INNER)
def _join(xs, ys, joined, way):
    """Which of n endpoints lie on one surface with the one before, and the way (n + 1,) along them, picometres."""
    n = len(xs)
    steps, straight = np.zeros(n), np.zeros(n + 1, np.uint8)
    for i in range(1, n):
        dx, dy = get(xs, i) - get(xs, i - 1), get(ys, i) - get(ys, i - 1)
        put(steps, i, math.sqrt(dx * dx + dy * dy))
    for i in range(2, n):  # from the endpoints again: what one alias scope has stored, another may not load
        dx, dy = get(xs, i) - get(xs, i - 1), get(ys, i) - get(ys, i - 1)
        ux, uy = get(xs, i - 1) - get(xs, i - 2), get(ys, i - 1) - get(ys, i - 2)
        step, before = math.sqrt(dx * dx + dy * dy), math.sqrt(ux * ux + uy * uy)
        flat = (dx * uy - dy * ux) ** 2 <= FLAT * FLAT * ((dx + ux) ** 2 + (dy + uy) ** 2)
        longer, shorter = max(step, before), min(step, before)
        even = (longer <= GROWTH * shorter) | (flat & (shorter >= DIRECTED))
        put(straight, i, np.uint8(even & (dx * ux + dy * uy >= STRAIGHT * step * before)))
    for i in range(n):
        joined[i] = (steps[i] <= GAP) | straight[i] | straight[i + 1]
    for i in range(1, n):
        way[i] = way[i - 1] + np.int64(min(1.0, steps[i]) * 1e12)


@njit(fastmath=True, **INNER)
def _directions(sx, sy, sxx, sxy, syy, first, end, along_x, along_y):
    """The long axis of the scatter of the endpoints around each, shortened by its roundness; without branches."""
    for i in range(len(first)):
        j = np.int32(i)
        a, b = get(first, j), get(end, j)
        share = 1.0 / (b - a)
        mx, my = (get(sx, b) - get(sx, a)) * share, (get(sy, b) - get(sy, a)) * share
        xx = (get(sxx, b) - get(sxx, a)) * share - mx * mx
        xy = (get(sxy, b) - get(sxy, a)) * share - mx * my
        yy = (get(syy, b) - get(syy, a)) * share - my * my
        difference = math.sqrt((xx - yy) * (xx - yy) + 4.0 * xy * xy)
        long, short = 0.5 * (xx + yy + difference), 0.5 * (xx + yy - difference)
        straight = 1.0 - max(short - NOISE * NOISE, 0.0) / (ROUND * long + 1e-12)
        straight = max(straight, 0.0) if b - a >= FEWEST else 0.0
        double = (xx - yy) / (difference + 1e-12)  # cosine of twice the direction
        put(along_x, j, np.float32(math.sqrt(0.5 * straight * (1.0 + double))))
        put(along_y, j, np.float32(math.copysign(math.sqrt(0.5 * straight * (1.0 - double)), xy)))
