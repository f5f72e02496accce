"""Section IV-C: several grids, each half the resolution of the one below, all updated with the same scan."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from slam_core.config import ConfigError, MapConfig
from slam_core.kernels.dynamic_objects import by_bearing
from slam_core.kernels.map_update import cell_box
from slam_core.kernels.planar import transform_points
from slam_core.kernels.surfaces import between
from slam_core.mapping.grid import GridLevel
from slam_core.measurements import Float32s, Float64s

# Beams end this many of the coarsest cells within the edge: interpolation reads one neighbour.
MARGIN = 2
# Growing a side adds at least this part of the map's length there, which keeps growing rare.
GROWTH = 0.25
# Cells on a side at most: float32 holds the place of each, on which the kernels rely.
LONGEST_SIDE = 1 << 24
# A beam passes a cell if it ends this many metres behind it; a cell that is passed keeps so much of its log-odds.
BEHIND = 0.5
CLEARED_CAP = 4.0
# A beam is no surprise if it ends this many metres from an occupied cell.
APART = 0.15

SavedCells = tuple[NDArray[np.int64], Float32s, NDArray[np.uint32] | None]
"""Of a level the lattice corner, the log-odds, and the surfels if there are any."""


class Pyramid:
    """levels: finest first; they share the corner at `origin`. updates: scans written so far.

    revision: grows with every change of a cell.
    stopped_at: the limit in megabytes that keeps the map from growing to where beams went; 0 for none.
    ConfigError if the first map is larger than that limit.
    """

    def __init__(self, config: MapConfig) -> None:
        check_room(config)
        # Lengths are whole cells of the coarsest level, so that all levels cover the same area.
        self._block = 2 ** (config.levels - 1)
        size = _whole(config.size, self._block)
        start = np.array([config.start_x, config.start_y])
        origin = -config.resolution * self._block * np.rint(start * size / self._block)
        self.levels = tuple(
            GridLevel(config.resolution * 2**i, (size >> i,) * 2, origin, surfels=i == 0)
            for i in range(config.levels)
        )
        self.updates = 0
        self.revision = 0
        self.stopped_at = 0.0

    def update(
        self, points: Float32s, cleared: Float32s, laser: Float64s, pose: Float64s, config: MapConfig
    ) -> None:
        """Write one scan at `pose` (3,) into every level.

        points, cleared: (n, 2), (m, 2) endpoints, points in the order of the sweep, and laser: (2,), in the
        stabilised frame, metres.
        """
        walls = between(points, self.levels[0].resolution, config.wall_gap)
        n = len(points) + len(walls)
        placed = transform_points(pose, np.concatenate([laser[None], points, walls, cleared]))
        if config.grow:
            self._make_room(placed, config.limit)
        start, ends, free = placed[0], placed[1 : 1 + n], placed[1 + n :]
        steps = (log_odds(config.factor_free), log_odds(config.factor_occupied))
        caps = (config.log_odds_min, config.log_odds_max)
        for i, level in enumerate(self.levels):
            behind = 0.0 if i else log_odds(config.factor_behind)
            level.update(start, ends, free, steps, caps, behind)
        self.levels[0].place_surfaces(points, start, ends[: len(points)], pose[2])
        self.updates += 1
        self.revision += 1

    def clear(self, points: Float32s, laser: Float64s, pose: Float64s, config: MapConfig) -> None:
        """Clear, with one scan at `pose` (3,), occupied cells that beams pass: what was there has moved.

        By the free step alone an obstacle that was seen a hundred times would need hundreds of beams to vanish.
        points: (n, 2), laser: (2,), in the stabilised frame, metres.
        """
        start = transform_points(pose, laser[None])[0]
        beams = by_bearing(start, transform_points(pose, points))
        free = log_odds(config.factor_free)
        passed = [level.clear(start, beams, BEHIND + level.resolution, CLEARED_CAP, free) for level in self.levels]
        self.revision += any(passed)

    def unexpected(self, points: Float32s, pose: Float64s) -> NDArray[np.bool_]:
        """(n,) which points (n, 2) of a scan at `pose` (3,) end in free space: new or moving objects."""
        return self.levels[0].unexpected(points, pose, APART)

    def _make_room(self, points: Float64s, limit: float) -> None:
        """Grow every level by the same area, so that points (n, 2) lie within; not beyond `limit` megabytes."""
        finest = self.levels[0]
        rows, columns = finest.shape
        row0, row1, column0, column1 = cell_box(points, finest.corner, finest.resolution)
        below, above = self._missing(row0, row1, rows)
        left, right = self._missing(column0, column1, columns)
        if not (below or above or left or right):
            return
        high, wide = rows + below + above, columns + left + right
        fits = max(high, wide) <= LONGEST_SIDE and megabytes(high * wide, len(self.levels)) <= limit
        self.stopped_at = 0.0 if fits else limit
        if not self.stopped_at:
            for i, level in enumerate(self.levels):
                level.grow(below >> i, above >> i, left >> i, right >> i)

    def _missing(self, first: int, end: int, size: int) -> tuple[int, int]:
        """How many of the finest cells to add before and behind `size` of them, to reach first and last."""
        margin = MARGIN * self._block
        lacking = margin - first, end + margin - size
        before, behind = (_whole(max(n, int(GROWTH * size)), self._block) if n > 0 else 0 for n in lacking)
        return before, behind

    def probability(self, level: int = 0) -> Float32s:
        """M of eq. (4) on a level, 0 the finest: (rows, columns), row 0 the lowest y, 0.5 unknown; a copy."""
        return self.levels[level].probability

    @property
    def empty(self) -> bool:
        """Whether no cell was ever touched."""
        return not self.levels[0].known[1]

    def restore(self, cells: Sequence[SavedCells], limit: float) -> bool:
        """Put saved cells into an empty pyramid, finest level first.

        The map grows to take them in; False, and nothing is put, if that needs more than `limit` megabytes.
        """
        ends = []
        for level, (corner, values, _) in zip(self.levels, cells, strict=True):
            ends += [level.resolution * (corner + 0.5), level.resolution * (corner + values.shape[::-1] - 0.5)]
        self._make_room(np.array(ends), limit)
        if self.stopped_at:
            return False
        for level, (corner, values, surfels) in zip(self.levels, cells, strict=True):
            level.put(corner, values, surfels)
        return True

    def copy(self) -> "Pyramid":
        """An independent copy."""
        other = Pyramid.__new__(Pyramid)
        other.__dict__.update(self.__dict__, levels=tuple(level.copy() for level in self.levels))
        return other


def check_room(config: MapConfig) -> None:
    """ConfigError if the first map takes more memory than the map may."""
    needed = megabytes(config.size**2, config.levels)
    if needed > config.limit:
        raise ConfigError(
            f"the first map of {config.size} x {config.size} cells takes {needed:.0f} MB, map.limit is"
            f" {config.limit:g} MB: choose a smaller map.size or a higher map.limit"
        )


def megabytes(cells: int, levels: int) -> float:
    """Memory of a pyramid with so many cells on its finest level."""
    shares = math.fsum(0.25**i for i in range(levels))
    return (GridLevel.BYTES * shares + GridLevel.SURFEL_BYTES) * cells / 1e6


def _whole(n: int, block: int) -> int:
    """`n` rounded up to a multiple of `block`."""
    return -(-n // block) * block


def log_odds(probability: float) -> float:
    """ln(p / (1 - p))."""
    return math.log(probability / (1.0 - probability))
