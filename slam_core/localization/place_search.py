"""The places of a map that agree best with a scan: every place and heading is weighed, or shown to be worse.

The correlative search that the paper cites as [13], without a window: a bound for whole blocks of places, from a
map in which each cell holds the largest of its block, leaves few blocks to look at. The score of a place sums up
its endpoints: 2 for one on an occupied cell, 1 beside one.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slam_core import geometry
from slam_core.kernels import global_search as kernels
from slam_core.localization.search_parts import BLOCK, Cells, Region, parts
from slam_core.mapping.tiles import Box
from slam_core.matching.correlative import pool
from slam_core.measurements import Float32s, Float64s, Int64s

BEAMS = 120  # of the scan, evenly; twice as many are what an eight-bit sum holds
BAND = 64  # rows of blocks that are made at once
FAR = 0.9  # a step of the heading moves the endpoint at this quantile of the distances by one cell
RIVAL = 0.8  # share of the best score from which a place is looked at closely
RIVALS = 8  # so many at most
APART = (1.0, 0.3)  # metres, radians: two places nearer than both are one
WORK = 1_000_000  # looks at a cell between two looks at the budget
SORTED = 3000.0  # looks that take as long as finding the part of one tile


@dataclass(frozen=True, slots=True, eq=False)
class Places:
    """Places by falling score, apart from each other: scores (n,) between 0 and 1, poses (n, 3).

    crowded: there were more good places than can be compared, and poses is empty.
    """

    scores: Float64s
    poses: Float64s
    crowded: bool = False


def apart(a: Float64s, b: Float64s) -> bool:
    """Whether two poses are different places."""
    return geometry.apart(a, b, *APART)


class PlaceSearch:
    """The best-scoring places of a lattice over the known map, and their rivals, that score `least` (0..1).

    The lattice: centres of the cells, and headings one cell apart at a far endpoint. Nothing on it scores more
    than the first place; of equals the first by heading, row and column counts. points: (n, 2) endpoints, metres,
    n > 0. The search can be made in parts, between which the map must not change.
    """

    def __init__(self, level: Cells, points: Float32s, least: float, region: Region | None = None) -> None:
        self._level = level
        self._few = few = np.ascontiguousarray(points[_evenly(len(points))], np.float32)
        distances = np.hypot(few[:, 0], few[:, 1])
        inverse = 1.0 / level.resolution
        count = max(8, math.ceil(2.0 * math.pi * float(np.quantile(distances, FAR)) * inverse))
        around = np.linspace(0.0, 2.0 * math.pi, count, endpoint=False)
        self._psi = around if region is None else region.facing(around)
        self._state = np.array([0, 0, max(1, math.ceil(least * self._full)), 0, 0])
        self._found = np.zeros((kernels.MANY, 4), np.int64)
        self._parts = parts(level, region, float(distances.max()))
        self._due = SORTED * len(level.seen()) if len(self._parts) > 1 else 0.0
        self.finished = False
        self._begin()

    @property
    def _full(self) -> int:
        return int(kernels.WALL) * len(self._few)

    def _begin(self) -> None:
        """With the next part, if there is one."""
        self.finished = not self._parts
        if self.finished:
            return
        self._window, self._box = self._parts.pop(0)
        high, wide = self._window[1] - self._window[0], self._window[3] - self._window[2]
        blocks = np.zeros((BLOCK, BLOCK, -(-high // BLOCK) + 1, -(-wide // BLOCK) + 1), np.uint8)
        self.pictures = kernels.Pictures(np.zeros((high, wide), np.uint8), blocks, 1.0 / self._level.resolution)
        self._limits, self._order = np.zeros(len(self._psi), np.int64), np.zeros(0, np.int64)
        self._drawn = self._bounded = 0
        self._state[:2] = 0

    def advance(self, work: float = math.inf) -> float:
        """Go on for the time of so many looks at a cell, a nanosecond or two each. What was done."""
        done, self._due = self._due, 0.0
        while not self.finished and done < work:
            if self._drawn < self.pictures.blocks.shape[2]:
                done += self._draw()
            elif self._bounded < len(self._psi):
                done += self._bound()
            else:
                done += self._look(work - done)
        return done

    def places(self) -> Places:
        """What was found, once the search is finished."""
        count = int(self._state[4])
        if count < 0:
            return Places(np.empty(0), np.empty((0, 3)), crowded=True)
        return self._distinct(self._found[:count])

    def _draw(self) -> int:
        """One band of the pictures."""
        cells, blocks, _ = self.pictures
        first, last = self._drawn, min(self._drawn + BAND, blocks.shape[2])
        row0, _, column0, column1 = self._window
        begin, end = BLOCK * (first - 1), BLOCK * last  # rows that the blocks of the band reach
        low, high = max(0, begin), min(len(cells), end)
        cells[low:high] = walls(self._level, (row0 + low, row0 + high, column0, column1))
        reached = np.zeros((end - begin, BLOCK * (blocks.shape[3] + 1)), np.uint8)
        reached[low - begin : high - begin, BLOCK : BLOCK + cells.shape[1]] = cells[low:high]
        blocks[:, :, first:last] = _pooled(reached, last - first, blocks.shape[3])
        self._drawn = last
        return 8 * reached.size

    def _bound(self) -> int:
        """The limits of some headings."""
        blocks, box = self.pictures.blocks, self._box
        cost = int(box[2] * box[3]) * len(self._few) // kernels.SUM + len(self._few)
        last = min(len(self._psi), self._bounded + max(1, WORK // cost))
        some = slice(self._bounded, last)
        kernels.heading_bounds(blocks, self._few, self.pictures.inverse, self._psi[some], box, self._limits[some])
        cost *= last - self._bounded
        self._bounded = last
        if last == len(self._psi):
            self._order = np.argsort(-self._limits, kind="stable")
        return cost

    def _look(self, work: float) -> int:
        """At the places of some headings."""
        headings = kernels.Headings(self._psi, self._limits, self._order)
        corner = self._window[0], self._window[2]
        done = kernels.best_places(
            self.pictures, corner, self._few, headings, self._box, RIVAL, self._state, self._found,
            math.ceil(min(work, WORK)),  # a float would be compiled for, too
        )  # fmt: skip
        if self._state[4] < 0:
            self.finished = True
        elif self._state[0] >= len(self._psi):
            self._begin()
        return int(done)

    def _distinct(self, found: Int64s) -> Places:
        """Candidates (n, 4) as poses: by falling score, heading, row, column, without those near a better one."""
        scores: list[float] = []
        poses: list[Float64s] = []
        for score, h, row, column in found[
            np.lexsort((found[:, 3], found[:, 2], found[:, 1], -found[:, 0]))
        ].tolist():
            x, y = np.array([column + 0.5, row + 0.5]) * self._level.resolution
            pose = np.array([x, y, geometry.wrap(self._psi[h])])
            if all(apart(pose, other) for other in poses):
                scores.append(score / self._full)
                poses.append(pose)
            if len(poses) == RIVALS:
                break
        return Places(np.array(scores), np.array(poses).reshape(-1, 3))


def walls(level: Cells, box: Box) -> NDArray[np.uint8]:
    """A box of a level's lattice as scores of an endpoint there: 2 occupied, 1 beside an occupied cell, else 0."""
    row0, row1, column0, column1 = box
    occupied = (level.gather((row0 - 1, row1 + 1, column0 - 1, column1 + 1)) > 0).astype(np.uint8)
    return (occupied + pool(occupied))[1:-1, 1:-1]


def _pooled(cells: NDArray[np.uint8], rows: int, columns: int) -> NDArray[np.uint8]:
    """(BLOCK, BLOCK, rows, columns): the largest cell of the block that begins at each cell, by its phase."""
    for length in (1, 2):
        cells = np.maximum(cells[:, :-length], cells[:, length:])
        cells = np.maximum(cells[:-length], cells[length:])
    phases = cells[: rows * BLOCK, : columns * BLOCK].reshape(rows, BLOCK, columns, BLOCK)
    return phases.transpose(1, 3, 0, 2)


def _evenly(n: int) -> NDArray[np.int64]:
    return np.linspace(0, n - 1, min(n, BEAMS)).astype(np.int64)
