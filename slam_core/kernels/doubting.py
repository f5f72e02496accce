"""What moved: occupied cells that beams pass, and beams that end in the midst of free space."""

import math

import numpy as np
from numba import njit

from slam_core.kernels.bilinear import WHOLE

BINS = 720  # of half a degree each
BIN = 2.0 * math.pi / BINS
BLOCK = 32  # cells that are looked at together: nearly all are free or unknown
NEAR = 0.75  # of the way to a cell: beams that end sooner met something else, at an edge that hides part of it


@njit(cache=True, error_model="numpy")
def by_bearing(laser, ends):
    """(n,) metres from the laser to the ends (n, 2), by bin of bearings, and (BINS + 1,) where each bin begins."""
    bins, begin = np.empty(len(ends), np.int64), np.zeros(BINS + 1, np.int64)
    for k in range(len(ends)):
        bins[k] = _bin(ends[k, 0] - laser[0], ends[k, 1] - laser[1])
        begin[bins[k] + 1] += 1
    for b in range(BINS):
        begin[b + 1] += begin[b]
    lengths, place = np.empty(len(ends)), begin[:-1].copy()
    for k in range(len(ends)):
        lengths[place[bins[k]]] = math.hypot(ends[k, 0] - laser[0], ends[k, 1] - laser[1])
        place[bins[k]] += 1
    return lengths, begin


@njit(cache=True, error_model="numpy")
def doubt_passed(log_odds, cells, corner, resolution, box, laser, lengths, begin, behind, most, free):
    """Take `most` log-odds at most and the step `free` from every occupied cell that is passed.

    box: row0, row1, column0, column1 (half open). lengths, begin: as of `by_bearing`. A cell is passed if beams of
    its bearing end `behind` metres behind it, and none of them, nor of those beside it, ends close by: a wall that
    is met at a slant, or an edge. Returns how many were.
    """
    passed = 0
    for row in range(box[0], box[1]):
        odds, dy = log_odds[row], (row + corner[1] + 0.5) * resolution - laser[1]
        for first in range(box[2], box[3], BLOCK):
            last = min(first + BLOCK, box[3])
            if not _any_occupied(odds[first:last]):
                continue
            for column in range(first, last):
                dx = (column + corner[0] + 0.5) * resolution - laser[0]
                if odds[column] > 0.0 and _is_passed(dx, dy, lengths, begin, behind):
                    value = min(odds[column], most) + free
                    odds[column] = value
                    cells[row, column] = np.uint16(WHOLE / (1.0 + math.exp(-value)) + 0.5)
                    passed += 1
    return passed


@njit(inline="always")
def _any_occupied(odds):
    count = np.int32(0)
    for i in range(len(odds)):
        count += np.int32(odds[i] > np.float32(0.0))
    return count > 0


@njit(inline="always")
def _is_passed(dx, dy, lengths, begin, behind):
    distance = math.hypot(dx, dy)
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
def ends_in_free_space(log_odds, corner, resolution, ends, around, found):
    """Whether each end (n, 2) lies in a free cell, no occupied one within `around` cells, into `found` (n,)."""
    rows, columns = log_odds.shape
    for k in range(len(ends)):
        u = np.int64(np.floor(ends[k, 0] / resolution)) - corner[0]
        v = np.int64(np.floor(ends[k, 1] / resolution)) - corner[1]
        inside = around <= u < columns - around and around <= v < rows - around
        found[k] = inside and log_odds[v, u] < 0.0
        if found[k]:
            for row in range(v - around, v + around + 1):
                for column in range(u - around, u + around + 1):
                    if log_odds[row, column] > 0.0:
                        found[k] = False


@njit(inline="always")
def _bin(dx, dy):
    return math.floor(math.atan2(dy, dx) / BIN) % BINS
