"""The map update of section IV: each cell changes at most once a scan, whatever the order of the beams.

First every cell is marked by its state in the scan, in bytes that stay in the cache. Then one sweep over the
rows changes what is marked, thirty-two cells at a time.
"""

import numpy as np
from numba import njit

from slam_core.kernels import INNER
from slam_core.kernels.bilinear import UNKNOWN_PARTS, WHOLE
from slam_core.kernels.memory import alias_scope, prefetch
from slam_core.kernels.ray_tracing import trace_rays
from slam_core.kernels.structures import Steps, Tiles

OCCUPIED = np.uint8(2)
BEHIND = np.uint8(3)
BLOCK = 32  # cells that are changed together
AHEAD = 4  # rows: what is changed there is fetched meanwhile
WORDS = BLOCK // 8  # of their marks
FURTHEST = 2.0**40  # cells from the map's start: what lies further off is taken to lie there

LOG2_E = np.float32(1.44269504)
HALF, ONE, CERTAIN = np.float32(0.5), np.float32(1.0), np.float32(WHOLE)
NO_MARK = np.uint8(0)
LARGEST_POWER = np.float32(60.0)
# 2^r for |r| <= 0.5 as a sum of powers, the largest error 3e-6 of the value.
E1, E2, E3, E4, E5 = (np.float32(x) for x in (0.69314718, 0.24022651, 0.05550411, 0.00961813, 0.00133336))

# The log-odds, the marks and the probabilities.
get, put_back = alias_scope(0)
get_mark, put = alias_scope(1)
_, put_cell = alias_scope(2)


@njit(inline="always")
def whole(cells):
    """The cell that a place in cells lies in; far off the map for what is no number."""
    return np.int64(np.floor(min(FURTHEST, max(-FURTHEST, cells))))


@njit(cache=True, error_model="numpy")
def cells_of(points, corner, resolution):
    """Columns and rows (2, n) of map coordinates (n, 2) in metres, in the window at `corner`; may lie off it."""
    n = len(points)
    cells = np.empty((2, n), np.int64)
    places, flat, left, low = points.reshape(-1), cells.reshape(-1), corner[0], corner[1]
    for k in range(n):
        put(flat, k, whole(get(places, 2 * k) / resolution) - left)
        put(flat, n + k, whole(get(places, 2 * k + 1) / resolution) - low)
    return cells


@njit(cache=True, error_model="numpy")
def cell_box(points, corner, resolution):
    """row0, row1, column0, column1 (half open) around the cells of points (n, 2), n > 0; may reach off the map."""
    box = np.empty((2, 2))
    for j in range(2):  # to assign a slice takes numba seconds to compile
        box[0, j] = box[1, j] = points[0, j]
    for k in range(1, len(points)):
        for j in range(2):
            box[0, j], box[1, j] = min(box[0, j], points[k, j]), max(box[1, j], points[k, j])
    columns, rows = cells_of(box, corner, resolution)
    return rows[0], rows[1] + 1, columns[0], columns[1] + 1


