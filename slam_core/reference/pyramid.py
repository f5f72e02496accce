"""Section IV-C: several grids, each with half the resolution of the one before, all updated with the same scan."""

import numpy as np

from slam_core.config import MapConfig
from slam_core.measurements import Float64s
from slam_core.reference.occupancy_grid import OccupancyGrid, log_odds


class Pyramid:
    """levels: finest first. They cover the same square, whose size is fixed; the start lies in its middle."""

    def __init__(self, config: MapConfig) -> None:
        self._config = config
        self.levels = tuple(self._level(i) for i in range(config.levels))

    def _level(self, i: int) -> OccupancyGrid:
        size = self._config.size >> i
        corner = np.full(2, -(size // 2))
        return OccupancyGrid(self._config.resolution * 2**i, corner, np.zeros((size, size)))

    def update(self, laser: Float64s, ends: Float64s) -> None:
        """Write a scan into every level, which is not derived from the finer one. Map coordinates, metres."""
        config = self._config
        steps = log_odds(config.factor_free), log_odds(config.factor_occupied)
        for level in self.levels:
            level.update(laser, ends, steps, config.log_odds_max)
