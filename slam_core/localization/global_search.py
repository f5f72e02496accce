"""Where in a whole map a scan was taken: the best places of a search, matched and compared."""

import math
from dataclasses import dataclass

import numpy as np

from slam_core.config import SlamConfig
from slam_core.kernels import global_search as kernels
from slam_core.localization.place_search import Places, PlaceSearch, apart, walls
from slam_core.localization.search_parts import Region
from slam_core.mapping.pyramid import Pyramid
from slam_core.mapping.tiled_map import MapLevel
from slam_core.mapping.tiles import common
from slam_core.matching.matcher import coarse_to_fine
from slam_core.measurements import Float64s
from slam_core.results import MatchResult, SearchFailure
from slam_core.scan.stabilise import StabilisedScan

SEARCHED = 0.1  # metres: the coarsest level with cells no longer than this, or the finest
LOOSE = 0.8  # a place on the lattice needs this share of what the match there must reach in the end
SLACK = 0.3  # metres before its end in which a beam may touch walls: those that it ends on
CLEARER = 0.03  # a place is the one if the map explains this much less of the scan at the next best
MOVE = 10_000_000.0  # looks at a cell that take as long as moving the window of a long drive to a place


@dataclass(frozen=True, slots=True, eq=False)
class SearchResult:
    """The outcome of a search of the whole map: a match, or why there is none."""

    match: MatchResult | None
    failure: SearchFailure | None = None


def locate(
    pyramid: Pyramid, scan: StabilisedScan, config: SlamConfig, region: Region | None = None
) -> SearchResult:
    """The one place in the map, or a region of it, that agrees well with a scan of at least one endpoint."""
    search = GlobalSearch(pyramid, scan, config, region)
    search.advance()
    return search.result()


class GlobalSearch:
    """The search that `locate` makes, in parts, between which the map must not change."""

    def __init__(
        self,
        pyramid: Pyramid,
        scan: StabilisedScan,
        config: SlamConfig,
        region: Region | None = None,
        wanted: float | None = None,
    ) -> None:
        """wanted: how much of the scan a place has to explain; None for as much as the settings say."""
        self.scan = scan
        self.wanted = config.tracking.relocalise_min_inlier_ratio if wanted is None else wanted
        self._pyramid, self._config, self._region = pyramid, config, region
        self._search = PlaceSearch(_level(pyramid), scan.points, LOOSE * self.wanted, region)
        self._places: Places | None = None
        self._matches: list[MatchResult] = []

    @property
    def finished(self) -> bool:
        """Whether there is a result."""
        return self._places is not None and len(self._matches) == len(self._places.poses)

    def advance(self, work: float = math.inf) -> float:
        """Go on for the time of so many looks at a cell, a nanosecond or two each. What was done."""
        done = self._search.advance(work)
        if self._places is None and self._search.finished:
            self._places = self._search.places()
        cost = MOVE if self._pyramid.stored else 0.0
        while self._places is not None and not self.finished and (done < work or not cost):
            pose = self._places.poses[len(self._matches)]
            self._matches.append(coarse_to_fine(self._pyramid, self.scan.points, pose, self._config.matcher))
            done += cost
        return done

    def result(self) -> SearchResult:
        """The one place among several that agrees well with the scan, once the search is finished."""
        assert self._places is not None
        if self._places.crowded:
            return SearchResult(None, SearchFailure("crowded"))
        explained = self._judged()
        best, most = max(explained, key=lambda each: each[1], default=(None, 0.0))
        if best is None or most < self.wanted:
            return SearchResult(None, SearchFailure("no_place", most, self.wanted))
        rivals = sum(share > most - CLEARER and apart(match.pose, best.pose) for match, share in explained)
        if rivals:
            return SearchResult(None, SearchFailure("ambiguous", rivals + 1))
        return SearchResult(best)

    def explained(self) -> list[tuple[MatchResult, float]]:
        """All places that explain as much of the scan as is wanted, and how much they explain."""
        return [each for each in self._judged() if each[1] >= self.wanted]

    def _judged(self) -> list[tuple[MatchResult, float]]:
        region = self._region
        matches = [each for each in self._matches if region is None or region.holds(each.pose)]
        return [(match, agreement(self._pyramid, self.scan, match.pose)) for match in matches]


def agreement(pyramid: Pyramid, scan: StabilisedScan, pose: Float64s) -> float:
    """How much of a scan at `pose` the map explains, 0 to 1: beams that end on walls; half if they cross some."""
    level = _level(pyramid)
    if level.bounds is None or not np.isfinite(pose).all():
        return 0.0
    row0, row1, column0, column1 = level.bounds
    inverse, slack = 1.0 / level.resolution, SLACK / level.resolution
    column, row = (pose[:2] / level.resolution - np.array([column0, row0])).tolist()
    far = 1.5 * inverse * float(max(np.abs(scan.points).max(), np.abs(scan.laser).max())) + 2.0  # in any direction
    rows, columns = ((math.floor(max(0.0, n - far)), math.ceil(n + far)) for n in (row, column))
    low, high, left, right = common((0, row1 - row0, 0, column1 - column0), (*rows, *columns))
    # In one piece, as kernels are compiled for each layout.
    cells = np.ascontiguousarray(walls(level, (row0 + low, row0 + high, column0 + left, column0 + right)))
    first = low, left
    total = kernels.agreement(cells, first, scan.points, scan.laser, inverse, column, row, pose[2], slack)
    return float(total) / (2.0 * int(kernels.WALL) * len(scan.points))


def _level(pyramid: Pyramid) -> MapLevel:
    """The level that is searched."""
    fine = [i for i, level in enumerate(pyramid.levels) if level.resolution <= SEARCHED * 1.01]
    return MapLevel(pyramid, fine[-1] if fine else 0)
