"""Section IV: one occupancy grid of log-odds with the probability that the matcher reads."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from slam_core.kernels.bilinear import UNKNOWN, WHOLE
from slam_core.kernels.dynamic_objects import clear_passed, ends_in_free_space
from slam_core.kernels.map_update import derive_cells, write_scan
from slam_core.kernels.surfels import write_surfels
from slam_core.measurements import Float32s, Float64s


class GridLevel:
    """A window on the endless lattice of cells in which the map's start is the corner of cell (0, 0).

    origin: (2,) lower left corner of the window in map coordinates, in whole cells. Row 0 is the lowest y.
    corner: (2,) column and row in the lattice of the window's cell [0, 0].
    log_odds: (rows, columns), 0 unknown. cells: the same as M of eq. (4), in parts of 2^16, 2^15 unknown.
    known: row0, row1, column0, column1 (half open) around every cell that was ever touched.
    surfels: where in each cell a surface lies, as `kernels.surfels` packs it, 0 for none; no rows if not kept.
    """

    BYTES = 7  # of memory a cell: four in log_odds, two in cells, one mark
    SURFEL_BYTES = 4

    def __init__(
        self, resolution: float, shape: tuple[int, int], origin: Float64s, *, surfels: bool = False
    ) -> None:
        self.resolution = resolution
        self.corner: NDArray[np.int64] = np.rint(origin / resolution).astype(np.int64)
        self.log_odds: Float32s = np.zeros(shape, np.float32)
        self.cells: NDArray[np.uint16] = np.full(shape, UNKNOWN)
        self.surfels: NDArray[np.uint32] = np.zeros(shape if surfels else (0, 0), np.uint32)
        self._marks = _no_marks(shape)
        self.known = (0, 0, 0, 0)

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        rows, columns = self.log_odds.shape
        return rows, columns

    @property
    def probability(self) -> Float32s:
        """M of eq. (4) as a number, (rows, columns); a copy."""
        copy = self.cells * np.float32(1.0 / WHOLE)
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

    def grow(self, below: int, above: int, left: int, right: int) -> None:
        """Add so many unknown rows and columns on each side; every cell keeps its place in the map."""
        sides = ((below, above), (left, right))
        self.log_odds = np.pad(self.log_odds, sides)
        self.cells = np.pad(self.cells, sides, constant_values=UNKNOWN)
        if len(self.surfels):
            self.surfels = np.pad(self.surfels, sides)
        self._marks = _no_marks(self.shape)
        self.corner = self.corner - (left, below)
        row0, row1, column0, column1 = self.known
        if row1:
            self.known = (row0 + below, row1 + below, column0 + left, column1 + left)

    def update(
        self,
        start: Float64s,
        ends: Float64s,
        cleared: Float64s,
        steps: tuple[float, float],
        caps: tuple[float, float],
        behind: float = 0.0,
    ) -> None:
        """Write one scan: every touched cell changes once, ends by the occupied step, ways by the free step.

        start: (2,) laser. ends: (n, 2) endpoints. cleared: (m, 2) ends of beams that hit nothing. Map metres.
        steps: free (negative) and occupied log-odds. caps: lowest and highest log-odds. behind: how low the cells
        behind the ends may sink by this; 0 leaves them alone.
        """
        grid = self.log_odds, self.cells, self._marks
        changes = *steps, *caps, behind
        touched = write_scan(grid, self.corner, self.resolution, start, ends, cleared, changes)
        row0, row1, column0, column1 = self.known if self.known[1] else touched
        self.known = (
            min(row0, touched[0]),
            max(row1, touched[1]),
            min(column0, touched[2]),
            max(column1, touched[3]),
        )

    def place_surfaces(self, points: Float32s, start: Float64s, ends: Float64s, psi: float) -> None:
        """Take one scan's ends into the surfels.

        points: (n, 2) in the stabilised frame, whose heading is psi, in the order of the sweep. start: (2,) laser.
        ends: (n, 2) the points in the map. Metres.
        """
        write_surfels(self.surfels, self.corner, self.resolution, points, start, ends, psi)

    def put(
        self, corner: NDArray[np.int64], log_odds: Float32s, surfels: NDArray[np.uint32] | None = None
    ) -> None:
        """Set a rectangle of cells (rows, columns) whose first is at a lattice corner; it must lie within.

        surfels: as many, if this level keeps them.
        """
        (column, row), (rows, columns) = (corner - self.corner).tolist(), log_odds.shape
        box = slice(row, row + rows), slice(column, column + columns)
        self.log_odds[box] = log_odds
        derive_cells(self.log_odds[box], self.cells[box])
        if surfels is not None and len(self.surfels):
            self.surfels[box] = surfels
        self.known = (row, row + rows, column, column + columns)

    def clear(
        self,
        laser: Float64s,
        beams: tuple[Float64s, NDArray[np.int64], Float64s, Float64s],
        behind: float,
        most: float,
        free: float,
    ) -> int:
        """Take `most` log-odds at most and the step `free` from every occupied cell that beams pass.

        laser: (2,) map metres. beams: their ends `by_bearing`. behind: metres. Returns how many.
        """
        grid, window = (self.log_odds, self.cells, self.surfels), (self.corner, self.resolution, self.known)
        clearing = np.float32(behind), np.float32(most), np.float32(free)
        return int(clear_passed(grid, *window, laser, beams, clearing))

    def unexpected(self, points: Float32s, pose: Float64s, apart: float) -> NDArray[np.bool_]:
        """Which points (n, 2) of a scan at `pose` (3,) lie in free space, `apart` metres from what is occupied."""
        found = np.empty(len(points), np.bool_)
        around = round(apart / self.resolution)
        ends_in_free_space(self.cells, self.corner, self.resolution, points, pose, around, found)
        return found

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
