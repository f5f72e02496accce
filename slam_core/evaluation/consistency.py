"""How well the scans of a run explain its own map: a score for recordings without a truth."""

import numpy as np
from numpy.typing import NDArray

from slam_core.measurements import Float64s

HIT = 0.075  # m from an endpoint's cell to an occupied one: a cell of 0.05 m has its eight neighbours
SHORT_OF = 0.15  # m before an endpoint within which an occupied cell counts as the wall that was hit
NEAR = 0.5  # m from the base within which a beam may pass occupied cells: the robot, a laser beside the base


def consistency(
    occupied: NDArray[np.bool_], corner: Float64s, resolution: float, begins: Float64s, ends: Float64s
) -> float:
    """The share of beams that agree with a finished map; 0 without beams.

    A beam agrees if it ends in an occupied cell, or within HIT of one, and passes none between NEAR after its
    begin and SHORT_OF before its end. occupied: (rows, columns), row 0 at the lowest y. corner: (2,) of cell
    (0, 0), metres. resolution: metres a cell. begins, ends: (n, 2) in the map, metres.
    """
    if not len(ends) or not occupied.size:
        return 0.0
    begins, ends = (begins - corner) / resolution, (ends - corner) / resolution
    return float(np.mean(_hits(occupied, ends, resolution) & ~_passes(occupied, begins, ends, resolution)))


def _hits(occupied: NDArray[np.bool_], ends: Float64s, resolution: float) -> NDArray[np.bool_]:
    """Which of the ends (n, 2), in cells, lie within HIT of an occupied cell."""
    reach = int(HIT / resolution)
    steps = np.arange(-reach, reach + 1)
    around = [(u, v) for u in steps for v in steps if np.hypot(u, v) * resolution <= HIT]
    hits: NDArray[np.bool_] = np.logical_or.reduce([_at(occupied, ends + step) for step in around])
    return hits


def _passes(occupied: NDArray[np.bool_], begins: Float64s, ends: Float64s, resolution: float) -> NDArray[np.bool_]:
    """Which beams (n, 2) to (n, 2), in cells, pass an occupied cell, seen at every cell of their length."""
    ways = ends - begins
    lengths = np.hypot(ways[:, 0], ways[:, 1])
    order = np.argsort(-lengths)  # those that reach a distance are the first so many
    begins, until = begins[order], lengths[order] - SHORT_OF / resolution
    directions = ways[order] / np.maximum(lengths[order], 1e-9)[:, None]
    passed = np.zeros(len(ends), np.bool_)
    for at in np.arange(NEAR / resolution, until[0]):
        n = int(np.searchsorted(-until, -at))
        passed[:n] |= _at(occupied, begins[:n] + at * directions[:n])
    found = np.empty_like(passed)
    found[order] = passed
    return found


def _at(cells: NDArray[np.bool_], places: Float64s) -> NDArray[np.bool_]:
    """The cells at places (n, 2), in cells; False outside."""
    column, row = np.floor(places).astype(np.int64).T
    rows, columns = cells.shape
    inside = (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
    found: NDArray[np.bool_] = inside & cells[np.where(inside, row, 0), np.where(inside, column, 0)]
    return found
