"""Section IV: one occupancy grid of log-odds with the probability that the matcher reads."""

import mmap
from math import prod
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from slam_core.kernels.bilinear import UNKNOWN_PARTS, WHOLE
from slam_core.kernels.dynamic_objects import clear_passed, ends_in_free_space
from slam_core.kernels.map_update import write_scan
from slam_core.kernels.surfels import write_surfels
from slam_core.mapping.tiles import TILE, Box, Key, Kind, around, common, derived, part, square
from slam_core.measurements import Float32s, Float64s, Int64s

LARGE = 1 << 22  # bytes for which numpy asks for huge pages


class GridLevel:
    """A window on the endless lattice of cells in which the map's start is the corner of cell (0, 0).

    origin: (2,) lower left corner of the window in map coordinates, in whole cells. Row 0 is the lowest y.
    corner: (2,) column and row in the lattice of the window's cell [0, 0].
    log_odds: (rows, columns), 0 unknown. cells: the same as M of eq. (4), in parts of 2^16, less 2^15.
    bounds: row0, row1, column0, column1 (half open) in the lattice around every cell of the level that was ever
    touched, in this window or another one; None before the first.
    surfels: where in each cell a surface lies, as `kernels.surfels` packs it, 0 for none; no rows if not kept.
    tile: cells on a side of a tile, a power of 2. revisions: of each tile of the window, when it changed last.
    """

    BYTES = 7  # of memory a cell: four in log_odds, two in cells, one mark
    SURFEL_BYTES = 4

    def __init__(
        self,
        resolution: float,
        shape: tuple[int, int],
        origin: Float64s,
        *,
        surfels: bool = False,
        tile: int = TILE,
    ) -> None:
        self.resolution = resolution
        self.corner: Int64s = np.rint(origin / resolution).astype(np.int64)
        self.log_odds: Float32s = unknown(shape, np.float32)
        self.cells: NDArray[np.int16] = unknown(shape, np.int16)
        self.surfels: NDArray[np.uint32] = unknown(shape if surfels else (0, 0), np.uint32)
        self.tile = tile
        self.revisions = _no_revisions(shape, tile)
        self.bounds: Box | None = None
        self._marks = _no_marks(shape)

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        rows, columns = self.log_odds.shape
        return rows, columns

    @property
    def nbytes(self) -> int:
        """Memory of the cells and what belongs to them."""
        return self.log_odds.nbytes + self.cells.nbytes + self.surfels.nbytes + self._marks.nbytes

    @property
    def box(self) -> Box:
        """The window's rows and columns in the lattice."""
        (column, row), (rows, columns) = self.corner.tolist(), self.shape
        return row, row + rows, column, column + columns

    @property
    def known(self) -> Box:
        """The part of `bounds` in the window: row0, row1, column0, column1 (half open) of its own."""
        if self.bounds is None:
            return 0, 0, 0, 0
        (column, row), (row0, row1, column0, column1) = self.corner.tolist(), common(self.box, self.bounds)
        return row0 - row, row1 - row, column0 - column, column1 - column

    @property
    def probability(self) -> Float32s:
        """M of eq. (4) as a number, (rows, columns); a copy."""
        copy = probability_of(self.cells)
        copy.flags.writeable = False
        return copy

    @property
    def origin(self) -> Float64s:
        """(2,) lower left corner in map coordinates, metres."""
        return (self.resolution * self.corner).astype(np.float64)

    def cell_of(self, x: Any, y: Any) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Column and row of map coordinates in metres; may lie off the map.

        Counted in the lattice first: rounding does not depend on how far the window reaches.
        """
        u = np.floor(np.asarray(x, np.float64) / self.resolution).astype(np.int64) - self.corner[0]
        v = np.floor(np.asarray(y, np.float64) / self.resolution).astype(np.int64) - self.corner[1]
        return u, v

    def move(self, corner: Int64s, shape: tuple[int, int]) -> None:
        """Another window, by whole tiles: what it holds already stays, all else in it is unknown."""
        down, right = (corner - self.corner)[::-1].tolist()
        tiles = down // self.tile, right // self.tile
        everywhere = 0, self.revisions.shape[0], 0, self.revisions.shape[1]
        self.revisions = _moved(self.revisions, tiles, _no_revisions(shape, self.tile), everywhere)
        same, known = shape == self.shape, self.known
        for name in ("log_odds", "cells", "surfels"):
            array = getattr(self, name)
            if len(array) and same:
                _shift(array, (down, right), known[:2])
            elif len(array):
                setattr(self, name, _moved(array, (down, right), unknown(shape, array.dtype), known))
        if not same:
            self._marks = _no_marks(shape)
        self.corner = corner

    def update(
        self,
        start: Float64s,
        ends: Float64s,
        cleared: Float64s,
        steps: tuple[float, float],
        caps: tuple[float, float],
        behind: float = 0.0,
        revision: int = 1,
    ) -> None:
        """Write one scan: every touched cell changes once, by the occupied step at ends, by the free step before.

        start: (2,) laser. ends: (n, 2) endpoints. cleared: (m, 2) ends of beams that hit nothing. Map metres.
        steps: free (negative) and occupied log-odds. caps: lowest and highest log-odds. behind: how low the cells
        behind the ends may sink by this; 0 leaves them alone. revision: of the tiles that change.
        """
        grid, tiles = (self.log_odds, self.cells, self._marks), (self.revisions, self._shift, revision)
        changes = *steps, *caps, behind
        touched = write_scan(grid, self.corner, self.resolution, start, ends, cleared, changes, tiles)
        self._touch(touched)

    def _touch(self, box: Box) -> None:
        """A box of the window is known from now on."""
        (column, row), (row0, row1, column0, column1) = self.corner.tolist(), box
        self.bounds = around(self.bounds, (row0 + row, row1 + row, column0 + column, column1 + column))

    @property
    def _shift(self) -> int:
        return self.tile.bit_length() - 1

    def place_surfaces(self, points: Float32s, start: Float64s, ends: Float64s, psi: float) -> None:
        """Take one scan's ends into the surfels.

        points: (n, 2) in the stabilised frame, whose heading is psi, in the order of the sweep. start: (2,) laser.
        ends: (n, 2) the points in the map. Metres.
        """
        write_surfels(self.surfels, self.corner, self.resolution, points, start, ends, psi)

    def gather(self, box: Box, kind: Kind = "log_odds") -> NDArray[Any]:
        """An array of the level in a box of the lattice, (rows, columns); unknown off the window; a copy."""
        kept: NDArray[Any] = getattr(self, kind)
        if common(box, self.box) == box:
            return kept[part(box, self.box)].copy()
        out = np.zeros((box[1] - box[0], box[3] - box[2]), kept.dtype)
        here = common(box, self.box)
        out[part(here, box)] = kept[part(here, self.box)]
        return out

    def seen(self) -> list[Key]:
        """The tiles of the window in which something was seen."""
        column, row = (self.corner // self.tile).tolist()
        return [(column + x, row + y) for y, x in np.argwhere(self.revisions > 0).tolist()]

    def take(self, key: Key) -> tuple[Float32s, NDArray[np.uint32] | None]:
        """Of a tile of the window copies of log-odds, and of surfels if there are any."""
        box = self._box_of(key)
        surfels = self.surfels[box] if len(self.surfels) else np.zeros((0, 0), np.uint32)
        return self.log_odds[box].copy(), surfels.copy() if surfels.any() else None

    def put(self, key: Key, log_odds: Float32s, surfels: NDArray[np.uint32] | None, revision: int) -> None:
        """Set a tile of the window."""
        box = self._box_of(key)
        self.log_odds[box] = log_odds
        self.cells[box] = derived(log_odds)
        if len(self.surfels):
            self.surfels[box] = 0 if surfels is None else surfels
        self.revisions[box[0].start // self.tile, box[1].start // self.tile] = revision

    def _box_of(self, key: Key) -> tuple[slice, slice]:
        return part(square(key, self.tile), self.box)

    def clear(
        self,
        laser: Float64s,
        beams: tuple[Float64s, NDArray[np.int64], Float64s, Float64s],
        behind: float,
        most: float,
        free: float,
        revision: int = 1,
    ) -> int:
        """Take `most` log-odds at most and the step `free` from every occupied cell that beams pass.

        laser: (2,) map metres. beams: their ends `by_bearing`. behind: metres. revision: of the tiles that change.
        Returns how many cells did.
        """
        grid, window = (self.log_odds, self.cells, self.surfels), (self.corner, self.resolution, self.known)
        clearing = np.float32(behind), np.float32(most), np.float32(free)
        return int(clear_passed(grid, *window, laser, beams, clearing, (self.revisions, self._shift, revision)))

    def unexpected(self, points: Float32s, pose: Float64s, apart: float) -> NDArray[np.bool_]:
        """Which points (n, 2) of a scan at `pose` (3,) lie in free space, `apart` metres from what is occupied."""
        found = np.empty(len(points), np.bool_)
        around = round(apart / self.resolution)
        ends_in_free_space(self.cells, self.corner, self.resolution, points, pose, around, found)
        return found

    def occupancy(self) -> NDArray[np.int8]:
        """The whole level as an OccupancyGrid: -1 unknown, else probability in percent."""
        percent = np.rint(100 * self.probability).astype(np.int8)
        return np.where(self.log_odds == 0, np.int8(-1), percent).astype(np.int8)

    def copy(self) -> "GridLevel":
        """An independent copy."""
        other = GridLevel.__new__(GridLevel)
        other.__dict__.update({k: v.copy() if isinstance(v, np.ndarray) else v for k, v in self.__dict__.items()})
        return other


def unknown(shape: tuple[int, int], dtype: DTypeLike) -> NDArray[Any]:
    """Zeros; many of them in small pages of new memory, each of which takes time when it is touched first.

    numpy asks for huge pages: a few long beams touch all of those, and the system may have to look for some.
    """
    size = prod(shape) * np.dtype(dtype).itemsize
    if size < LARGE:
        return np.zeros(shape, dtype)
    return np.frombuffer(mmap.mmap(-1, size, access=mmap.ACCESS_COPY), dtype).reshape(shape)


def probability_of(cells: NDArray[np.int16]) -> Float32s:
    """M of eq. (4) of a level's `cells`."""
    probability: Float32s = (cells + np.float32(UNKNOWN_PARTS)) / np.float32(WHOLE)
    return probability


