"""The map on all levels: a window of dense grids, and the tiles outside of it.

Each tile has the revision of its last change, by which whoever follows the map finds what is new.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slam_core.errors import SlamError
from slam_core.mapping.grid import GridLevel
from slam_core.mapping.tiles import (
    TILE,
    Box,
    Key,
    Kind,
    SavedCells,
    Tile,
    around,
    common,
    cut,
    derived,
    holds,
    keys,
    part,
    square,
    tiles_around,
)
from slam_core.measurements import Float32s, Int64s

LARGEST = 1 << 27  # cells of a level that is put together as a whole


class TiledMap:
    """levels: finest first; windows with the same corner and the same extent, of whole tiles.

    revision: grows with every change of a cell.
    """

    def __init__(self, resolution: float, levels: int, window: Box) -> None:
        """window: of tiles."""
        self.levels = tuple(_level(resolution, i, window) for i in range(levels))
        self.revision = 0
        self._tiles: dict[Key, Tile] = {}
        self._stored = 0  # bytes of these

    @property
    def window(self) -> Box:
        """The tiles in the window."""
        return tiles_around(self.levels[0].box, TILE)

    @property
    def empty(self) -> bool:
        """Whether no cell was ever touched."""
        return self.levels[0].bounds is None

    @property
    def stored(self) -> int:
        """How many tiles lie outside of the window."""
        return len(self._tiles)

    @property
    def outside(self) -> dict[Key, Tile]:
        """The tiles outside of the window; a copy."""
        return dict(self._tiles)

    @property
    def nbytes(self) -> int:
        """Memory of the window and of the tiles that are stored."""
        return sum(level.nbytes for level in self.levels) + self._stored

    def bounds(self, level: int = 0) -> Box:
        """row0, row1, column0, column1 (half open) in the lattice around every cell of a level ever touched."""
        return self.levels[level].bounds or (0, 0, 0, 0)

    def move(self, window: Box) -> None:
        """Move the window to a box of tiles: those that leave it are stored, those that it reaches come back."""
        before, revisions = self.window, self.revisions()
        for key in keys(before):
            revision = int(revisions[key[1] - before[0], key[0] - before[2]])
            if revision and not holds(window, key):
                self._store(key, self._known(key, revision))
        for i, level in enumerate(self.levels):
            row0, row1, column0, column1 = (n * (TILE >> i) for n in window)
            level.move(np.array([column0, row0]), (row1 - row0, column1 - column0))
        for key in keys(window):
            if not holds(before, key):
                self._load(key)

    def changed_since(self, revision: int) -> list[Key]:
        """The tiles that changed after a revision of the map."""
        row, _, column, _ = self.window
        here = [(column + x, row + y) for y, x in np.argwhere(self.revisions() > revision).tolist()]
        return here + [key for key, tile in self._tiles.items() if tile.revision > revision]

    def tile(self, key: Key) -> Tile | None:
        """A tile as it is now; None if nothing was ever seen there."""
        row, _, column, _ = window = self.window
        if not holds(window, key):
            return self._tiles.get(key)
        revision = int(self.revisions()[key[1] - row, key[0] - column])
        return self._known(key, revision) if revision else None

    def taken(self, key: Key, revision: int) -> Tile:
        """A tile of the window, to be kept, also one in which all is unknown."""
        log_odds, surfels = zip(*(level.take(key) for level in self.levels), strict=True)
        return Tile(revision, log_odds, surfels[0])

    def _known(self, key: Key, revision: int) -> Tile | None:
        """The same; None if all in it is unknown."""
        tile = self.taken(key, revision)
        return tile if any(values.any() for values in tile.log_odds) else None

    def revisions(self) -> Int64s:
        """Of each tile in the window, (rows, columns) of tiles, when it changed last; 0 for never."""
        revisions: Int64s = np.max([level.revisions for level in self.levels], axis=0)
        return revisions

    def gather(self, level: int, box: Box, kind: Kind = "log_odds") -> NDArray[Any]:
        """What a level holds in a box of its lattice, (rows, columns); a copy.

        kind: an array of a `GridLevel`. Only the finest level has surfels.
        """
        out, side = self.levels[level].gather(box, kind), TILE >> level
        for key, tile in self._stored_in(tiles_around(box, side)):
            there, values = common(square(key, side), box), tile.values(level, kind)
            if values is not None:
                out[part(there, box)] = values[part(there, square(key, side))]
        return out

    def pieces(self, level: int) -> Iterator[tuple[Box, Float32s]]:
        """The log-odds of the window and of all tiles outside of it, each with its box in the lattice; views."""
        yield self.levels[level].box, self.levels[level].log_odds
        for key, tile in self._tiles.items():
            yield square(key, TILE >> level), tile.log_odds[level]

    def whole(self, level: int = 0) -> GridLevel:
        """A level with all that is known in one window: its own if nothing is stored, else a new one.

        SlamError if that would take more than LARGEST cells.
        """
        grid = self.levels[level]
        if not self._tiles:
            return grid
        row0, row1, column0, column1 = self.bounds(level)
        rows, columns = row1 - row0, column1 - column0
        if rows * columns > LARGEST:
            raise SlamError(
                f"level {level} is {columns} x {rows} cells large: take a coarser level, or gather a part"
            )
        whole = GridLevel(grid.resolution, (rows, columns), grid.resolution * np.array([column0, row0], float))
        whole.bounds = grid.bounds
        whole.log_odds = self.gather(level, whole.box)
        whole.cells = derived(whole.log_odds)
        if level == 0:
            whole.surfels = self.gather(level, whole.box, "surfels")
        return whole

    def _restore(self, pieces: Iterable[SavedCells]) -> None:
        """Put saved cells into an empty map."""
        self.revision = 1
        for key, tile in cut(pieces, len(self.levels), self.revision).items():
            self._store(key, tile)
        for piece in pieces:
            level = self.levels[piece.level]
            level.bounds = around(level.bounds, piece.box)
        for key in keys(self.window):
            self._load(key)

    def _stored_in(self, box: Box) -> Iterator[tuple[Key, Tile]]:
        """The stored tiles in a box of tiles."""
        if (box[1] - box[0]) * (box[3] - box[2]) > len(self._tiles):
            return ((key, tile) for key, tile in self._tiles.items() if holds(box, key))
        return ((key, self._tiles[key]) for key in keys(box) if key in self._tiles)

    def _store(self, key: Key, tile: Tile | None) -> None:
        if tile is not None:
            self._tiles[key] = tile
            self._stored += tile.nbytes

    def _load(self, key: Key) -> None:
        """A stored tile into the window."""
        tile = self._tiles.pop(key, None)
        if tile is None:
            return
        self._stored -= tile.nbytes
        for i, level in enumerate(self.levels):
            level.put(key, tile.log_odds[i], None if i else tile.surfels, tile.revision)

    def __deepcopy__(self, _: Any) -> Any:
        return self.copy()

    def copy(self) -> Any:
        """An independent copy; tiles outside of the window are shared."""
        return self.with_parts(tuple(level.copy() for level in self.levels), self._tiles)

    def with_parts(self, levels: tuple[GridLevel, ...], stored: Mapping[Key, Tile]) -> Any:
        """The same map with other windows, and other tiles outside of them."""
        other = type(self).__new__(type(self))
        other.__dict__.update(self.__dict__, levels=levels, _tiles=dict(stored))
        return other


@dataclass(frozen=True, eq=False)
class MapLevel:
    """One level of a map, with all that is known."""

    map: TiledMap
    number: int

    @property
    def resolution(self) -> float:
        """Metres a cell."""
        return self.map.levels[self.number].resolution

    @property
    def bounds(self) -> Box | None:
        """As of a `GridLevel`."""
        return self.map.levels[self.number].bounds

    @property
    def tile(self) -> int:
        """Cells on a side of a tile."""
        return TILE >> self.number

    def gather(self, box: Box, kind: Kind = "log_odds") -> NDArray[Any]:
        """As of a `GridLevel`."""
        return self.map.gather(self.number, box, kind)

    def seen(self) -> list[Key]:
        """The tiles in which something was seen."""
        return self.map.changed_since(0)


def _level(resolution: float, i: int, window: Box) -> GridLevel:
    n = TILE >> i
    row0, row1, column0, column1 = window
    shape = n * (row1 - row0), n * (column1 - column0)
    origin = TILE * resolution * np.array([column0, row0], float)
    return GridLevel(resolution * 2**i, shape, origin, surfels=i == 0, tile=n)
