"""A wide search for a lost pose: correlate the scan with a coarse level over a window, then with less blur.

Two passes of the real-time correlative search that the paper cites as [13]: the first reads a level on which each
wall is a cell wider, so that large steps miss nothing; the second looks closely around the most promising poses.
"""

import math
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from slam_core.geometry import wrap
from slam_core.kernels import correlative as kernels
from slam_core.mapping.grid import GridLevel
from slam_core.measurements import Float32s, Float64s

Cell = TypeVar("Cell", np.uint8, np.int16)

BEAMS = 120  # of the scan, evenly: enough to distinguish rooms
STEP_CELLS = 2.0  # between poses of the first pass: what the widened walls cover
STEP_ANGLE = 0.06
CANDIDATES = 24  # poses of the first pass that are refined
REACH_CELLS = 16  # the window's half width at most, which bounds the time whatever the level
FINE_OFFSETS = np.array([-1.0, -0.5, 0.0, 0.5, 1.0])


def find_pose(level: GridLevel, points: Float32s, around: Float64s, window: tuple[float, float]) -> Float64s:
    """The pose (3,) within +-window[0] metres and +-window[1] radians of `around` where the scan fits best.

    points: (n, 2) endpoints in the stabilised frame, metres, n > 0. To be refined by a match. Of equal fits the
    first in the order of x, y, psi wins.
    """
    few = np.ascontiguousarray(points[:: max(1, len(points) // BEAMS)], np.float32)
    step = STEP_CELLS * level.resolution
    reach = min(window[0], REACH_CELLS * level.resolution)
    coarse = around + _lattice(_axis(reach, step), _axis(min(window[1], math.pi), STEP_ANGLE))
    scores = _scores(level, pool(level.cells), few, coarse)
    best = np.argsort(-scores, kind="stable")[:CANDIDATES]
    near = _lattice(FINE_OFFSETS * 0.5 * step, FINE_OFFSETS * 0.5 * STEP_ANGLE)
    fine = (coarse[best][:, None] + near).reshape(-1, 3)
    found: Float64s = fine[np.argmax(_scores(level, level.cells, few, fine))].copy()
    found[2] = wrap(found[2])
    return found


def pool(cells: NDArray[Cell]) -> NDArray[Cell]:
    """The largest value among a cell and its eight neighbours: what a pose up to a cell away could read."""
    wide = cells.copy()
    np.maximum(wide[:, 1:], cells[:, :-1], out=wide[:, 1:])
    np.maximum(wide[:, :-1], cells[:, 1:], out=wide[:, :-1])
    out = wide.copy()
    np.maximum(out[1:], wide[:-1], out=out[1:])
    np.maximum(out[:-1], wide[1:], out=out[:-1])
    return out


def _axis(half: float, step: float) -> Float64s:
    n = math.ceil(half / step)
    return np.linspace(-half, half, 2 * n + 1)


def _lattice(shifts: Float64s, turns: Float64s) -> Float64s:
    """(m, 3) offsets: every shift in x with every one in y and every turn."""
    x, y, psi = np.meshgrid(shifts, shifts, turns, indexing="ij")
    return np.stack([x.ravel(), y.ravel(), psi.ravel()], axis=1)


def _scores(level: GridLevel, cells: NDArray[np.int16], points: Float32s, poses: Float64s) -> Float64s:
    out = np.empty(len(poses))
    kernels.score(cells, level.corner, 1.0 / level.resolution, points, poses, out)
    return out
