"""The levels of the map as images of classes: unknown, free, occupied."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from slam_core.mapping.pyramid import Pyramid


@dataclass(frozen=True, slots=True, eq=False)
class MapImage:
    """One level as classes, cropped to what is known. Row 0 is the lowest y.

    cells: (rows, cols) uint8, 0 unknown, 1 free, 2 occupied. x, y: map coordinates of the lower left corner of
    cells[0, 0]. revision grows whenever the level changes. surfels: of the same cells as in a GridLevel; no rows
    if the level has none.
    """

    level: int
    resolution: float
    x: float
    y: float
    cells: NDArray[np.uint8]
    revision: int
    surfels: NDArray[np.uint32] = field(default_factory=lambda: np.zeros((0, 0), np.uint32))


def map_images(pyramid: Pyramid, revision: int = 0) -> tuple[MapImage, ...]:
    """The known part of every level, finest first; none before the first map update."""
    images = []
    for number, level in enumerate(pyramid.levels):
        row, end, column, last = level.known
        x, y = level.resolution * (level.corner + np.array([column, row]))
        cells = level.classes()
        if cells.size:
            surfels = level.surfels[row:end, column:last].copy()
            images.append(MapImage(number, level.resolution, float(x), float(y), cells, revision, surfels))
    return tuple(images)
