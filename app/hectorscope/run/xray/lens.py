"""Access to the map between its cells: eqs. (4)-(6) at one place, beside finite differences."""

import math
from dataclasses import dataclass

import numpy as np

from hectorscope.run.xray.match_problem import MatchProblem
from slam_core.measurements import Float64s

PART = 1e-3  # of a cell: half the width of a finite difference


@dataclass(frozen=True, eq=False)
class Lens:
    """The map at a place (metres). cell: column and row of P00 in the lattice. corners: P00, P10, P01, P11.

    share: (2,) the place between P00 and P11, 0..1. M: of (4). gradient: (2,) of (5)-(6), per metre; differences:
    (2,) the same by finite differences.
    """

    level: int
    resolution: float
    place: tuple[float, float]
    cell: tuple[int, int]
    corners: tuple[float, float, float, float]
    share: Float64s
    M: float
    gradient: Float64s
    differences: Float64s


def lens(problem: MatchProblem, level: int, x: float, y: float) -> Lens:
    """One level at a place of the map, metres. The place is moved by less than PART off the edge of a patch."""
    grid = problem.grids[level]
    u = np.array([x, y]) / grid.resolution - 0.5
    first = np.floor(u)
    share = np.clip(u - first, PART, 1.0 - PART)  # the gradient jumps at the edge
    place = (first + share + 0.5) * grid.resolution
    M, gradient = grid.interpolate(place[None])
    step = PART * grid.resolution * np.array([[1, 0], [-1, 0], [0, 1], [0, -1]])
    east, west, north, south = grid.interpolate(place + step * (1.0 - 1e-9))[0].tolist()
    column, row = (math.floor(c) for c in first)
    centres = (first + np.array([[0, 0], [1, 0], [0, 1], [1, 1]]) + 0.5) * grid.resolution
    p00, p10, p01, p11 = (_cell(problem, level, *centre) for centre in centres.tolist())
    width = 2.0 * PART * grid.resolution
    corners, slope = (p00, p10, p01, p11), np.array([east - west, north - south]) / width
    where = float(place[0]), float(place[1])
    return Lens(level, grid.resolution, where, (column, row), corners, share, float(M[0]), gradient[0], slope)


def _cell(problem: MatchProblem, level: int, x: float, y: float) -> float:
    """The probability of the cell around a place; 0.5 off the map."""
    grid = problem.grids[level]
    column, row = grid.cells_of(np.array([[x, y]]))[0].tolist()
    rows, columns = grid.log_odds.shape
    if not (0 <= row < rows and 0 <= column < columns):
        return 0.5
    return 1.0 / (1.0 + math.exp(-float(grid.log_odds[row, column])))
