"""Where in a whole map a scan was taken: every place and heading is weighed, or shown to be worse than the best.

The correlative search that the paper cites as [13], without a window: a bound for whole blocks of places, from a
map in which each cell holds the largest of its block, leaves few blocks to look at. The score of a place sums up
its endpoints: 2 for one on an occupied cell, 1 beside one.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from slam_core.config import SlamConfig
from slam_core.geometry import wrap
from slam_core.kernels import global_search as kernels
from slam_core.mapping.grid import GridLevel
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.correlative import pool
from slam_core.matching.matcher import coarse_to_fine
from slam_core.measurements import Float32s, Float64s, Int64s
from slam_core.results import MatchResult, SearchFailure
from slam_core.scan.stabilise import StabilisedScan

BEAMS = 120  # of the scan, evenly; twice as many are what an eight-bit sum holds
SEARCHED = 0.1  # metres: the coarsest level with cells no longer than this, or the finest
BLOCK = 4  # cells on a side of the places that share a bound
BAND = 64  # rows of blocks that are made at once
FAR = 0.9  # a step of the heading moves the endpoint at this quantile of the distances by one cell
LOOSE = 0.8  # a place on the lattice needs this share of what the match there must reach in the end
SLACK = 0.3  # metres before its end in which a beam may touch walls: those that it ends on
RIVAL = 0.8  # share of the best score from which a place is looked at closely
RIVALS = 8  # so many at most
APART = (1.0, 0.3)  # metres, radians: two places nearer than both are one
PART = 1_000_000  # looks at a cell between two looks at the budget
CLEARER = 0.03  # a place is the one if the map explains this much less of the scan at the next best


@dataclass(frozen=True, slots=True, eq=False)
class Places:
    """Places by falling score, apart from each other: scores (n,) between 0 and 1, poses (n, 3).

    crowded: there were more good places than can be compared, and poses is empty.
    """

    scores: Float64s
    poses: Float64s
    crowded: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class SearchResult:
    """The outcome of a search of the whole map: a match, or why there is none."""

    match: MatchResult | None
    failure: SearchFailure | None = None


class Region(NamedTuple):
    """Where the robot can be: a circle, metres in the map."""

    centre: Float64s
    radius: float


def locate(
    pyramid: Pyramid, scan: StabilisedScan, config: SlamConfig, region: Region | None = None
) -> SearchResult:
    """The one place in the map, or a region of it, that agrees well with a scan of at least one endpoint."""
    search = search_of(pyramid, scan, config, region)
    search.advance()
    return judged(pyramid, scan, search.places(), config)


def search_of(
    pyramid: Pyramid, scan: StabilisedScan, config: SlamConfig, region: Region | None = None
) -> "PlaceSearch":
    """The search that `locate` makes, not begun."""
    least = LOOSE * config.tracking.relocalise_min_inlier_ratio
    return PlaceSearch(_level(pyramid), scan.points, least, region)


def judged(pyramid: Pyramid, scan: StabilisedScan, places: Places, config: SlamConfig) -> SearchResult:
    """The one place among several that agrees well with a scan, matched there."""
    wanted = config.tracking.relocalise_min_inlier_ratio
    if places.crowded:
        return SearchResult(None, SearchFailure("crowded"))
    matches = [coarse_to_fine(pyramid, scan.points, pose, config.matcher) for pose in places.poses]
    shares = [agreement(pyramid, scan, match.pose) for match in matches]
    if max(shares, default=0.0) < wanted:
        return SearchResult(None, SearchFailure("no_place", max(shares, default=0.0), wanted))
    k = int(np.argmax(shares))
    rivals = sum(
        share > shares[k] - CLEARER and apart(match.pose, matches[k].pose)
        for share, match in zip(shares, matches, strict=True)
    )
    if rivals:
        return SearchResult(None, SearchFailure("ambiguous", rivals + 1))
    return SearchResult(matches[k])


def agreement(pyramid: Pyramid, scan: StabilisedScan, pose: Float64s) -> float:
    """How much of a scan at `pose` the map explains, 0 to 1: beams that end on walls; half if they cross some."""
    level = _level(pyramid)
    row0, _, column0, _ = level.known
    column, row = pose[:2] / level.resolution - level.corner - np.array([column0, row0])
    inverse, slack = 1.0 / level.resolution, SLACK / level.resolution
    total = kernels.agreement(walls(level), scan.points, scan.laser, inverse, column, row, pose[2], slack)
    return float(total) / (2.0 * int(kernels.WALL) * len(scan.points))


def apart(a: Float64s, b: Float64s) -> bool:
    """Whether two poses are different places."""
    return math.hypot(a[0] - b[0], a[1] - b[1]) > APART[0] or abs(wrap(a[2] - b[2])) > APART[1]


class PlaceSearch:
    """The best-scoring places of a lattice over the known map, and their rivals, that score `least` (0..1).

    The lattice: centres of the cells, and headings one cell apart at a far endpoint. Nothing on it scores more
    than the first place; of equals the first by heading, row and column counts. points: (n, 2) endpoints, metres,
    n > 0. The search can be made in parts, between which the map must not change.
    """

    def __init__(self, level: GridLevel, points: Float32s, least: float, region: Region | None = None) -> None:
        self._level = level
        self._few = few = np.ascontiguousarray(points[_evenly(len(points))], np.float32)
        distances = np.hypot(few[:, 0], few[:, 1])
        inverse = 1.0 / level.resolution
        self._window, box = _window(level, region, float(distances.max()))
        row0, row1, column0, column1 = self._window
        self._first = level.corner + np.array([column0, row0])
        high, wide = max(0, row1 - row0), max(0, column1 - column0)
        self._box = np.array(box)
        blocks = np.zeros((BLOCK, BLOCK, -(-high // BLOCK) + 1, -(-wide // BLOCK) + 1), np.uint8)
        self.pictures = kernels.Pictures(np.zeros((high, wide), np.uint8), blocks, inverse)
        count = max(8, math.ceil(2.0 * math.pi * float(np.quantile(distances, FAR)) * inverse))
        self._psi = np.linspace(0.0, 2.0 * math.pi, count, endpoint=False)
        self._limits, self._order = np.zeros(count, np.int64), np.zeros(0, np.int64)
        self._drawn = self._bounded = 0
        self._state = np.array([0, 0, max(1, math.ceil(least * self._full)), 0, 0])
        self._found = np.zeros((kernels.MANY, 4), np.int64)
        self.finished = not (high and wide and self._box[2:].all())  # all that was seen may lie off the map

    @property
    def _full(self) -> int:
        return int(kernels.WALL) * len(self._few)

    def advance(self, work: float = math.inf) -> float:
        """Go on for the time of so many looks at a cell, a nanosecond or two each. What was done."""
        done = 0.0
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
        last = min(len(self._psi), self._bounded + max(1, PART // cost))
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
        done = kernels.best_places(
            self.pictures, self._few, headings, self._box, RIVAL, self._state, self._found, min(work, PART)
        )
        self.finished = self._state[4] < 0 or self._state[0] >= len(self._psi)
        return int(done)

    def _distinct(self, found: Int64s) -> Places:
        """Candidates (n, 4) as poses: by falling score, heading, row, column, without those near a better one."""
        scores: list[float] = []
        poses: list[Float64s] = []
        for score, h, row, column in found[
            np.lexsort((found[:, 3], found[:, 2], found[:, 1], -found[:, 0]))
        ].tolist():
            x, y = (self._first + np.array([column + 0.5, row + 0.5])) * self._level.resolution
            pose = np.array([x, y, wrap(self._psi[h])])
            if len(poses) < RIVALS and all(apart(pose, other) for other in poses):
                scores.append(score / self._full)
                poses.append(pose)
        return Places(np.array(scores), np.array(poses).reshape(-1, 3))


def walls(level: GridLevel, box: tuple[int, int, int, int] | None = None) -> NDArray[np.uint8]:
    """A box of a level as scores of an endpoint there: 2 occupied, 1 beside an occupied cell, else 0.

    box: first row, last row, first column, last column, last ones excluded; the known cells without it.
    """
    row0, row1, column0, column1 = box or level.known
    top, left = max(0, row0 - 1), max(0, column0 - 1)
    occupied = (level.log_odds[top : row1 + 1, left : column1 + 1] > 0).astype(np.uint8)
    scores = occupied + pool(occupied)
    return scores[row0 - top : row1 - top, column0 - left : column1 - left]


def _window(level: GridLevel, region: Region | None, reach: float) -> tuple[tuple[int, int, int, int], Int64s]:
    """The known cells that a scan may meet, and the box of blocks in them that holds the region."""
    row0, row1, column0, column1 = level.known
    if region is None:
        high, wide = -(-max(0, row1 - row0) // BLOCK), -(-max(0, column1 - column0) // BLOCK)
        return level.known, np.array([0, 0, high, wide])
    cell = level.resolution
    column, row = (np.asarray(region.centre[:2]) / cell - level.corner).tolist()
    half, far = region.radius / cell, (region.radius + reach) / cell + 1.0

    def cut(value: float, low: int, high: int) -> int:
        return int(min(max(value, low), high))

    window = (
        cut(row - far, row0, row1), cut(row + far + 1.0, row0, row1),
        cut(column - far, column0, column1), cut(column + far + 1.0, column0, column1),
    )  # fmt: skip
    first_row, last_row = (cut(row + d, window[0], window[1]) - window[0] for d in (-half, half + 1.0))
    first_column, last_column = (cut(column + d, window[2], window[3]) - window[2] for d in (-half, half + 1.0))
    begin = np.array([first_row // BLOCK, first_column // BLOCK])
    end = np.array([-(-last_row // BLOCK), -(-last_column // BLOCK)])
    return window, np.concatenate([begin, end - begin])


def _pooled(cells: NDArray[np.uint8], rows: int, columns: int) -> NDArray[np.uint8]:
    """(BLOCK, BLOCK, rows, columns): the largest cell of the block that begins at each cell, by its phase."""
    for length in (1, 2):
        cells = np.maximum(cells[:, :-length], cells[:, length:])
        cells = np.maximum(cells[:-length], cells[length:])
    phases = cells[: rows * BLOCK, : columns * BLOCK].reshape(rows, BLOCK, columns, BLOCK)
    return phases.transpose(1, 3, 0, 2)


def _level(pyramid: Pyramid) -> GridLevel:
    """The level that is searched."""
    fine = [level for level in pyramid.levels if level.resolution <= SEARCHED * 1.01]
    return fine[-1] if fine else pyramid.levels[0]


def _evenly(n: int) -> NDArray[np.int64]:
    return np.linspace(0, n - 1, min(n, BEAMS)).astype(np.int64)
