"""Section IV: one occupancy grid of log-odds with the probability that the matcher reads."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from slam_core.kernels.mapping import cells_of, write_scan
from slam_core.measurements import Float32s, Float64s


class GridLevel:
    """A square grid. Row 0 is the lowest y; `origin` (2,) is the corner of cell [0, 0] in map coordinates.

    log_odds: (rows, columns), 0 unknown. probability: the same as M of eq. (4), 0.5 unknown.
    known: row0, row1, column0, column1 (half open) around every cell that was ever touched.
    Memory: 9 bytes a cell.
    """

    def __init__(self, resolution: float, shape: tuple[int, int], origin: Float64s) -> None:
        self.resolution = resolution
        self.origin = origin
        self.log_odds: Float32s = np.zeros(shape, np.float32)
        self.probability: Float32s = np.full(shape, 0.5, np.float32)
        self._marks = _no_marks(shape)
        self.known = (0, 0, 0, 0)

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        rows, columns = self.log_odds.shape
        return rows, columns

    def cell_of(self, x: Any, y: Any) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Column and row of map coordinates in metres; may lie off the map."""
        u = np.floor((np.asarray(x, np.float64) - self.origin[0]) / self.resolution).astype(np.int64)
        v = np.floor((np.asarray(y, np.float64) - self.origin[1]) / self.resolution).astype(np.int64)
        return u, v

    def update(
        self,
        start: Float64s,
        ends: Float64s,
        cleared: Float64s,
        steps: tuple[float, float],
        caps: tuple[float, float],
    ) -> None:
        """Write one scan: every touched cell changes once, ends by the occupied step, ways by the free step.

        start: (2,) laser. ends: (n, 2) endpoints. cleared: (m, 2) ends of beams that hit nothing. Map metres.
        steps: free (negative) and occupied log-odds. caps: lowest and highest log-odds.
        """
        laser, hits, free = (
            cells_of(np.ascontiguousarray(points), self.origin, self.resolution)
            for points in (start[None], ends, cleared)
        )
        limits = (np.float32(x) for x in (*steps, *caps))
        touched = write_scan(self.log_odds, self.probability, self._marks, laser, hits, free, *limits)
        row0, row1, column0, column1 = self.known if self.known[1] else touched
        self.known = (
            min(row0, touched[0]),
            max(row1, touched[1]),
            min(column0, touched[2]),
            max(column1, touched[3]),
        )

    def classes(self) -> NDArray[np.uint8]:
        """The known box as 0 unknown, 1 free, 2 occupied; a copy."""
        row0, row1, column0, column1 = self.known
        box = self.log_odds[row0:row1, column0:column1]
        return (box < 0).astype(np.uint8) + 2 * (box > 0).astype(np.uint8)

    def occupancy(self) -> NDArray[np.int8]:
        """The whole level as an OccupancyGrid: -1 unknown, else probability in percent."""
        percent = np.rint(100 * self.probability).astype(np.int8)
        return np.where(self.log_odds == 0, np.int8(-1), percent).astype(np.int8)

    def copy(self) -> "GridLevel":
        """An independent copy."""
        other = GridLevel.__new__(GridLevel)
        other.__dict__.update({k: v.copy() if isinstance(v, np.ndarray) else v for k, v in self.__dict__.items()})
        return other


def _no_marks(shape: tuple[int, int]) -> NDArray[np.uint8]:
    """Rows an odd number of cache lines apart: cells above each other do not compete for the same lines."""
    rows, columns = shape
    return np.zeros((rows, 64 * (columns // 64 + 1 | 1)), np.uint8)
