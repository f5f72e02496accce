"""Finding the robot's place in the map: at the start in a given map, and when the pose has been lost for long."""

import numpy as np

from slam_core.config import SlamConfig
from slam_core.localization.global_search import LOOSE, agreement, apart, locate
from slam_core.localization.tracking import search_window
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.correlative import find_pose
from slam_core.matching.matcher import coarse_to_fine
from slam_core.measurements import Float64s
from slam_core.results import MatchResult, PlanarGaussian
from slam_core.scan.stabilise import StabilisedScan

# A person who says where the robot starts means about this: metres, metres, radians.
TOLD = np.diag([0.5, 0.5, 0.3]) ** 2.0


class Lookout:
    """Looks for the robot no more often than the settings allow, since the whole map takes long.

    given: (3,) where it is said to start; None if it may be anywhere. reason: why it is not found, empty while it
    is. note: where it was found at the start.
    """

    def __init__(self, given: Float64s | None) -> None:
        self.reason = "searching the whole map" if given is None else ""
        self.note = ""
        self._given = given
        self._searched_ns: int | None = None

    def start(
        self, pyramid: Pyramid, scan: StabilisedScan, time_ns: int, config: SlamConfig
    ) -> PlanarGaussian | None:
        """The pose to begin with, from a scan: near the given one, else anywhere; None for not yet."""
        told = None if self._given is None else PlanarGaussian(self._given, TOLD)
        if told is not None and not config.tracking.check:
            return told
        if not self._due(time_ns, config):
            return None
        near = self._near(told, pyramid, scan, config) if told else None
        share = agreement(pyramid, scan, near.pose) if near else 0.0
        found = near if share >= config.tracking.relocalise_min_inlier_ratio else self._anywhere(pyramid, scan, config)
        if found is None and share >= LOOSE * config.tracking.relocalise_min_inlier_ratio:
            found = near  # what a person says needs less proof
        if found is None:
            return None
        self.note = _begins(found, told, agreement(pyramid, scan, found.pose))
        self.rest()
        return found.gaussian

    def again(
        self, pyramid: Pyramid, scan: StabilisedScan, time_ns: int, config: SlamConfig
    ) -> MatchResult | None:
        """A lost robot anywhere in the map; None if it is not found, or was looked for just now."""
        return self._anywhere(pyramid, scan, config) if self._due(time_ns, config) else None

    def rest(self) -> None:
        """The robot has its place."""
        self.reason = ""

    def _due(self, time_ns: int, config: SlamConfig) -> bool:
        last, interval_ns = self._searched_ns, config.tracking.relocalise_interval * 1e9
        if last is not None and 0 <= time_ns - last < interval_ns:
            return False
        self._searched_ns = time_ns
        return True

    def _anywhere(self, pyramid: Pyramid, scan: StabilisedScan, config: SlamConfig) -> MatchResult | None:
        sighting = locate(pyramid, scan, config)
        self.reason = sighting.reason
        return sighting.match

    @staticmethod
    def _near(told: PlanarGaussian, pyramid: Pyramid, scan: StabilisedScan, config: SlamConfig) -> MatchResult:
        start = find_pose(pyramid.levels[-1], scan.points, told.mean, search_window(told, config.tracking))
        return coarse_to_fine(pyramid, scan.points, start, config.matcher)


def _begins(found: MatchResult, told: PlanarGaussian | None, share: float) -> str:
    x, y, psi = found.pose.tolist()
    how = "does not start where it was said to, but" if told and apart(found.pose, told.mean) else "starts"
    where = f"x {x:z.2f} m, y {y:z.2f} m, yaw {psi:z.2f} rad of the map"
    return f"the robot {how} at {where}: {share:.0%} of the scan agree"
