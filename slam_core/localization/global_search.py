"""Where in a whole map a scan was taken: every place and heading is weighed, or shown to be worse than the best.

The correlative search that the paper cites as [13], without a window: a bound for whole blocks of places, from a
map in which each cell holds the largest of its block, leaves few blocks to look at. The score of a place sums up
its endpoints: 2 for one on an occupied cell, 1 beside one.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slam_core.config import SlamConfig
from slam_core.geometry import wrap
from slam_core.kernels import global_search as kernels
from slam_core.mapping.grid import GridLevel
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.correlative import pool
from slam_core.matching.matcher import coarse_to_fine
from slam_core.measurements import Float32s, Float64s
from slam_core.results import MatchResult, SearchFailure
from slam_core.scan.stabilise import StabilisedScan

BEAMS = 120  # of the scan, evenly; twice as many are what an eight-bit sum holds
SEARCHED = 0.1  # metres: the coarsest level with cells no longer than this, or the finest
BLOCK = 4  # cells on a side of the places that share a bound
FAR = 0.9  # a step of the heading moves the endpoint at this quantile of the distances by one cell
LOOSE = 0.8  # a place on the lattice needs this share of what the match there must reach in the end
SLACK = 0.3  # metres before its end in which a beam may touch walls: those that it ends on
RIVAL = 0.8  # share of the best score from which a place is looked at closely
RIVALS = 8  # so many at most
APART = (1.0, 0.3)  # metres, radians: two places nearer than both are one
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


def locate(pyramid: Pyramid, scan: StabilisedScan, config: SlamConfig) -> SearchResult:
    """The one place in the map that agrees well with a scan of at least one endpoint."""
    wanted = config.tracking.relocalise_min_inlier_ratio
    places = find_places(_level(pyramid), scan.points, LOOSE * wanted)
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


def find_places(level: GridLevel, points: Float32s, least: float) -> Places:
    """The best-scoring places of a lattice over the known map, and their rivals, that score `least` (0..1).

    The lattice: centres of the cells, and headings one cell apart at a far endpoint. Nothing on it scores more
    than the first place; of equals the first by heading, row and column counts.
    """
    few = np.ascontiguousarray(points[_evenly(len(points))], np.float32)
    reach = float(np.quantile(np.hypot(few[:, 0], few[:, 1]), FAR))
    count = max(8, math.ceil(2.0 * math.pi * reach / level.resolution))
    headings = np.linspace(0.0, 2.0 * math.pi, count, endpoint=False)
    cells = walls(level)
    if not cells.size:  # all that was ever seen lies off a map that does not grow
        return Places(np.empty(0), np.empty((0, 3)))
    pool = kernels.pooled(cells, BLOCK)
    limits = np.empty(count, np.int64)
    inverse = 1.0 / level.resolution
    kernels.heading_bounds(pool, few, inverse, headings, limits)
    order = np.argsort(-limits, kind="stable")
    found = np.zeros((kernels.MANY, 4), np.int64)
    full = int(kernels.WALL) * len(few)
    n = kernels.best_places(
        cells, pool, few, inverse, headings, order, limits, max(1, math.ceil(least * full)), RIVAL, found
    )
    if n < 0:
        return Places(np.empty(0), np.empty((0, 3)), crowded=True)
    return _distinct(level, headings, found[:n], full)


def walls(level: GridLevel) -> NDArray[np.uint8]:
    """The known box of a level as scores of an endpoint there: 2 occupied, 1 beside an occupied cell, else 0."""
    row0, row1, column0, column1 = level.known
    occupied = (level.log_odds[row0:row1, column0:column1] > 0).astype(np.uint8)
    return occupied + pool(occupied)


def _level(pyramid: Pyramid) -> GridLevel:
    """The level that is searched."""
    fine = [level for level in pyramid.levels if level.resolution <= SEARCHED * 1.01]
    return fine[-1] if fine else pyramid.levels[0]


def _evenly(n: int) -> NDArray[np.int64]:
    return np.linspace(0, n - 1, min(n, BEAMS)).astype(np.int64)


def _distinct(level: GridLevel, headings: Float64s, found: NDArray[np.int64], full: int) -> Places:
    """Candidates (n, 4) as poses: by falling score, then heading, row, column, without those near a better one."""
    row0, _, column0, _ = level.known
    first = level.corner + np.array([column0, row0])
    scores: list[float] = []
    poses: list[Float64s] = []
    for score, h, row, column in found[np.lexsort((found[:, 3], found[:, 2], found[:, 1], -found[:, 0]))].tolist():
        x, y = (first + np.array([column + 0.5, row + 0.5])) * level.resolution
        pose = np.array([x, y, wrap(headings[h])])
        if len(poses) < RIVALS and all(apart(pose, other) for other in poses):
            scores.append(score / full)
            poses.append(pose)
    return Places(np.array(scores), np.array(poses).reshape(-1, 3))
