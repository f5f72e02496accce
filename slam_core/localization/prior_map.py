"""A prior map: saved cells, whether the run writes them, and where the robot starts."""

from copy import deepcopy
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slam_core.config import MapConfig
from slam_core.errors import SlamError
from slam_core.mapping.pyramid import Pyramid
from slam_core.measurements import Float32s, Float64s


class MapError(SlamError):
    """A saved map cannot be used: the message names it and the remedy."""


@dataclass(frozen=True, slots=True, eq=False)
class SavedLevel:
    """The known part of one level: log_odds (rows, columns), row 0 the lowest y, 0 unknown.

    resolution: metres a cell. corner: (2,) column and row of cell [0, 0] in the lattice whose cell (0, 0) begins
    at the map's origin. surfels: (rows, columns) as in a GridLevel; None if it has none or they were not saved.
    """

    resolution: float
    corner: NDArray[np.int64]
    log_odds: Float32s
    surfels: NDArray[np.uint32] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class PriorMap:
    """What a run begins with. levels: finest first. write: the map goes on; otherwise it stays as it is.

    start: (3,) x, y in metres and heading in radians in this map; None when the robot may be anywhere in it.
    """

    name: str
    levels: tuple[SavedLevel, ...]
    write: bool = False
    start: Float64s | None = None

    def check(self, config: MapConfig) -> None:
        """Refuse settings that the map was not made with: MapError gives those it was made with."""
        resolution, count = self.levels[0].resolution, len(self.levels)
        if count != config.levels or abs(resolution - config.resolution) > 1e-9:
            raise MapError(
                f"{self.name} has {count} levels from {resolution:g} m up, the settings {config.levels} from "
                f"{config.resolution:g} m: set map.levels to {count} and map.resolution to {resolution:g}"
            )

    def pyramid(self, config: MapConfig) -> Pyramid:
        """A pyramid of its own with every saved cell in it; MapError if the settings do not fit."""
        self.check(config)
        pyramid = Pyramid(config)
        cells = [(level.corner, level.log_odds, level.surfels) for level in self.levels]
        if not pyramid.restore(cells, config.limit):
            raise MapError(f"{self.name} needs more than {config.limit:g} MB: raise map.limit")
        return pyramid


def saved_levels(pyramid: Pyramid, *, copied: bool = False) -> tuple[SavedLevel, ...]:
    """The known part of every level, to be kept; views of the pyramid's cells unless they are `copied`."""
    levels = []
    for level in pyramid.levels:
        row0, row1, column0, column1 = level.known
        corner, box = level.corner + np.array([column0, row0]), np.s_[row0:row1, column0:column1]
        surfels = level.surfels[box] if len(level.surfels) else None
        saved = SavedLevel(level.resolution, corner, level.log_odds[box], surfels)
        levels.append(deepcopy(saved) if copied else saved)
    return tuple(levels)
