"""A level of the map as a page or a file shows it."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

UNKNOWN, FREE, OCCUPIED = range(3)  # classes of a cell
PALETTE = (232, 235, 240, 255, 255, 255, 24, 32, 44)  # RGB of each class, in files


@dataclass(frozen=True, slots=True, eq=False)
class MapImage:
    """One level as classes, cropped to what is known. Row 0 is the lowest y.

    cells: (rows, cols) uint8, UNKNOWN, FREE or OCCUPIED. x, y: map coordinates of the lower left corner of
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
