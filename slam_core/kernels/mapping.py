"""The map update of section IV: each cell changes at most once a scan, whatever the order of the beams.

First every cell is marked by what the scan says of it, in bytes that stay in the cache: beams cross each cell near
the laser a hundred times. Then one sweep over the rows changes what is marked, sixteen cells at a time.
"""

import numpy as np
from numba import njit

from slam_core.kernels.bilinear import WHOLE
from slam_core.kernels.memory import lane

FREE = np.uint8(1)
OCCUPIED = np.uint8(2)
BEHIND = np.uint8(3)
BLOCK = 16  # cells that are changed together; their marks are two words

# A walk counts in parts of 2^-40 of a cell: exact for beams shorter than 2^19 cells, and longer ones draw no ray.
PARTS = 40
LONGEST = 1 << 19

LOG2_E = np.float32(1.44269504)
HALF, ONE, CERTAIN = np.float32(0.5), np.float32(1.0), np.float32(WHOLE)
NO_MARK = np.uint8(0)
LARGEST_POWER = np.float32(60.0)
# 2^r for |r| <= 0.5 as a sum of powers, the largest error 3e-6 of the value.
E1, E2, E3, E4, E5 = (np.float32(x) for x in (0.69314718, 0.24022651, 0.05550411, 0.00961813, 0.00133336))

# The log-odds, the marks and the probabilities.
get_odds, put_odds = lane(0)
get_mark, put_mark = lane(1)
_, put_cell = lane(2)


@njit(cache=True, error_model="numpy")
def cells_of(points, corner, resolution):
    """Columns and rows (2, n) of map coordinates (n, 2) in metres, in the window at `corner`; may lie off it."""
    cells = np.empty((2, len(points)), np.int64)
    for k in range(len(points)):
        cells[0, k] = np.int64(np.floor(points[k, 0] / resolution)) - corner[0]
        cells[1, k] = np.int64(np.floor(points[k, 1] / resolution)) - corner[1]
    return cells


@njit(cache=True, error_model="numpy")
def bounds(points):
    """(2, 2) the lowest and the highest coordinates of points (n, 2), n > 0."""
    box = np.empty((2, 2))
    box[:] = points[0]
    for k in range(1, len(points)):
        for j in range(2):
            box[0, j], box[1, j] = min(box[0, j], points[k, j]), max(box[1, j], points[k, j])
    return box


@njit(cache=True, error_model="numpy")
def write_scan(log_odds, cells, marks, corner, resolution, start, hits, empty, free, occupied, low, high, behind):
    """Change every cell of one scan: beams' ends by the step `occupied`, the ways to them by `free`, within caps.

    A cell behind an end, of which no beam says anything, takes the step `free` too, but not below `behind`; 0
    leaves it alone.

    marks: bytes, rows as many as the map's, of whole cache lines and no shorter, all 0 before and after.
    start, hits, empty: (2,) laser, (n, 2) ends, (m, 2) ends of beams that hit nothing, in metres.
    Returns row0, row1, column0, column1 (half open) around all that was touched.
    """
    rows, columns = log_odds.shape
    laser = cells_of(start.reshape(1, 2), corner, resolution)
    ends, cleared = cells_of(hits, corner, resolution), cells_of(empty, corner, resolution)
    _mark_ways(marks, rows, columns, laser, ends)
    _mark_ways(marks, rows, columns, laser, cleared)
    _mark_ends(marks, rows, columns, ends)
    column0, column1 = _span(columns, laser[0], ends[0], cleared[0])
    row0, row1 = _span(rows, laser[1], ends[1], cleared[1])
    if behind < 0.0:
        _mark_behind(marks, rows, columns, corner, resolution, start, hits)
        column0, column1 = max(column0 - 1, 0), min(column1 + 1, columns)
        row0, row1 = max(row0 - 1, 0), min(row1 + 1, rows)
    for row in range(row0, row1):
        _change(log_odds[row], cells[row], marks[row], column0, column1, free, occupied, low, high, behind)
    return row0, row1, column0, column1


@njit(cache=True, error_model="numpy")
def _mark_ends(marks, rows, columns, ends):
    """The end of each beam; ends off the map are left out. After the ways, since a hit wins."""
    for k in range(ends.shape[1]):
        u, v = ends[0, k], ends[1, k]
        if 0 <= u < columns and 0 <= v < rows:
            marks[v, u] = OCCUPIED


@njit(cache=True, error_model="numpy")
def _mark_behind(marks, rows, columns, corner, resolution, start, hits):
    """The cell that each beam would have entered next, unless the scan says something else of it."""
    for k in range(len(hits)):
        dx, dy = hits[k, 0] - start[0], hits[k, 1] - start[1]
        further = resolution / max(abs(dx), abs(dy), resolution)
        u = np.int64(np.floor((hits[k, 0] + further * dx) / resolution)) - corner[0]
        v = np.int64(np.floor((hits[k, 1] + further * dy) / resolution)) - corner[1]
        if 0 <= u < columns and 0 <= v < rows and marks[v, u] == NO_MARK:
            marks[v, u] = BEHIND


