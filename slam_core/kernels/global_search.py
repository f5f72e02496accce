"""The loops of the search over a whole map: bounds for blocks of poses, then the poses of the promising blocks.

For one heading a scan is a list of whole-cell offsets, so the scores of neighbouring places are sums of shifted
pictures of the map. Eight-bit sums over contiguous rows become a few instructions for 64 places each.
"""

import math

import numpy as np
from numba import njit

WALL = np.uint8(2)  # score of an endpoint on a wall; beside one it scores 1
MANY = 8192  # candidates that are kept at most


@njit(cache=True, nogil=True, error_model="numpy")
def offsets(points, inverse, psi, out):
    """Columns and rows (n, 2) from a place to the endpoints (n, 2), metres, seen from there at heading psi."""
    c, s = math.cos(psi) * inverse, math.sin(psi) * inverse
    for k in range(len(points)):
        out[k, 0] = math.floor(c * points[k, 0] - s * points[k, 1] + 0.5)
        out[k, 1] = math.floor(s * points[k, 0] + c * points[k, 1] + 0.5)


@njit(cache=True, nogil=True, error_model="numpy")
def pooled(cells, block):
    """(block, block, rows + 1, columns + 1): largest cell of the block that begins at each place, by its phase.

    [pv, pu, r + 1, c + 1] is the largest cell of the block whose first is [block r + pv, block c + pu].
    """
    high, wide = cells.shape
    rows, columns = -(-high // block), -(-wide // block)
    out = np.zeros((block, block, rows + 1, columns + 1), np.uint8)
    for v in range(high):
        for u in range(wide):
            value = cells[v, u]
            if value:
                for dv in range(block):
                    for du in range(block):
                        r, pv = divmod(v - dv, block)
                        c, pu = divmod(u - du, block)
                        out[pv, pu, r + 1, c + 1] = max(out[pv, pu, r + 1, c + 1], value)
    return out


@njit(cache=True, nogil=True, error_model="numpy")
def block_bounds(pool, shifts, out):
    """For one heading: no place in block [r, c] of places can score more than out[r, c]."""
    block, _, rows, columns = pool.shape
    rows, columns = rows - 1, columns - 1
    out[:] = 0
    flat, sums = pool.reshape(-1), out.reshape(-1)
    for k in range(len(shifts)):
        c, pu = divmod(shifts[k, 0], block)
        r, pv = divmod(shifts[k, 1], block)
        first, last = max(0, -1 - c), min(columns, columns - c)
        picture = ((pv * block + pu) * (rows + 1) + r + 1) * (columns + 1) + c + 1
        for row in range(max(0, -1 - r), min(rows, rows - r)):
            _add(sums, row * columns + first, flat, picture + row * (columns + 1) + first, last - first)


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
def heading_bounds(pool, points, inverse, headings, out):
    """The largest score that is possible anywhere, for each heading, into `out` (h,)."""
    _, _, rows, columns = pool.shape
    shifts = np.empty((len(points), 2), np.int64)
    bounds = np.empty((rows - 1, columns - 1), np.uint8)
    for h in range(len(headings)):
        offsets(points, inverse, headings[h], shifts)
        block_bounds(pool, shifts, bounds)
        out[h] = bounds.max()


@njit(cache=True, nogil=True, error_model="numpy")
def best_places(cells, pool, points, inverse, headings, order, limits, least, share, found):
    """The best place of every block and heading that scores `least` and `share` of the best of all, or more.

    order: headings by falling limit, limits: (h,) by `heading_bounds`. found: (m, 4) score, heading, row, column.
    Returns how many were found, -1 when there are more than m.
    """
    block, _, rows, columns = pool.shape
    shifts = np.empty((len(points), 2), np.int64)
    bounds = np.empty((rows - 1, columns - 1), np.uint8)
    best, count = 0, 0
    for h in order:
        least = max(least, math.ceil(share * best))
        if limits[h] < least:
            break
        offsets(points, inverse, headings[h], shifts)
        block_bounds(pool, shifts, bounds)
        for r in range(rows - 1):
            for c in range(columns - 1):
                if bounds[r, c] >= least:
                    if count == len(found):
                        count = _keep(found, count, least)
                        if count == len(found):
                            return -1
                    score = _best_of_block(cells, shifts, block * r, block * c, block, least, found[count])
                    if score >= least:
                        found[count, 1] = h
                        count += 1
                        best = max(best, score)
                        least = max(least, math.ceil(share * best))
    return _keep(found, count, least)


@njit(cache=True, nogil=True, error_model="numpy")
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


@njit(cache=True, nogil=True, error_model="numpy")
def _keep(found, count, least):
    """Drop the candidates below `least`; how many are left."""
    kept = 0
    for k in range(count):
        if found[k, 0] >= least:
            found[kept] = found[k]
            kept += 1
    return kept


@njit(cache=True, error_model="numpy")
def agreement(cells, points, laser, inverse, column, row, psi, slack):
    """Twice the sum over the beams of the cell that each ends in; one that crosses an occupied cell counts half.

    points: (n, 2) endpoints, laser: (2,), in metres in the frame whose origin lies at `column` and `row`, parts of
    a cell included, and whose heading is psi. Crossings in the last `slack` cells of a beam do not count.
    """
    rows, columns = cells.shape
    c, s = math.cos(psi) * inverse, math.sin(psi) * inverse
    u0, v0 = c * laser[0] - s * laser[1] + column, s * laser[0] + c * laser[1] + row
    total = 0
    for k in range(len(points)):
        u, v = c * points[k, 0] - s * points[k, 1] + column, s * points[k, 0] + c * points[k, 1] + row
        value = 2 * _cell(cells, rows, columns, u, v)
        if value:
            long = math.hypot(u - u0, v - v0)
            for step in range(1, int(long - slack)):
                t = step / long
                if _cell(cells, rows, columns, u0 + t * (u - u0), v0 + t * (v - v0)) == WALL:
                    value //= 2
                    break
        total += value
    return total


@njit(inline="always")
def _cell(cells, rows, columns, u, v):
    return np.int64(cells[int(v), int(u)]) if 0.0 <= u < columns and 0.0 <= v < rows else 0