def _shift(array: NDArray[Any], by: tuple[int, int], known: tuple[int, int]) -> None:
    """Move the view of an array (rows, columns) on by rows and columns, in place. known: its rows, half open.

    In memory that is one shift of these rows; strips beside them are left over.
    """
    (rows, columns), (down, right), (first, last) = array.shape, by, known
    low, high = max(first - down, 0), min(last - down, rows)
    if low >= high or abs(right) >= columns:
        array[first:last] = 0
        return
    flat, behind = array.reshape(-1), down * columns + right
    begin, end = max(low * columns, -behind), min(high * columns, array.size - behind)
    flat[begin:end] = flat[begin + behind : end + behind]
    array[first : min(last, low)] = 0
    array[max(first, high) : last] = 0
    array[low:high, columns - right if right > 0 else 0 : columns if right > 0 else -right] = 0


def _moved(array: NDArray[Any], by: tuple[int, int], blank: NDArray[Any], box: Box) -> NDArray[Any]:
    """`blank` with what a box of an array has of it. by: rows and columns from the array's first to its own."""
    high, wide = blank.shape
    there = common(box, (by[0], by[0] + high, by[1], by[1] + wide))
    blank[part(there, (by[0], 0, by[1], 0))] = array[part(there, (0, 0, 0, 0))]
    return blank


def _no_revisions(shape: tuple[int, int], tile: int) -> Int64s:
    rows, columns = shape
    return np.zeros((-(-rows // tile), -(-columns // tile)), np.int64)


def _no_marks(shape: tuple[int, int]) -> NDArray[np.uint8]:
    """Rows an odd number of cache lines apart: cells above each other do not compete for the same lines."""
    rows, columns = shape
    return unknown((rows, 64 * (columns // 64 + 1 | 1)), np.uint8)