@njit(cache=True, error_model="numpy")
def write_scan(grid, corner, resolution, start, hits, empty, steps, tiles):
    """Change every cell of one scan: endpoints by the occupied step, the cells before them by the free step.

    A cell behind an endpoint that no beam marks takes the free step too, but not below `behind`; 0: none does.

    grid: log_odds, cells, marks. steps: the fields of `Steps`. marks: bytes, rows as many as the map's, of whole
    cache lines and no shorter, all 0 before and after. tiles: the fields of `Tiles`; those that change take the
    revision.
    start, hits, empty: (2,) laser, (n, 2) ends, (m, 2) ends of beams that hit nothing, in metres.
    Returns row0, row1, column0, column1 (half open) around all that was touched.
    """
    log_odds, _, marks = grid
    steps, tiles = Steps(*steps), Tiles(*tiles)
    rows, columns = log_odds.shape
    laser = cells_of(start.reshape(1, 2), corner, resolution)
    ends, cleared = cells_of(hits, corner, resolution), cells_of(empty, corner, resolution)
    trace_rays(marks, rows, columns, laser, ends)
    trace_rays(marks, rows, columns, laser, cleared)
    _mark_ends(marks, rows, columns, ends)
    column0, column1 = _span(columns, laser[0], ends[0], cleared[0])
    row0, row1 = _span(rows, laser[1], ends[1], cleared[1])
    if steps.behind < 0.0:
        _mark_behind(marks, rows, columns, corner, resolution, start, hits)
        column0, column1 = max(column0 - 1, 0), min(column1 + 1, columns)
        row0, row1 = max(row0 - 1, 0), min(row1 + 1, rows)
    free, occupied = np.float32(steps.free), np.float32(steps.occupied)
    narrow = free, occupied, np.float32(steps.low), np.float32(steps.high), np.float32(steps.behind)
    if columns >= BLOCK:
        _change(grid, (row0, row1, column0, column1), narrow, tiles)
    else:
        _change_narrow(grid, (row0, row1, column0, column1), narrow, tiles)
    return row0, row1, column0, column1


@njit(**INNER)
def _mark_ends(marks, rows, columns, ends):
    """The end of each beam; ends off the map are left out. After free space, since a hit wins."""
    for k in range(ends.shape[1]):
        u, v = ends[0, k], ends[1, k]
        if 0 <= u < columns and 0 <= v < rows:
            marks[v, u] = OCCUPIED


@njit(**INNER)
def _mark_behind(marks, rows, columns, corner, resolution, start, hits):
    """The cell that each beam would have entered next, unless the scan marks it otherwise."""
    where, flat = np.empty(len(hits), np.int64), marks.reshape(-1)
    _beyond(hits.reshape(-1), rows, columns, marks.shape[1], corner, resolution, start, where)
    for k in range(len(where)):
        if where[k] >= 0:  # nearly always; no branch on the mark, which would be mispredicted
            mark = flat[where[k]]
            flat[where[k]] = BEHIND if mark == NO_MARK else mark


@njit(**INNER)
def _beyond(hits, rows, columns, stride, corner, resolution, start, where):
    """Into `where` (n,) the marks of the cells behind the ends (n, 2), flat; -1 off the map."""
    x, y, left, low = start[0], start[1], corner[0], corner[1]
    for k in range(len(where)):
        hit_x, hit_y = get(hits, 2 * k), get(hits, 2 * k + 1)
        dx, dy = hit_x - x, hit_y - y
        further = resolution / max(abs(dx), abs(dy), resolution)
        u = whole((hit_x + further * dx) / resolution) - left
        v = whole((hit_y + further * dy) / resolution) - low
        inside = (u >= 0) & (u < columns) & (v >= 0) & (v < rows)
        put(where, k, v * stride + u if inside else -1)


@njit(**INNER)
def _span(size, laser, ends, cleared):
    """First and last + 1 of the places that a scan reaches along one axis, clipped to the map."""
    first = last = laser[0]
    for k in range(len(ends)):
        first, last = min(first, ends[k]), max(last, ends[k])
    for k in range(len(cleared)):
        first, last = min(first, cleared[k]), max(last, cleared[k])
    return min(max(first, 0), size), min(max(last + 1, 0), size)


