"""What moved: occupied cells that beams pass, and beams that end in the midst of free space."""

import math

import numpy as np
from numba import njit

from slam_core.kernels.bilinear import WHOLE

BINS = 720  # of half a degree each
BIN = 2.0 * math.pi / BINS
BLOCK = 32  # cells that are looked at together: nearly all are free or unknown
NEAR = 0.75  # of the way to a cell: beams beside it that end sooner met something else


@njit(cache=True, error_model="numpy")
def first_ends(laser, ends):
    """(BINS,) how near the nearest of the ends (n, 2) lies in each bin of bearings around the laser; inf: none."""
    shortest = np.full(BINS, np.inf)
    for k in range(len(ends)):
        dx, dy = ends[k, 0] - laser[0], ends[k, 1] - laser[1]
        b = _bin(dx, dy)
        shortest[b] = min(shortest[b], math.hypot(dx, dy))
    return shortest


@njit(cache=True, error_model="numpy")
def doubt_passed(log_odds, cells, corner, resolution, box, laser, shortest, behind, most, free):
    """Take `most` log-odds at most and the step `free` from every occupied cell that is passed.

    box: row0, row1, column0, column1 (half open). A cell is passed if the beams of its bearing end `behind` metres
    behind it, and none beside it ends close by: a wall that is met at a slant, or an edge. Returns how many were.
    """
    passed = 0
    for row in range(box[0], box[1]):
        odds = log_odds[row]
        for first in range(box[2], box[3], BLOCK):
            last = min(first + BLOCK, box[3])
            if not _any_occupied(odds[first:last]):
                continue
            for column in range(first, last):
                if odds[column] > 0.0 and _is_passed(row, column, corner, resolution, laser, shortest, behind):
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
def _is_passed(row, column, corner, resolution, laser, shortest, behind):
    dx = (column + corner[0] + 0.5) * resolution - laser[0]
    dy = (row + corner[1] + 0.5) * resolution - laser[1]
    distance = math.hypot(dx, dy)
    b = _bin(dx, dy)
    reach = shortest[b]
    for beside in (shortest[(b + 1) % BINS], shortest[(b - 1) % BINS]):
        if beside > NEAR * distance:
            reach = min(reach, beside)
    return distance + behind < reach < np.inf


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
