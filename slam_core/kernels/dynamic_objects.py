"""What moved: occupied cells that beams pass, and beams that end in the midst of free space."""

import math

import numpy as np
from numba import njit

from slam_core.kernels import INNER
from slam_core.kernels.bilinear import UNKNOWN
from slam_core.kernels.correlative import cells_at
from slam_core.kernels.map_update import cells_of, derive_cell
from slam_core.kernels.memory import alias_scope, lowest, occupied, prefetch

get, _ = alias_scope(0)
_, put = alias_scope(1)
_, put_too = alias_scope(2)

BINS = 720  # of half a degree each
BIN = 2.0 * math.pi / BINS
# atan(t) / t for |t| <= 1 as a sum of even powers, the largest error 1e-5 (Abramowitz and Stegun, 4.4.49); twice
# that, in bins.
A1, A3, A5, A7, A9 = 0.9998660, -0.3302995, 0.1801410, -0.0851330, 0.0208351
UNSURE = 2e-5 / BIN
MANY = 512  # cells whose directions are worked out together
BLOCK = 32  # cells that `occupied` looks at together: nearly all are free or unknown
AHEAD = 4  # rows that are fetched meanwhile
NONE, ONE = np.uint32(0), np.uint32(1)
NEAR = 0.75  # of the way to a cell: beams that end sooner met something else, at an edge that hides part of it


@njit(cache=True, error_model="numpy")
def by_bearing(laser, ends):
    """(n,) metres from the laser to the ends (n, 2), by bin of bearings; where bins begin; their longest; a box.

    A bin without an end has -1 for its longest. The box, lowest and highest coordinates (2, 2), holds every place
    that a beam or its bin passes.
    """
    n, box, furthest = len(ends), np.empty((2, 2)), 0.0
    away, distances, places = np.empty((n, 2)), np.empty(n), np.empty(n)
    for k in range(n):
        away[k, 0], away[k, 1] = ends[k, 0] - laser[0], ends[k, 1] - laser[1]
    _polar(away.reshape(-1), n, distances, places)
    bins, begin, longest = np.empty(n, np.int64), np.zeros(BINS + 1, np.int64), np.full(BINS, -1.0)
    for j in range(2):
        box[0, j] = box[1, j] = laser[j]
    for k in range(n):
        b = _bin(away[k, 0], away[k, 1], places[k])
        bins[k], longest[b], furthest = b, max(longest[b], distances[k]), max(furthest, distances[k])
        begin[b + 1] += 1
        for j in range(2):
            box[0, j], box[1, j] = min(box[0, j], ends[k, j]), max(box[1, j], ends[k, j])
    for j in range(2):
        box[0, j] -= BIN * furthest
        box[1, j] += BIN * furthest
    for b in range(BINS):
        begin[b + 1] += begin[b]
    lengths, filled = np.empty(n), begin[:-1].copy()
    for k in range(n):
        lengths[filled[bins[k]]] = distances[k]
        filled[bins[k]] += 1
    return lengths, begin, longest, box


@njit(**INNER)
def _polar(away, n, distances, places):
    """Metres from the laser to the first n of what lies `away` (n, 2), flat, and their `_place`; no branch."""
    for k in range(n):
        dx, dy = get(away, 2 * k), get(away, 2 * k + 1)
        put(distances, k, math.sqrt(dx * dx + dy * dy))
        put_too(places, k, _place(dx, dy))


@njit(cache=True, error_model="numpy")
def clear_passed(grid, corner, resolution, known, laser, beams, clearing, tiles):
    """Lower every occupied cell that is passed to the cap at most and by the free step, and remove its surfel.

    grid: log_odds, cells, and surfels, as many as cells or none at all. clearing, tiles: the fields of `Clearing`
    and `Tiles`. known: row0, row1, column0, column1 (half open). beams: as of `by_bearing`. A cell is
    passed if beams of its bearing end `behind` metres behind it, and none of them, nor of those beside it, ends
    close by: a wall that is met at a slant, or an edge. Returns how many were.
    """
    (log_odds, cells, surfels), (lengths, begin, longest, box) = grid, beams
    behind, most, free = clearing
    revisions, shift, revision = tiles
    (left, right), (low, high) = cells_of(box, corner, resolution)
    first, row = max(known[2], left), max(known[0], low)
    last, end = max(first, min(known[3], right + 1)), min(known[1], high + 1)
    room = MANY + cells.shape[1]
    us, vs = np.empty(room, np.int32), np.empty(room, np.int32)
    away, distances, places = np.empty((room, 2)), np.empty(room), np.empty(room)
    candidates = np.empty(room + 1, np.int32)
    most, free = np.float32(most), np.float32(free)
    passed = 0
    while row < end:
        n, row = _occupied(cells, row, end, first, last, us, vs)
        _centres(us, vs, n, corner, resolution, laser, away.reshape(-1))
        _polar(away.reshape(-1), n, distances, places)
        for i in range(_before_an_end(distances, places, n, longest, behind, candidates)):
            k = candidates[i]
            u, v = us[k], vs[k]
            if _is_passed(_bin(away[k, 0], away[k, 1], places[k]), distances[k], lengths, begin, behind):
                value = min(log_odds[v, u], most) + free
                log_odds[v, u] = value
                cells[v, u] = derive_cell(value)
                revisions[v >> shift, u >> shift] = revision
                if len(surfels) > 0:
                    surfels[v, u] = NONE
                passed += 1
    return passed