@njit(fastmath={"contract"}, **INNER)
def _change(grid, box, steps, tiles):
    """Change the marked cells of a box and take the marks away; blocks without a mark are skipped.

    A loop over a whole block becomes a few instructions for all of its cells, as nothing in it is a call and LLVM
    knows how many they are. The last block of a row begins early, where the block before has taken the marks away.
    """
    (log_odds, cells, marks), (row0, row1, column0, column1) = grid, box
    free, occupied, low, high, behind = steps
    columns, stride = log_odds.shape[1], marks.shape[1]
    odds, parts, flat = log_odds.reshape(-1), cells.reshape(-1), marks.reshape(-1)
    words = flat.view(np.uint64)
    last = columns - BLOCK
    for row in range(row0, row1):
        for block in range(column0 // BLOCK, (column1 + BLOCK - 1) // BLOCK):
            if _any(words, row * stride // 8 + block * WORDS):
                _note(tiles, words, row * stride // 8 + block * WORDS, row, block * BLOCK)
                first = min(block * BLOCK, last)
                i, j = row * columns + first, row * stride + first
                ahead = min(i + AHEAD * columns, len(odds) - BLOCK)
                prefetch(odds, ahead)
                prefetch(odds, ahead + 16)
                prefetch(parts, ahead)
                for k in range(BLOCK):
                    old, mark = get(odds, i + k), get_mark(flat, j + k)
                    value = _changed(old, mark, free, occupied, low, high, behind)
                    put_back(odds, i + k, value)
                    put_cell(parts, i + k, probability_in_parts(value))
                    put(flat, j + k, NO_MARK)


@njit(fastmath={"contract"}, **INNER)
def _change_narrow(grid, box, steps, tiles):
    """The same for a map of which no row holds a block."""
    (log_odds, cells, marks), (row0, row1, column0, column1) = grid, box
    free, occupied, low, high, behind = steps
    for row in range(row0, row1):
        for column in range(column0, column1):
            if marks[row, column] != NO_MARK:
                tiles.revisions[row >> tiles.shift, column >> tiles.shift] = tiles.revision
            value = _changed(log_odds[row, column], marks[row, column], free, occupied, low, high, behind)
            log_odds[row, column], cells[row, column] = value, probability_in_parts(value)
            marks[row, column] = NO_MARK


@njit(inline="always")
def _any(words, first):
    """Whether any of the words of a block's marks is not 0."""
    marked = np.uint64(0)
    for k in range(WORDS):
        marked |= get_mark(words, first + k)
    return marked != 0


@njit(inline="always")
def _note(tiles, words, first, row, column):
    """The tiles in which a marked block from `column` on changes; those that share a word of marks all do."""
    row, shift = row >> tiles.shift, tiles.shift
    if shift >= 5:
        tiles.revisions[row, column >> shift] = tiles.revision
        return
    for k in range(WORDS):
        if get_mark(words, first + k) != 0:
            last = min((column + 8 * k + 7) >> shift, tiles.revisions.shape[1] - 1)
            for tile in range((column + 8 * k) >> shift, last + 1):
                tiles.revisions[row, tile] = tiles.revision


@njit(inline="always")
def _changed(old, mark, free, occupied, low, high, behind):
    """Log-odds after a mark; without a branch."""
    least = max(min(old, behind), low) if mark == BEHIND else low
    stepped = min(max(old + (occupied if mark == OCCUPIED else free), least), high)
    return old if mark == NO_MARK else stepped


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def derive_cells(log_odds, out):
    """The cells that go with log-odds (rows, columns), into `out`: to the last bit as the update leaves them."""
    for row in range(log_odds.shape[0]):
        for column in range(log_odds.shape[1]):
            out[row, column] = probability_in_parts(log_odds[row, column])


@njit(fastmath={"contract"}, **INNER)
def derive_cell(log_odds):
    """The same for one cell."""
    return probability_in_parts(log_odds)


@njit(inline="always")
def probability_in_parts(log_odds):
    """What a cell of these log-odds holds for the matcher."""
    odds_against = _power_of_2(min(max(-LOG2_E * log_odds, -LARGEST_POWER), LARGEST_POWER))
    return np.int16(np.int32(min(CERTAIN / (ONE + odds_against) + HALF, CERTAIN - ONE)) - np.int32(UNKNOWN_PARTS))


@njit(inline="always")
def _power_of_2(x):
    """2^x as a shift and a polynomial: unlike the library's, it works on many numbers at once."""
    n = np.floor(x + HALF)
    r = x - n
    series = ONE + r * (E1 + r * (E2 + r * (E3 + r * (E4 + r * E5))))
    return series * np.int32((np.int32(n) + np.int32(127)) << np.int32(23)).view(np.float32)
