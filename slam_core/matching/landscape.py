"""The cost of eq. (7) around a pose: what the matcher descends."""

import numpy as np

from slam_core.kernels.gauss_newton import workspace
from slam_core.kernels.landscape import costs_at
from slam_core.mapping.grid import GridLevel
from slam_core.matching.matcher import beams_of, level_of
from slam_core.measurements import Float32s, Float64s


def costs(level: GridLevel, points: Float32s, poses: Float64s) -> Float64s:
    """(k,) the cost of eq. (7) of endpoints (n, 2) in the stabilised frame, metres, at poses (k, 3) in the map.

    What lies outside of the window of the level counts as unknown.
    """
    found, residuals = np.empty(len(poses)), np.empty(len(points), np.float32)
    costs_at(level_of(level), beams_of(points), poses, residuals, workspace(), found)
    return found
