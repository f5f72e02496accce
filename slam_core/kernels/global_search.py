"""The loops of the search over a whole map: bounds for blocks of poses, then the poses of the promising blocks.

For one heading a scan is a list of whole-cell offsets, so the scores of neighbouring places are sums of shifted
pictures of the map. Eight-bit sums over contiguous rows become a few instructions for 64 places each.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from slam_core.kernels import INNER
from slam_core.measurements import Float64s, Int64s

WALL = np.uint8(2)  # score of an endpoint on a wall; beside one it scores 1
MANY = 8192  # candidates that are kept at most
SUM = 16  # additions of a picture that take as long as one look at a cell


class Pictures(NamedTuple):
    """Scores of an endpoint, by cell (rows, columns), and the largest in a block of them.

    blocks: (block, block, rows + 1, columns + 1), [pv, pu, r + 1, c + 1] is that of the block whose first cell is
    [block r + pv, block c + pu]. inverse: cells a metre.
    """

    cells: NDArray[np.uint8]
    blocks: NDArray[np.uint8]
    inverse: float


class Headings(NamedTuple):
    """psi: (h,) radians. limits: (h,) the largest score that is possible. order: (h,) by falling limit."""

    psi: Float64s
    limits: Int64s
    order: Int64s


@njit(cache=True, nogil=True, error_model="numpy")
def offsets(points, inverse, psi, out):
    """Columns and rows (n, 2) from a place to the endpoints (n, 2), metres, seen from there at heading psi."""
    c, s = math.cos(psi) * inverse, math.sin(psi) * inverse
    for k in range(len(points)):
        out[k, 0] = math.floor(c * points[k, 0] - s * points[k, 1] + 0.5)
        out[k, 1] = math.floor(s * points[k, 0] + c * points[k, 1] + 0.5)


@njit(cache=True, nogil=True, error_model="numpy")
def block_bounds(pool, shifts, first_row, first_column, out):
    """For one heading: no place in block [first_row + i, first_column + j] scores more than out[i, j]."""
    block, _, rows, columns = pool.shape
    rows, columns = rows - 1, columns - 1
    high, wide = out.shape
    out[:] = 0
    flat, sums = pool.reshape(-1), out.reshape(-1)
    for k in range(len(shifts)):
        c, pu = divmod(shifts[k, 0], block)
        r, pv = divmod(shifts[k, 1], block)
        c, r = c + first_column, r + first_row
        first, last = max(0, -1 - c), min(wide, columns - c)
        picture = ((pv * block + pu) * (rows + 1) + r + 1) * (columns + 1) + c + 1
        for row in range(max(0, -1 - r), min(high, rows - r)):
            _add(sums, row * wide + first, flat, picture + row * (columns + 1) + first, last - first)


@njit(inline="always")
def _add(sums, i, cells, j, n):
    for k in range(n):
        sums[np.uint64(i + k)] += cells[np.uint64(j + k)]


@njit(cache=True, nogil=True, error_model="numpy")
def place_score(cells, shifts, column, row, least):
    """Sum of the cells that the endpoints meet; -1 as soon as it cannot reach `least` any more."""
    rows, columns = cells.shape
    spare = 2 * len(shifts) - least
    lost = 0
    for k in range(len(shifts)):
        u, v = column + shifts[k, 0], row + shifts[k, 1]
        inside = 0 <= u < columns and 0 <= v < rows
        lost += 2 - cells[v, u] if inside else 2
        if lost > spare:
            return -1
    return 2 * len(shifts) - lost


@njit(cache=True, nogil=True, error_model="numpy")
def heading_bounds(pool, points, inverse, headings, box, out):
    """The largest possible score in a box of blocks (first row, first column, rows, columns), into `out` (h,)."""
    shifts = np.empty((len(points), 2), np.int64)
    bounds = np.empty((box[2], box[3]), np.uint8)
    for h in range(len(headings)):
        offsets(points, inverse, headings[h], shifts)
        block_bounds(pool, shifts, box[0], box[1], bounds)
        out[h] = bounds.max()


@njit(cache=True, nogil=True, error_model="numpy")
def best_places(pictures, corner, points, headings, box, share, state, found, work):
    """The best place of every block and heading that scores `least` and `share` of the best of all, or more.

    box: of blocks, first row, first column, rows, columns. state: (5,) where to go on: place in the order of
    headings, row in the box, least, best, count; -1 when there are too many. found: (count, 4) score, heading,
    row, column in the lattice, where pictures begin at `corner`, row and column. Stops when the cells looked at
    exceed `work`; returns how many these were.
    """
    cells, pool, inverse = pictures
    block = pool.shape[0]
    shifts = np.empty((len(points), 2), np.int64)
    bounds = np.empty((box[2], box[3]), np.uint8)
    first, least, best, count = state[1], state[2], state[3], state[4]
    done = 0
    for k in range(state[0], len(headings.order)):
        h = headings.order[k]
        least = max(least, math.ceil(share * best))
        if headings.limits[h] < least:
            break
        offsets(points, inverse, headings.psi[h], shifts)
        block_bounds(pool, shifts, box[0], box[1], bounds)
        done += bounds.size * len(points) // SUM + len(points)
        for row in range(first, box[2]):
            for column in range(box[3]):
                if bounds[row, column] < least:
                    continue
                if count == len(found):
                    count = _keep(found, count, least)
                    if count == len(found):
                        state[4] = -1
                        return done
                r, c = block * (box[0] + row), block * (box[1] + column)
                score = _best_of_block(cells, shifts, r, c, block, least, found[count])
                done += block * block * len(points) // 4
                if score >= least:
                    found[count, 1] = h
                    found[count, 2] += corner[0]
                    found[count, 3] += corner[1]
                    count += 1
                    best = max(best, score)
                    least = max(least, math.ceil(share * best))
            if done > work:
                state[0], state[1], state[2], state[3], state[4] = k, row + 1, least, best, count
                return done
        first = 0
    state[0], state[1], state[2], state[3], state[4] = (
        len(headings.order),
        0,
        least,
        best,
        _keep(found, count, least),
    )
    return done


@njit(nogil=True, **INNER)
def _best_of_block(cells, shifts, row, column, block, least, out):
    """Score, row and column of the first best place in one block, into `out`; the score."""
    best = -1
    for v in range(row, min(row + block, cells.shape[0])):
        for u in range(column, min(column + block, cells.shape[1])):
            score = place_score(cells, shifts, u, v, max(least, best + 1))
            if score > best:
                best = score
                out[0], out[2], out[3] = score, v, u
    return best


@njit(nogil=True, **INNER)
def _keep(found, count, least):
    """Drop the candidates below `least`; how many are left."""
    kept = 0
    for k in range(count):
        if found[k, 0] >= least:
            found[kept] = found[k]
            kept += 1
    return kept


@njit(cache=True, error_model="numpy")
def agreement(cells, first, points, laser, inverse, column, row, psi, slack):
    """Twice the sum over the beams of the cell that each ends in; one that crosses an occupied cell counts half.

    points: (n, 2) endpoints, laser: (2,), in metres in the frame whose origin lies at `column` and `row`, parts of
    a cell included, and whose heading is psi. Crossings in the last `slack` cells of a beam do not count.
    first: row and column of cells[0, 0], not below 0. What lies off the cells is 0.
    """
    c, s = math.cos(psi) * inverse, math.sin(psi) * inverse
    u0, v0 = c * laser[0] - s * laser[1] + column, s * laser[0] + c * laser[1] + row
    total = 0
    for k in range(len(points)):
        u, v = c * points[k, 0] - s * points[k, 1] + column, s * points[k, 0] + c * points[k, 1] + row
        value = 2 * _cell(cells, first, u, v)
        if value:
            long = math.hypot(u - u0, v - v0)
            for step in range(1, int(long - slack)):
                t = step / long
                if _cell(cells, first, u0 + t * (u - u0), v0 + t * (v - v0)) == WALL:
                    value //= 2
                    break
        total += value
    return total


@njit(inline="always")
def _cell(cells, first, u, v):
    (row, column), (rows, columns) = first, cells.shape
    if not (column <= u < column + columns and row <= v < row + rows):
        return np.int64(0)
    return np.int64(cells[int(v) - row, int(u) - column])
