"""Localisation without a prediction: at the start in a prior map, and after the pose was lost for long."""

import numpy as np

from slam_core.config import SlamConfig
from slam_core.localization.global_search import LOOSE, agreement, apart, locate
from slam_core.localization.tracking import search_window
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.correlative import find_pose
from slam_core.matching.matcher import coarse_to_fine
from slam_core.measurements import Float64s
from slam_core.results import MatchResult, PlanarGaussian, SearchFailure, StartFound
from slam_core.scan.stabilise import StabilisedScan

# Covariance of a start pose that a person gives: metres, metres, radians.
GIVEN_START = np.diag([0.5, 0.5, 0.3]) ** 2.0


class Relocaliser:
    """Searches no more often than `relocalise_interval`, since a search of the whole map takes long.

    start: (3,) the given start pose; None if it may be anywhere in the map.
    failure: why the pose is unknown; None while it is known. found: where the run began in the prior map.
    """

    def __init__(self, start: Float64s | None) -> None:
        self.failure: SearchFailure | None = SearchFailure("pending") if start is None else None
        self.found: StartFound | None = None
        self._given = start
        self._searched_ns: int | None = None

    def start(
        self, pyramid: Pyramid, scan: StabilisedScan, time_ns: int, config: SlamConfig
    ) -> PlanarGaussian | None:
        """The pose to begin with: near the given one, else anywhere in the map; None for not yet."""
        given = None if self._given is None else PlanarGaussian(self._given, GIVEN_START)
        if given is not None and not config.tracking.check:
            return given
        if not self._is_due(time_ns, config):
            return None
        near = self._near(given, pyramid, scan, config) if given else None
        share = agreement(pyramid, scan, near.pose) if near else 0.0
        needed = config.tracking.relocalise_min_inlier_ratio
        found = near if share >= needed else self._anywhere(pyramid, scan, config)
        if found is None and share >= LOOSE * needed:
            found = near  # a given pose needs less proof
        if found is None:
            return None
        elsewhere = given is not None and apart(found.pose, given.mean)
        self.found = StartFound(found.pose, agreement(pyramid, scan, found.pose), elsewhere)
        self.reset()
        return found.gaussian

    def search(
        self, pyramid: Pyramid, scan: StabilisedScan, time_ns: int, config: SlamConfig
    ) -> MatchResult | None:
        """A lost robot anywhere in the map; None if it is not found, or the next search is not due."""
        return self._anywhere(pyramid, scan, config) if self._is_due(time_ns, config) else None

    def reset(self) -> None:
        """The pose in the map is known."""
        self.failure = None

    def _is_due(self, time_ns: int, config: SlamConfig) -> bool:
        last, interval_ns = self._searched_ns, config.tracking.relocalise_interval * 1e9
        if last is not None and 0 <= time_ns - last < interval_ns:
            return False
        self._searched_ns = time_ns
        return True

    def _anywhere(self, pyramid: Pyramid, scan: StabilisedScan, config: SlamConfig) -> MatchResult | None:
        result = locate(pyramid, scan, config)
        self.failure = result.failure
        return result.match

    @staticmethod
    def _near(given: PlanarGaussian, pyramid: Pyramid, scan: StabilisedScan, config: SlamConfig) -> MatchResult:
        start = find_pose(pyramid.levels[-1], scan.points, given.mean, search_window(given, config.tracking))
        return coarse_to_fine(pyramid, scan.points, start, config.matcher)
