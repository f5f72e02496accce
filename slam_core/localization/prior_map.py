"""A prior map: saved cells, whether the run writes them, and where the robot starts."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slam_core.config import MapConfig
from slam_core.errors import SlamError
from slam_core.mapping.pyramid import Pyramid
from slam_core.mapping.tiles import TILE, Box, SavedCells, around, square
from slam_core.measurements import Float32s, Float64s

DENSE = 1 << 25  # cells of the finest level: of a map that reaches further only the parts that were seen are saved
PIECE = 16  # tiles on a side of such a part


class MapError(SlamError):
    """A saved map cannot be used: the message names it and the remedy."""


@dataclass(frozen=True, slots=True, eq=False)
class SavedLevel:
    """The known cells of one level, or of a part of it: log_odds (rows, columns), row 0 the lowest y, 0 unknown.

    resolution: metres a cell. corner: (2,) column and row of cell [0, 0] in the lattice whose cell (0, 0) begins
    at the map's origin. surfels: (rows, columns) as in a GridLevel; None if it has none or they were not saved.
    """

    resolution: float
    corner: NDArray[np.int64]
    log_odds: Float32s
    surfels: NDArray[np.uint32] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class PriorMap:
    """What a run begins with. levels: finest first, each in one or more parts.

    write: the map goes on; otherwise it stays as it is.
    start: (3,) x, y in metres and heading in radians in this map; None when the robot may be anywhere in it.
    """

    name: str
    levels: tuple[SavedLevel, ...]
    write: bool = False
    start: Float64s | None = None

    def check(self, config: MapConfig) -> None:
        """Refuse settings that the map was not made with: MapError gives those it was made with."""
        resolution, count = self.levels[0].resolution, len(self._resolutions)
        if count != config.levels or abs(resolution - config.resolution) > 1e-9:
            raise MapError(
                f"{self.name} has {count} levels from {resolution:g} m up, the settings {config.levels} from "
                f"{config.resolution:g} m: set map.levels to {count} and map.resolution to {resolution:g}"
            )

    def pyramid(self, config: MapConfig) -> Pyramid:
        """A pyramid of its own with every saved cell in it; MapError if the settings do not fit."""
        self.check(config)
        pyramid, resolutions = Pyramid(config), self._resolutions
        pieces = [
            SavedCells(resolutions.index(level.resolution), level.corner, level.log_odds, level.surfels)
            for level in self.levels
        ]
        if not pyramid.restore(pieces, config.limit):
            raise MapError(f"{self.name} needs more than {config.limit:g} MB: raise map.limit")
        return pyramid

    @property
    def _resolutions(self) -> list[float]:
        return list(dict.fromkeys(level.resolution for level in self.levels))


def saved_levels(pyramid: Pyramid, *, copied: bool = False) -> tuple[SavedLevel, ...]:
    """The known part of every level, to be kept; in several parts if the map reaches over more than DENSE cells.

    While all of it lies in the window, the cells are views of the pyramid's unless they are `copied`.
    """
    row0, row1, column0, column1 = pyramid.bounds()
    if (row1 - row0) * (column1 - column0) > DENSE:
        boxes = _parts(pyramid)
        return tuple(_saved(pyramid, i, _scaled(box, i)) for i in range(len(pyramid.levels)) for box in boxes)
    if pyramid.stored or copied:
        return tuple(_saved(pyramid, i, pyramid.bounds(i)) for i in range(len(pyramid.levels)))
    levels = []
    for level in pyramid.levels:
        row0, row1, column0, column1 = level.known
        corner, box = level.corner + np.array([column0, row0]), np.s_[row0:row1, column0:column1]
        surfels = level.surfels[box] if len(level.surfels) else None
        levels.append(SavedLevel(level.resolution, corner, level.log_odds[box], surfels))
    return tuple(levels)


def _saved(pyramid: Pyramid, i: int, box: Box) -> SavedLevel:
    corner, surfels = np.array([box[2], box[0]]), None if i else pyramid.gather(0, box, "surfels")
    return SavedLevel(pyramid.levels[i].resolution, corner, pyramid.gather(i, box), surfels)


def _parts(pyramid: Pyramid) -> list[Box]:
    """Boxes of cells of the finest level that hold all known tiles, none larger than PIECE tiles on a side."""
    boxes: dict[tuple[int, int], Box] = {}
    for column, row in sorted(pyramid.changed_since(0)):
        key = column // PIECE, row // PIECE
        boxes[key] = around(boxes.get(key), square((column, row), TILE))
    return list(boxes.values())


def _scaled(box: Box, level: int) -> Box:
    """The cells of a level in a box of cells of the finest one, of whole tiles."""
    row0, row1, column0, column1 = box
    return row0 >> level, row1 >> level, column0 >> level, column1 >> level
