"""Tiles, squares of cells on all levels, and boxes of cells and of tiles."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from slam_core.kernels.map_update import derive_cells
from slam_core.measurements import Float32s, Int64s

# Cells of the finest level on a side; whole cells of every level (config.levels is 6 at most). A corridor is a few
# metres wide: larger tiles would hold mostly what nobody has seen.
TILE = 64

Kind = Literal["log_odds", "cells", "surfels"]
Key = tuple[int, int]
"""Column and row of a tile in the lattice of tiles; tile (0, 0) begins at the map's start."""
Box = tuple[int, int, int, int]
"""row0, row1, column0, column1 (half open), in cells of a level or in tiles, counted from the map's start."""


@dataclass(frozen=True, slots=True, eq=False)
class Tile:
    """One square of the map. It is never written, so that copies of a map share it.

    revision: of the map, when the tile changed last. log_odds: for each level the cells (n, n), finest first.
    surfels: of the finest level; None if there are none. What the matcher reads follows from the log-odds.
    """

    revision: int
    log_odds: tuple[Float32s, ...]
    surfels: NDArray[np.uint32] | None = None

    def __deepcopy__(self, _: Any) -> "Tile":
        return self

    @property
    def nbytes(self) -> int:
        """Memory of the arrays."""
        return sum(array.nbytes for array in (*self.log_odds, self.surfels) if array is not None)

    def values(self, level: int, kind: Kind) -> NDArray[Any] | None:
        """An array (n, n) of a level, as a `GridLevel` has it; None without surfels."""
        if kind == "surfels":
            return self.surfels
        return self.log_odds[level] if kind == "log_odds" else derived(self.log_odds[level])


@dataclass(frozen=True, slots=True, eq=False)
class PackedTile:
    """A tile to be kept for long, in a fraction of the memory.

    data: its arrays one after the other, packed. surfels: whether there are some.
    """

    revision: int
    data: bytes
    levels: int
    surfels: bool

    @property
    def nbytes(self) -> int:
        """Memory of the arrays."""
        return len(self.data)

    @classmethod
    def of(cls, tile: Tile, pack: Callable[[bytes], bytes]) -> "PackedTile":
        """pack: any compression without loss."""
        there = [array for array in (*tile.log_odds, tile.surfels) if array is not None]
        data = pack(b"".join(array.tobytes() for array in there))
        return cls(tile.revision, data, len(tile.log_odds), tile.surfels is not None)

    def tile(self, unpack: Callable[[bytes], bytes]) -> Tile:
        """The tile again. unpack: undoes what packed it."""
        data, at = unpack(self.data), 0

        def array(level: int, dtype: DTypeLike) -> NDArray[Any]:
            nonlocal at
            side = TILE >> level
            flat = np.frombuffer(data, dtype, side * side, at)
            at += flat.nbytes
            return flat.reshape(side, side)

        log_odds = tuple(array(level, np.float32) for level in range(self.levels))
        return Tile(self.revision, log_odds, array(0, np.uint32) if self.surfels else None)


class SavedCells(NamedTuple):
    """A rectangle of cells of a level, 0 the finest; its lattice corner (2,); surfels if it has some."""

    level: int
    corner: Int64s
    log_odds: Float32s
    surfels: NDArray[np.uint32] | None = None

    @property
    def box(self) -> Box:
        """Its rows and columns in the lattice."""
        (column, row), (rows, columns) = self.corner.tolist(), self.log_odds.shape
        return row, row + rows, column, column + columns


def cut(pieces: Iterable[SavedCells], levels: int, revision: int) -> dict[Key, Tile]:
    """Saved cells as tiles; those without a known cell are left out."""
    log_odds: dict[Key, list[Float32s]] = {}
    surfels: dict[Key, NDArray[np.uint32]] = {}
    for piece in pieces:
        side = TILE >> piece.level
        for key in keys(tiles_around(piece.box, side)):
            there = common(square(key, side), piece.box)
            values, inside = piece.log_odds[part(there, piece.box)], part(there, square(key, side))
            if values.any():
                if key not in log_odds:
                    log_odds[key] = [np.zeros((TILE >> i, TILE >> i), np.float32) for i in range(levels)]
                log_odds[key][piece.level][inside] = values
            if piece.surfels is not None and piece.level == 0 and piece.surfels[part(there, piece.box)].any():
                surfels[key] = np.zeros((TILE, TILE), np.uint32)
                surfels[key][inside] = piece.surfels[part(there, piece.box)]
    return {key: Tile(revision, tuple(values), surfels.get(key)) for key, values in log_odds.items()}


def derived(log_odds: Float32s) -> NDArray[np.int16]:
    """The cells that go with log-odds (rows, columns)."""
    cells = np.empty(log_odds.shape, np.int16)
    derive_cells(np.ascontiguousarray(log_odds), cells)
    return cells


def keys(box: Box) -> Iterator[Key]:
    """The tiles in a box of tiles, row by row."""
    row0, row1, column0, column1 = box
    return ((column, row) for row in range(row0, row1) for column in range(column0, column1))


def holds(box: Box, key: Key) -> bool:
    """Whether a tile is in a box of tiles."""
    return box[0] <= key[1] < box[1] and box[2] <= key[0] < box[3]


def square(key: Key, side: int) -> Box:
    """The cells of a tile on a level where it is `side` cells long."""
    column, row = side * key[0], side * key[1]
    return row, row + side, column, column + side


def tiles_around(box: Box, side: int) -> Box:
    """The tiles, `side` cells long, that a box of cells touches."""
    row0, row1, column0, column1 = box
    return row0 // side, -(-row1 // side), column0 // side, -(-column1 // side)


def common(a: Box, b: Box) -> Box:
    """What two boxes have in common; empty, and within `a`, if that is nothing."""
    row0, row1, column0, column1 = max(a[0], b[0]), min(a[1], b[1]), max(a[2], b[2]), min(a[3], b[3])
    return (row0, row1, column0, column1) if row0 < row1 and column0 < column1 else (a[0], a[0], a[2], a[2])


def around(a: Box | None, b: Box) -> Box:
    """The smallest box that holds both."""
    return b if a is None else (min(a[0], b[0]), max(a[1], b[1]), min(a[2], b[2]), max(a[3], b[3]))


def part(box: Box, of: Box) -> tuple[slice, slice]:
    """Where a box lies in the array of a box that holds it."""
    return slice(box[0] - of[0], box[1] - of[0]), slice(box[2] - of[2], box[3] - of[2])