@njit(**INNER)
def _occupied(cells, row, end, first, last, us, vs):
    """Columns and rows of the occupied cells from a row on, until there are many: how many, and the next row."""
    columns, flat, n = cells.shape[1], cells.reshape(-1), 0
    whole = last - (last - first) % BLOCK
    while row < end and n < MANY:
        below = min(row + AHEAD, end - 1) * columns
        for begin in range(first, whole, BLOCK):
            prefetch(flat, below + begin)
            found = occupied(flat, row * columns + begin)
            while found != NONE:
                us[n], vs[n] = begin + np.int64(lowest(found)), row
                n += 1
                found &= found - ONE
        for column in range(whole, last):
            if get(flat, row * columns + column) > UNKNOWN:
                us[n], vs[n] = column, row
                n += 1
        row += 1
    return n, row


@njit(**INNER)
def _centres(us, vs, n, corner, resolution, laser, away):
    """Of n cells, seen from the laser, into `away` (n, 2), flat."""
    left, low, x, y = corner[0] + 0.5, corner[1] + 0.5, laser[0], laser[1]
    for k in range(n):
        put(away, 2 * k, (get(us, k) + left) * resolution - x)
        put(away, 2 * k + 1, (get(vs, k) + low) * resolution - y)


@njit(**INNER)
def _before_an_end(distances, places, n, longest, behind, found):
    """Into `found` those of n cells with a beam in their bin that ends behind them, or of an unsure bin: how many.

    Few do, and a branch would be mispredicted.
    """
    m = 0
    for k in range(n):
        place = places[k]
        b = np.int64(np.floor(place))
        b += BINS if b < 0 else 0
        found[m] = k
        m += (longest[b] > distances[k] + behind) | (abs(place - np.floor(place + 0.5)) < UNSURE)
    return m


@njit(inline="always")
def _is_passed(b, distance, lengths, begin, behind):
    reach = _nearest(lengths, begin, b, NEAR * distance)
    if distance + behind < reach < np.inf:
        for beside in ((b + 1) % BINS, (b - 1) % BINS):
            reach = min(reach, _nearest(lengths, begin, beside, NEAR * distance))
    return distance + behind < reach < np.inf


@njit(inline="always")
def _nearest(lengths, begin, b, least):
    """The shortest way of a bin's beams that end further than `least` metres away; inf without one."""
    nearest = np.inf
    for k in range(begin[b], begin[b + 1]):
        if lengths[k] > least:
            nearest = min(nearest, lengths[k])
    return nearest


@njit(cache=True, error_model="numpy")
def ends_in_free_space(cells, corner, resolution, points, pose, around, found):
    """Which points (n, 2) of a scan at `pose` (3,) lie in a free cell, no occupied one within `around` cells.

    found: (n,) takes the answers.
    """
    (rows, columns), flat, where = cells.shape, cells.reshape(-1), np.empty(len(points), np.int32)
    cells_at(rows, columns, corner, 1.0 / resolution, points.reshape(-1), pose, around, where)
    for k in range(len(points)):
        free = where[k] >= 0 and flat[where[k]] < UNKNOWN
        found[k] = free and not _near_occupied(flat, columns, where[k], around)


@njit(inline="always")
def _near_occupied(cells, columns, i, around):
    for row in range(-around, around + 1):
        first = i + row * columns - around
        for j in range(first, first + 2 * around + 1):
            if cells[j] > UNKNOWN:
                return True
    return False


@njit(inline="always")
def _place(dx, dy):
    """The bearing in bins from -BINS / 2 to BINS / 2, nearly: the library's arc tangent is a call.

    No more than half a bin beyond, and also for a direction that is no number.
    """
    x, y = abs(dx), abs(dy)
    t = min(x, y) / max(x, y, 1e-9)
    angle = t * (A1 + t * t * (A3 + t * t * (A5 + t * t * (A7 + t * t * A9))))
    angle = 0.5 * math.pi - angle if y > x else angle
    angle = math.pi - angle if dx < 0.0 else angle
    return min(BINS / 2 + 0.5, max(-BINS / 2 - 0.5, (-angle if dy < 0.0 else angle) / BIN))


@njit(inline="always")
def _bin(dx, dy, place):
    """The bin of a direction with its `_place`; near an edge the arc tangent itself decides, if it is a number."""
    if abs(place - np.floor(place + 0.5)) < UNSURE:
        place = max(-BINS / 2, math.atan2(dy, dx) / BIN)
    b = np.int64(np.floor(place))
    return b if b >= 0 else b + BINS
