"""Localisation without a prediction: at the start in a prior map, and after the pose was lost for long."""

from typing import NamedTuple

import numpy as np

from slam_core import geometry
from slam_core.config import SlamConfig
from slam_core.localization.global_search import CLEARER, LOOSE, GlobalSearch, agreement
from slam_core.localization.place_search import apart
from slam_core.localization.search_parts import Region
from slam_core.localization.tracking import search_window
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.correlative import find_pose
from slam_core.matching.matcher import coarse_to_fine
from slam_core.measurements import Float64s
from slam_core.results import MatchResult, PlanarGaussian, SearchFailure, StartFound
from slam_core.scan.stabilise import StabilisedScan

# Covariance of a start pose that a person gives: metres, metres, radians.
GIVEN_START = np.diag([0.5, 0.5, 0.3]) ** 2.0
# The same of a place found in an earlier scan, moved by what is known of the motion since.
MOVED = np.diag([0.5, 0.5, 0.3]) ** 2.0
# The map has to explain this share of a scan at a place, however little it does elsewhere.
ENOUGH = 0.5
SOME = 0.35  # the same where a whole local map has to be explained
BUDGET = 4e7  # looks at a cell a second of the recording: some 40 ms
AT_ONCE = 2e7  # of these in one step: what was not used is not saved up for longer


class _Running(NamedTuple):
    """A search that has not ended: when its scan was made, and the pose (3,) that was predicted for it."""

    search: GlobalSearch
    time_ns: int
    pose: Float64s


