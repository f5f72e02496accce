"""What moved: occupied cells that beams pass, and beams that end in the midst of free space."""

import math

import numpy as np
from numba import njit

from slam_core.kernels.bilinear import UNKNOWN, WHOLE
from slam_core.kernels.mapping import cells_of
from slam_core.kernels.memory import lane

get, _ = lane(0)

BINS = 720  # of half a degree each
BIN = 2.0 * math.pi / BINS
BLOCK = 64  # cells that are looked at together: nearly all are free or unknown
NEAR = 0.75  # of the way to a cell: beams that end sooner met something else, at an edge that hides part of it


@njit(cache=True, error_model="numpy")
def by_bearing(laser, ends):
    """(n,) metres from the laser to the ends (n, 2), by bin of bearings; (BINS + 1,) where each bin begins; a box.

    The box, lowest and highest coordinates (2, 2), holds every place that a beam or its bin passes.
    """
    bins, begin = np.empty(len(ends), np.int64), np.zeros(BINS + 1, np.int64)
    ways, box, longest = np.empty(len(ends)), np.empty((2, 2)), 0.0
    box[:] = laser
    for k in range(len(ends)):
        dx, dy = ends[k, 0] - laser[0], ends[k, 1] - laser[1]
        bins[k], ways[k] = _bin(dx, dy), math.sqrt(dx * dx + dy * dy)
        begin[bins[k] + 1] += 1
        longest = max(longest, ways[k])
        for j in range(2):
            box[0, j], box[1, j] = min(box[0, j], ends[k, j]), max(box[1, j], ends[k, j])
    for j in range(2):
        box[0, j] -= BIN * longest
        box[1, j] += BIN * longest
    for b in range(BINS):
        begin[b + 1] += begin[b]
    lengths, place = np.empty(len(ends)), begin[:-1].copy()
    for k in range(len(ends)):
        lengths[place[bins[k]]] = ways[k]
        place[bins[k]] += 1
    return lengths, begin, box


@njit(cache=True, error_model="numpy")
def doubt_passed(log_odds, cells, corner, resolution, known, laser, lengths, begin, box, behind, most, free):
    """Take `most` log-odds at most and the step `free` from every occupied cell that is passed.

    known: row0, row1, column0, column1 (half open). lengths, begin, box: as of `by_bearing`. A cell is passed if
    beams of its bearing end `behind` metres behind it, and none of them, nor of those beside it, ends close by: a
    wall that is met at a slant, or an edge. Returns how many were.
    """
    columns, flat = cells.shape[1], cells.reshape(-1)
    (left, right), (low, high) = cells_of(box, corner, resolution)
    last, passed = min(known[3], right + 1), 0
    for row in range(max(known[0], low), min(known[1], high + 1)):
        dy = (row + corner[1] + 0.5) * resolution - laser[1]
        for first in range(max(known[2], left), last, BLOCK):
            if first + BLOCK <= last and not _any_occupied(flat, row * columns + first):
                continue
            for column in range(first, min(first + BLOCK, last)):
                if get(flat, row * columns + column) <= UNKNOWN:
                    continue
                dx = (column + corner[0] + 0.5) * resolution - laser[0]
                if _is_passed(dx, dy, lengths, begin, behind):
                    value = min(log_odds[row, column], most) + free
                    log_odds[row, column] = value
                    cells[row, column] = np.uint16(WHOLE / (1.0 + math.exp(-value)) + 0.5)
                    passed += 1
    return passed


@njit(inline="always")
def _any_occupied(cells, first):
    count = np.int32(0)
    for k in range(BLOCK):
        count += np.int32(get(cells, first + k) > UNKNOWN)
    return count > 0


@njit(inline="always")
def _is_passed(dx, dy, lengths, begin, behind):
    distance = math.sqrt(dx * dx + dy * dy)
    b = _bin(dx, dy)
    reach = _nearest(lengths, begin, b, NEAR * distance)
    if distance + behind < reach < np.inf:
        for beside in ((b + 1) % BINS, (b - 1) % BINS):
            reach = min(reach, _nearest(lengths, begin, beside, NEAR * distance))
    return distance + behind < reach < np.inf


@njit(inline="always")
def _nearest(lengths, begin, b, least):
    """The shortest way of a bin's beams that end `least` metres away or further; inf without one."""
    shortest = np.inf
    for k in range(begin[b], begin[b + 1]):
        if lengths[k] > least:
            shortest = min(shortest, lengths[k])
    return shortest


@njit(cache=True, error_model="numpy")
def ends_in_free_space(cells, corner, resolution, points, pose, around, found):
    """Which points (n, 2) of a scan at `pose` (3,) lie in a free cell, no occupied one within `around` cells.

    found: (n,) takes the answers.
    """
    rows, columns = cells.shape
    c, s = math.cos(pose[2]), math.sin(pose[2])
    for k in range(len(points)):
        x, y = np.float64(points[k, 0]), np.float64(points[k, 1])
        u = np.int64(np.floor((c * x - s * y + pose[0]) / resolution)) - corner[0]
        v = np.int64(np.floor((s * x + c * y + pose[1]) / resolution)) - corner[1]
        inside = around <= u < columns - around and around <= v < rows - around
        found[k] = inside and cells[v, u] < UNKNOWN
        if found[k]:
            for row in range(v - around, v + around + 1):
                for column in range(u - around, u + around + 1):
                    if cells[row, column] > UNKNOWN:
                        found[k] = False


@njit(inline="always")
def _bin(dx, dy):
    b = np.int64(np.floor(math.atan2(dy, dx) / BIN))
    return b if b >= 0 else b + BINS
