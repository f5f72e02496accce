"""Section IV-A: the occupancy grid, its update by a scan, and access to it between the cells, eqs. (4)-(6)."""

import math

import numpy as np
from numpy.typing import NDArray

from slam_core.measurements import Float64s, Int64s

Cells = NDArray[np.int64]
UNKNOWN = 0.5


class OccupancyGrid:
    """Log-odds of the occupancy, 0 for unknown.

    resolution: metres a cell. corner: (2,) column and row of cell [0, 0] in the lattice that begins at the map's
    origin. log_odds: (rows, columns), row 0 the lowest y.
    """

    def __init__(self, resolution: float, corner: Int64s, log_odds: Float64s) -> None:
        self.resolution, self.corner, self.log_odds = resolution, corner, log_odds

    @property
    def probability(self) -> Float64s:
        """The occupancy of every cell, 1 / (1 + exp(-log_odds))."""
        occupancy: Float64s = 1.0 / (1.0 + np.exp(-self.log_odds))
        return occupancy

    def cells_of(self, points: Float64s) -> Cells:
        """(n, 2) column and row of points (n, 2) in map coordinates, metres; may lie off the grid."""
        return np.floor(points / self.resolution).astype(np.int64) - self.corner

    def update(self, laser: Float64s, ends: Float64s, steps: tuple[float, float], cap: float) -> None:
        """Write a scan: cells that beams cross take the free step, cells that they end in the occupied step.

        laser: (2,), ends: (n, 2) in map coordinates. steps: free and occupied log-odds. Each cell changes once; a
        cell that a beam ends in takes no free step. Beams that end off the grid are left out.
        """
        start, hits = self.cells_of(laser[None])[0], self.cells_of(ends)
        rows, columns = self.log_odds.shape
        hits = hits[((hits >= 0) & (hits < (columns, rows))).all(axis=1)]
        crossed, hit = np.zeros((rows, columns), bool), np.zeros((rows, columns), bool)
        for end in np.unique(hits, axis=0):
            ray = bresenham(start, end)
            crossed[ray[:, 1], ray[:, 0]] = True
        hit[hits[:, 1], hits[:, 0]] = True
        self.log_odds[crossed & ~hit] += steps[0]
        self.log_odds[hit] += steps[1]
        np.clip(self.log_odds, -cap, cap, out=self.log_odds)

    def interpolate(self, points: Float64s) -> tuple[Float64s, Float64s]:
        """M (n,) of eq. (4) and its gradient (n, 2) of eqs. (5)-(6) per metre, at points (n, 2) of the map.

        The sample of a cell lies at its centre. Points without four cells around them are unknown, gradient 0.
        """
        u = points / self.resolution - self.corner - 0.5  # in cells from the centre of cell [0, 0]
        first = np.floor(u).astype(np.int64)
        rows, columns = self.log_odds.shape
        inside = ((first >= 0) & (first < (columns - 1, rows - 1))).all(axis=1)
        M, gradient = np.full(len(points), UNKNOWN), np.zeros((len(points), 2))
        (x0, y0), (x, y) = first[inside].T, (u - first)[inside].T
        P = self.probability
        P00, P10, P01, P11 = P[y0, x0], P[y0, x0 + 1], P[y0 + 1, x0], P[y0 + 1, x0 + 1]
        M[inside] = y * (x * P11 + (1 - x) * P01) + (1 - y) * (x * P10 + (1 - x) * P00)  # (4)
        gradient[inside, 0] = y * (P11 - P01) + (1 - y) * (P10 - P00)  # (5)
        gradient[inside, 1] = x * (P11 - P10) + (1 - x) * (P01 - P00)  # (6)
        return M, gradient / self.resolution


def bresenham(start: Int64s, end: Int64s) -> Cells:
    """The cells (n, 2) of a line from one cell up to another, without that; halves round towards the start."""
    delta = end - start
    n = int(np.abs(delta).max())
    k = np.arange(n)[:, None]
    # Along the longer axis k, along the other k * short / n, rounded.
    cells: Cells = start + np.sign(delta) * ((2 * k * np.abs(delta) + n - 1) // max(2 * n, 1))
    return cells


def log_odds(probability: float) -> float:
    """ln(p / (1 - p))."""
    return math.log(probability / (1.0 - probability))
