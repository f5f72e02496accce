"""Section IV-C: several grids, each half the resolution of the one below, all updated with the same scan.

The map is endless and kept in tiles. The grids are a window on it around the robot, on which the kernels work.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from slam_core.config import ConfigError, MapConfig
from slam_core.kernels.dynamic_objects import by_bearing
from slam_core.kernels.map_update import cell_box
from slam_core.kernels.planar import transform_points
from slam_core.kernels.surfaces import between, is_coarse
from slam_core.mapping.grid import GridLevel
from slam_core.mapping.tiled_map import TiledMap
from slam_core.mapping.tiles import TILE, Box, SavedCells, common
from slam_core.measurements import Float32s, Float64s, Int64s

# Beams end this many of the coarsest cells within the edge: interpolation reads one neighbour.
MARGIN = 2
# Metres between what a scan sees from its predicted pose and the edge of the window: a search goes up to 5 m.
NEAR = 5.0
# Tiles by which the window is larger on each side than it must be: so far the robot goes before the window moves.
SLACK = 2
# Cells from the map's start to a window's furthest edge: float32 holds the place of each, on which kernels rely.
FURTHEST = 1 << 23
TILE_BYTES = 11 * TILE * TILE  # of a tile at most, with all its levels: the room that is kept for one
# A beam passes a cell if it ends this many metres behind it; a cell that is passed keeps so much of its log-odds.
BEHIND = 0.5
CLEARED_CAP = 4.0
# A beam is no surprise if it ends this many metres from an occupied cell.
APART = 0.15


class Pyramid(TiledMap):
    """The map that scans are written into.

    The window moves with the robot, and grows to the range of the laser and some more. What is in a cell does not
    depend on where the window lies.
    updates: scans written so far.
    stopped_at: the limit in megabytes that keeps the map from growing to where beams went; 0 for none.
    ConfigError if the first window is larger than that limit.
    """

    def __init__(self, config: MapConfig) -> None:
        check_room(config)
        super().__init__(config.resolution, config.levels, _first_window(config))
        self.updates = 0
        self.stopped_at = 0.0
        self._limit = config.limit
        self._reach = 0.0  # metres, of the furthest endpoint that the window was made for

    def update(
        self, points: Float32s, cleared: Float32s, laser: Float64s, pose: Float64s, config: MapConfig
    ) -> None:
        """Write one scan at `pose` (3,) into every level.

        points, cleared: (n, 2), (m, 2) endpoints, points in the order of the sweep, and laser: (2,), in the
        stabilised frame, metres.
        """
        walls = between(points, self.levels[0].resolution, longest_gap(points, laser, config.wall_gap))
        n = len(points) + len(walls)
        placed = transform_points(pose, np.concatenate([laser[None], points, walls, cleared]))
        self._limit = config.limit
        if config.grow:
            self._make_room(placed, pose)
        before = self.revisions() if self.stored and self._is_full else None
        start, ends, free = placed[0], placed[1 : 1 + n], placed[1 + n :]
        steps = (log_odds(config.factor_free), log_odds(config.factor_occupied))
        caps = (config.log_odds_min, config.log_odds_max)
        for i, level in enumerate(self.levels):
            behind = 0.0 if i else log_odds(config.factor_behind)
            level.update(start, ends, free, steps, caps, behind, self.revision + 1)
        self.levels[0].place_surfaces(points, start, ends[: len(points)], pose[2])
        self.updates += 1
        self.revision += 1
        if before is not None:
            self._forget(before)

    def clear(self, points: Float32s, laser: Float64s, pose: Float64s, config: MapConfig) -> None:
        """Clear, with one scan at `pose` (3,), occupied cells that beams pass: what was there has moved.

        By the free step alone an obstacle that was seen a hundred times would need hundreds of beams to vanish.
        points: (n, 2), laser: (2,), in the stabilised frame, metres.
        """
        start = transform_points(pose, laser[None])[0]
        beams = by_bearing(start, transform_points(pose, points))
        free = log_odds(config.factor_free)
        passed = [
            level.clear(start, beams, BEHIND + level.resolution, CLEARED_CAP, free, self.revision + 1)
            for level in self.levels
        ]
        self.revision += any(passed)

    def unexpected(self, points: Float32s, pose: Float64s) -> NDArray[np.bool_]:
        """(n,) which points (n, 2) of a scan at `pose` (3,) end in free space: new or moving objects."""
        return self.levels[0].unexpected(points, pose, APART)

    def cover(self, points: Float32s, pose: Float64s) -> None:
        """Move the window to what a scan meets within NEAR of a pose (3,). points: (n, 2) of the scan, metres.

        To be called before cells are read there. While nothing is stored, all that is known is in the window.
        """
        if not self.stored or not len(points):
            return
        reach = math.sqrt(float(np.einsum("ij,ij->i", points, points).max()))
        around = self._around(pose, reach + NEAR)
        if around is None:
            return
        row0, row1, column0, column1 = known = common(around, _wider(self.bounds(), TILE))
        if row0 < row1 and column0 < column1 and common(self.levels[0].box, known) != known:
            self._centre(pose, reach)

    def _make_room(self, placed: Float64s, pose: Float64s) -> None:
        """Have points (n, 2) of a scan at `pose` (3,) lie in the window, as far as `map.limit` allows."""
        if self._holds(placed):
            return
        if self.stored or not self._is_full:
            self._centre(pose, math.sqrt(float(np.square(placed - pose[:2]).sum(axis=1).max())))
        self.stopped_at = 0.0 if self._holds(placed) else self._limit

    def _holds(self, points: Float64s) -> bool:
        """Whether points (n, 2) lie in the window, MARGIN of the coarsest cells from its edge."""
        finest, margin = self.levels[0], MARGIN << (len(self.levels) - 1)
        rows, columns = finest.shape
        row0, row1, column0, column1 = cell_box(points, finest.corner, finest.resolution)
        high, wide = rows - margin, columns - margin
        return bool(margin <= row0 and row1 <= high and margin <= column0 and column1 <= wide)

    def _around(self, pose: Float64s, reach: float) -> Box | None:
        """The cells of the finest level up to `reach` metres from a pose (3,); None beyond all measure."""
        column, row, half = (float(n) / self.levels[0].resolution for n in (pose[0], pose[1], reach))
        if not max(abs(column), abs(row)) + half < FURTHEST:  # as it is for what is no number
            return None
        row0, column0 = math.floor(row - half), math.floor(column - half)
        return row0, math.floor(row + half) + 1, column0, math.floor(column + half) + 1

    def _centre(self, pose: Float64s, reach: float) -> None:
        """Move the window around a pose (3,); it grows to endpoints `reach` metres away, up to half the limit."""
        around = self._around(pose, max(self._reach, reach) + NEAR)
        if around is None:
            return
        self._reach = max(self._reach, reach)
        largest = math.isqrt(int(0.5 * self._limit / megabytes(TILE**2, len(self.levels))))
        side = min(math.ceil((around[1] - around[0]) / TILE) + 2 * SLACK, largest)
        now, window = self.window, []
        for i in (0, 2):
            length, middle = max(now[i + 1] - now[i], side), (around[i] + around[i + 1]) / (2 * TILE)
            first = math.floor(middle - length / 2 + 0.5)
            window += [first, first + length]
        if (box := (window[0], window[1], window[2], window[3])) != now:
            self.move(box)

    @property
    def _is_full(self) -> bool:
        """Whether there would be no room for all tiles of the window, were they known and stored."""
        rows, columns = self.levels[0].shape
        return self.nbytes + rows * columns // TILE**2 * TILE_BYTES > self._limit * 1e6

    def _forget(self, before: Int64s) -> None:
        """Take the tiles of the window out that were not known `before`: there is no room for them."""
        row, _, column, _ = self.window
        for y, x in np.argwhere((before == 0) & (self.revisions() > 0)).tolist():
            for level in self.levels:
                blank = np.zeros((level.tile, level.tile), np.float32)
                level.put((column + x, row + y), blank, None, 0)
            self.stopped_at = self._limit

    def probability(self, level: int = 0) -> Float32s:
        """M of eq. (4) on a level, 0 the finest: (rows, columns) of `whole`, row 0 the lowest y; a copy.

        0.5 is unknown.
        """
        return self.whole(level).probability

    def restore(self, pieces: Sequence[SavedCells], limit: float) -> bool:
        """Put saved cells into an empty pyramid; False if that needs more than `limit` megabytes."""
        if any(max(map(abs, piece.box)) << piece.level >= FURTHEST for piece in pieces):
            return False
        self._restore(pieces)
        return self.nbytes <= 1e6 * limit


def _first_window(config: MapConfig) -> Box:
    """The tiles around `map.size` cells with the start where it is asked for."""
    ends = []
    for start in (config.start_y, config.start_x):
        first, last = -start * config.size / TILE, (1.0 - start) * config.size / TILE
        ends += [math.floor(first), math.ceil(last)]
    row0, row1, column0, column1 = ends
    return row0, row1, column0, column1


def _wider(box: Box, by: int) -> Box:
    return box[0] - by, box[1] + by, box[2] - by, box[3] + by


def check_room(config: MapConfig) -> None:
    """ConfigError if the first window takes more memory than the map may."""
    row0, row1, column0, column1 = _first_window(config)
    needed = megabytes((row1 - row0) * (column1 - column0) * TILE**2, config.levels)
    if needed > config.limit:
        raise ConfigError(
            f"the first map of {config.size} x {config.size} cells takes {needed:.0f} MB, map.limit is"
            f" {config.limit:g} MB: choose a smaller map.size or a higher map.limit"
        )


def megabytes(cells: int, levels: int) -> float:
    """Memory of a window with so many cells on its finest level."""
    shares = math.fsum(0.25**i for i in range(levels))
    return (GridLevel.BYTES * shares + GridLevel.SURFEL_BYTES) * cells / 1e6


def longest_gap(points: Float32s, laser: Float64s, fine: float) -> float:
    """Metres between endpoints (n, 2) of one wall that are filled: `fine`, and twice that for a coarse scanner.

    Half as many beams leave gaps twice as wide in the same wall.
    points: in the order of the sweep, and laser: (2,), metres.
    """
    return 2.0 * fine if fine and is_coarse(points, laser) else fine


def log_odds(probability: float) -> float:
    """ln(p / (1 - p))."""
    return math.log(probability / (1.0 - probability))