class Relocaliser:
    """Searches no more often than `relocalise_interval`, and no longer than BUDGET a second of the recording.

    A search that takes longer goes on with the next scans, and what it finds is moved by the motion since.

    start: (3,) the given start pose; None if it may be anywhere in the map.
    failure: why the pose is unknown; None while it is known. found: where the run began in the prior map.
    """

    def __init__(self, start: Float64s | None) -> None:
        self.failure: SearchFailure | None = SearchFailure("pending") if start is None else None
        self.found: StartFound | None = None
        self._given = start
        self._searched_ns: int | None = None
        self._running: _Running | None = None
        self._budget, self._budget_ns = AT_ONCE, 0

    def start(
        self, pyramid: Pyramid, scan: StabilisedScan, time_ns: int, config: SlamConfig
    ) -> PlanarGaussian | None:
        """The pose to begin with: near the given one, else anywhere in the map; None for not yet."""
        given = None if self._given is None else PlanarGaussian(self._given, GIVEN_START)
        if given is not None and not config.tracking.check:
            return given
        if not (self._running or self._is_due(time_ns, config)):
            return None
        near = self.near(given, pyramid, scan, config) if given else None
        share = agreement(pyramid, scan, near.pose) if near else 0.0
        needed = config.tracking.relocalise_min_inlier_ratio
        found = near if share >= needed else self._search_region(pyramid, scan, time_ns, np.zeros(3), None, config)
        if found is None and share >= LOOSE * needed:
            found = near  # a given pose needs less proof
        if found is None:
            return None
        elsewhere = given is not None and apart(found.pose, given.mean)
        self.found = StartFound(found.pose, agreement(pyramid, scan, found.pose), elsewhere)
        self.reset()
        return found.gaussian

    def search(
        self,
        pyramid: Pyramid,
        scan: StabilisedScan,
        time_ns: int,
        pose: Float64s,
        region: Region | None,
        config: SlamConfig,
        waiting: Float64s | None = None,
    ) -> MatchResult | None:
        """A lost robot in a region of the map; None if it is not found yet, or the next search is not due.

        pose: (3,) the prediction, of which only the change between scans matters. waiting: (3,) where it may be
        according to the matches. Of a robot that drives into new rooms the map explains less and less there; it is
        the place if none explains as much.
        """
        if not (self._running or self._is_due(time_ns, config)):
            return None
        wanted = config.tracking.relocalise_min_inlier_ratio
        if waiting is not None and self._running is None:
            wanted = min(wanted, max(ENOUGH, agreement(pyramid, scan, waiting) - CLEARER))
        found = self._search_region(pyramid, scan, time_ns, pose, region, config, wanted)
        if found is None or (waiting is not None and not apart(found.pose, waiting)):
            return found
        share, needed = agreement(pyramid, scan, found.pose), config.tracking.relocalise_min_inlier_ratio
        if share >= needed:
            return found
        self.failure = SearchFailure("no_place", share, needed)
        return None

    def spend(self, work: float) -> None:
        """Count other work for the pose of a lost robot, in looks at a cell, as part of the budget."""
        self._budget -= work

    def places(
        self, pyramid: Pyramid, scan: StabilisedScan, time_ns: int, pose: Float64s, region: Region | None,
        config: SlamConfig,
    ) -> list[Float64s]:  # fmt: skip
        """Poses (3,) in a region of the map that explain some of a scan, once a search has ended; else none.

        pose: (3,) in a local map. They are moved by the motion since the scan that was searched for.
        """
        if not (self._running or self._is_due(time_ns, config)):
            return []
        running = self._advanced(pyramid, scan, time_ns, pose, region, config, SOME)
        if running is None:
            return []
        motion = geometry.compose(geometry.inverse(running.pose), pose)
        return [geometry.compose(match.pose, motion) for match, _ in running.search.explained()]

    def reset(self) -> None:
        """The pose in the map is known."""
        self.failure = self._running = None

    def _is_due(self, time_ns: int, config: SlamConfig) -> bool:
        last, interval_ns = self._searched_ns, config.tracking.relocalise_interval * 1e9
        if last is not None and 0 <= time_ns - last < interval_ns:
            return False
        self._searched_ns = time_ns
        return True

    def _search_region(
        self,
        pyramid: Pyramid,
        scan: StabilisedScan,
        time_ns: int,
        pose: Float64s,
        region: Region | None,
        config: SlamConfig,
        wanted: float | None = None,
    ) -> MatchResult | None:
        running = self._advanced(pyramid, scan, time_ns, pose, region, config, wanted)
        if running is None:
            return None
        result = running.search.result()
        self.failure = result.failure
        if result.match is None or running.time_ns == time_ns:
            return result.match
        motion = geometry.compose(geometry.inverse(running.pose), pose)
        there = PlanarGaussian(geometry.compose(result.match.pose, motion), MOVED)
        match = self.near(there, pyramid, scan, config)
        share = agreement(pyramid, scan, match.pose)
        if share >= running.search.wanted:
            return match
        self.failure = SearchFailure("no_place", share, running.search.wanted)
        return None

    def _advanced(
        self, pyramid: Pyramid, scan: StabilisedScan, time_ns: int, pose: Float64s, region: Region | None,
        config: SlamConfig, wanted: float | None,
    ) -> _Running | None:  # fmt: skip
        """The search that goes on, or a new one, within the budget; None until it has ended."""
        running = self._running or _Running(GlobalSearch(pyramid, scan, config, region, wanted), time_ns, pose)
        passed_s, self._budget_ns = max(0.0, (time_ns - self._budget_ns) * 1e-9), time_ns
        self._budget = min(AT_ONCE, self._budget + BUDGET * passed_s)
        if self._budget > 0.0:
            self._budget -= running.search.advance(self._budget)
        if not running.search.finished:
            self._running, self.failure = running, SearchFailure("pending")
            return None
        self._running = None
        return running

    @staticmethod
    def near(given: PlanarGaussian, pyramid: Pyramid, scan: StabilisedScan, config: SlamConfig) -> MatchResult:
        """The match of a scan that a local search around a pose finds."""
        pyramid.cover(scan.points, given.mean)
        start = find_pose(pyramid.levels[-1], scan.points, given.mean, search_window(given, config.tracking))
        return coarse_to_fine(pyramid, scan.points, start, config.matcher)
