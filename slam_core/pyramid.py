"""Section IV-C: several grids, each half the resolution of the one below, all updated with the same scan."""

import math

import numpy as np

from slam_core import geometry
from slam_core.config import MapConfig
from slam_core.grid import GridLevel
from slam_core.measurements import Float32s, Float64s


class Pyramid:
    """levels: finest first; they share the corner at `origin`. updates: scans written so far."""

    def __init__(self, config: MapConfig) -> None:
        side = config.resolution * config.size
        origin = np.array([-config.start_x * side, -config.start_y * side])
        self.levels = tuple(
            GridLevel(config.resolution * 2**i, (max(2, config.size >> i),) * 2, origin)
            for i in range(config.levels)
        )
        self.updates = 0

    def update(
        self, points: Float32s, cleared: Float32s, laser: Float64s, pose: Float64s, config: MapConfig
    ) -> None:
        """Write one scan at `pose` (3,) into every level.

        points, cleared: (n, 2), (m, 2) endpoints, and laser: (2,), in the stabilised frame, metres.
        """
        ends = geometry.transform_points(pose, points)
        free = geometry.transform_points(pose, cleared)
        start = geometry.transform_points(pose, laser[None])[0]
        steps = (log_odds(config.factor_free), log_odds(config.factor_occupied))
        for level in self.levels:
            level.update(start, ends, free, steps, (config.log_odds_min, config.log_odds_max))
        self.updates += 1

    def copy(self) -> "Pyramid":
        """An independent copy."""
        other = Pyramid.__new__(Pyramid)
        other.levels = tuple(level.copy() for level in self.levels)
        other.updates = self.updates
        return other


def log_odds(probability: float) -> float:
    """ln(p / (1 - p))."""
    return math.log(probability / (1.0 - probability))