@njit(cache=True, error_model="numpy")
def _mark_ways(marks, rows, columns, laser, ends):
    """Cells from the laser up to each end, without it (Bresenham), clipped to the map.

    Beams cross the cells near the laser together, so each starts its way where no other takes it: of beams that
    follow each other into the same cell one is drawn, and of those every second begins where its neighbours have
    parted, every fourth where the next two beams on either side have, and so on. In a room of 30 m that leaves
    half of all steps at 0.05 m, a third at 0.1 m and a fifth at 0.2 m. A step takes 0.65 ns.
    """
    u0, v0 = laser[0, 0], laser[1, 0]
    ways = np.empty((ends.shape[1], 5), np.int64)
    n = 0
    for k in range(ends.shape[1]):
        u, v = ends[0, k], ends[1, k]
        if k == 0 or u != ends[0, k - 1] or v != ends[1, k - 1]:
            _way(u - u0, v - v0, marks.shape[1], _steps_inside(rows, columns, u0, v0, u, v), ways[n])
            n += 1
    flat = marks.reshape(-1)
    for k in range(n):
        apart = k & -k
        first = _parting(ways[k - apart], ways[k], ways[k + apart]) if 0 < k < n - apart else 0
        _walk(flat, v0 * marks.shape[1] + u0, ways[k], first)


@njit(inline="always")
def _way(du, dv, stride, steps, way):
    """(5,) steps; bytes along and across in one; the slope in parts, and once more as it is among all ways."""
    upright = abs(dv) > abs(du)
    long, short = (abs(dv), abs(du)) if upright else (abs(du), abs(dv))
    su, sv = 1 if du > 0 else -1, 1 if dv > 0 else -1
    part = (short << PARTS) // max(long, 1)
    way[0] = steps if long < LONGEST else 0
    way[1], way[2] = (sv * stride, su) if upright else (su, sv * stride)
    way[3] = part
    # Ways in the four directions lie more than a slope of 1 apart, so that none lies between two of another one.
    way[4] = part * (su if upright else sv) + ((sv if upright else 3 * su) << (PARTS + 1))


@njit(inline="always")
def _parting(a, way, b):
    """The first step at which a way may leave both of its neighbours a and b.

    A step's place across the way is its number times the slope, rounded. As long as the places on a and b differ
    by a cell at most, a slope between theirs gives one of the two.
    """
    low, high = min(a[4], b[4]), max(a[4], b[4])
    if not low <= way[4] <= high:
        return 0
    return int(min(a[0], b[0], (1 << PARTS) / max(high - low, 1)))


@njit(inline="always")
def _walk(flat, start, way, first):
    """Mark the cells from step `first` on. The place across is the step times the slope, halves rounded down.

    It is summed in parts of a cell, a step at a time without a branch: what the slope's division cut off, a part a
    step at most, never adds up to the distance from a half to the nearest other place.
    """
    n, along, across, part = way[0], way[1], way[2], way[3]
    place = (1 << PARTS - 1) - 1 + first * part
    i = start + first * along
    for _ in range(first, n):
        flat[np.uint64(i + (place >> PARTS) * across)] = FREE
        place += part
        i += along


@njit(cache=True, error_model="numpy")
def _steps_inside(rows, columns, u0, v0, u1, v1):
    """How many of the steps from the laser to the end stay on the map; none when the laser itself is off it."""
    n = max(abs(u1 - u0), abs(v1 - v0))
    if not (0 <= u0 < columns and 0 <= v0 < rows):
        return 0
    if 0 <= u1 < columns and 0 <= v1 < rows:
        return n
    fraction = 1.0
    for start, end, last in ((u0, u1, columns - 1), (v0, v1, rows - 1)):
        if end < 0:
            fraction = min(fraction, start / (start - end))
        elif end > last:
            fraction = min(fraction, (last - start) / (end - start))
    return max(0, int(n * fraction) - 1)


@njit(cache=True, error_model="numpy")
def _span(size, laser, ends, cleared):
    """First and last + 1 of the places that a scan reaches along one axis, clipped to the map."""
    first = last = laser[0]
    for k in range(len(ends)):
        first, last = min(first, ends[k]), max(last, ends[k])
    for k in range(len(cleared)):
        first, last = min(first, cleared[k]), max(last, cleared[k])
    return min(max(first, 0), size), min(max(last + 1, 0), size)


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def _change(log_odds, cells, marks, column0, column1, free, occupied, low, high, behind):
    """Change the marked cells of one row and take the marks away; blocks without a mark are skipped.

    The loop over a block becomes a few instructions for all of its cells, if nothing in it is a call.
    """
    words = marks.view(np.uint64)
    for block in range(column0 // BLOCK, (column1 + BLOCK - 1) // BLOCK):
        if words[2 * block] | words[2 * block + 1]:
            first = block * BLOCK
            for i in range(first, min(first + BLOCK, len(log_odds))):
                old, mark = get_odds(log_odds, i), get_mark(marks, i)
                least = max(min(old, behind), low) if mark == BEHIND else low
                stepped = min(max(old + (occupied if mark == OCCUPIED else free), least), high)
                value = old if mark == NO_MARK else stepped
                put_odds(log_odds, i, value)
                put_cell(cells, i, probability_in_parts(value))
                put_mark(marks, i, NO_MARK)


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def derive_cells(log_odds, out):
    """The cells that go with log-odds (rows, columns), into `out`: to the last bit as the update leaves them."""
    for row in range(log_odds.shape[0]):
        for column in range(log_odds.shape[1]):
            out[row, column] = probability_in_parts(log_odds[row, column])


@njit(inline="always")
def probability_in_parts(log_odds):
    """What a cell of these log-odds holds for the matcher."""
    odds_against = _power_of_2(min(max(-LOG2_E * log_odds, -LARGEST_POWER), LARGEST_POWER))
    return np.uint16(np.int32(min(CERTAIN / (ONE + odds_against) + HALF, CERTAIN - ONE)))


@njit(inline="always")
def _power_of_2(x):
    """2^x as a shift and a polynomial: unlike the library's, it works on many numbers at once."""
    n = np.floor(x + HALF)
    r = x - n
    series = ONE + r * (E1 + r * (E2 + r * (E3 + r * (E4 + r * E5))))
    return series * np.int32((np.int32(n) + np.int32(127)) << np.int32(23)).view(np.float32)
