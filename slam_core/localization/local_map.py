"""A map of its own for a robot whose pose is unknown after a gap in its data: it is tracked there meanwhile.

Position, heading and velocity are unknown then. One scan that fits somewhere does not tell where the robot is. In
the local map, which begins with the first scan after the gap, its motion is known from there on.
"""

from collections import deque
from dataclasses import replace

import numpy as np

from slam_core import geometry
from slam_core.config import SlamConfig
from slam_core.localization.localiser import LocalisedScan, Localiser
from slam_core.localization.placements import KeptScan
from slam_core.mapping.mapper import Mapper
from slam_core.mapping.pyramid import Pyramid
from slam_core.measurements import Float64s, LaserScan
from slam_core.navigation.ego_motion import FIRST_MATCH, EgoMotion
from slam_core.results import Fit, MatchResult, PlanarGaussian
from slam_core.scan.stabilise import StabilisedScan

SIDE = 512  # cells along a side of the first window at most
SPACING = (0.2, 0.2)  # metres, radians between two scans that are kept
SETTLED_NS = 1_000_000_000
KEPT = 400  # scans: 80 m of path


class LocalMap:
    """pyramid: in the axes of the map, as if the robot were at `begin` (3,) at its first scan. scans: kept ones.

    begin_ns: time of that scan. prior: the prediction then, with the covariance that the pose in the map has.
    known: shares of the first scans that lie on known cells of the map, where they are predicted.
    """

    def __init__(
        self, motion: EgoMotion, time_ns: int, begin: Float64s, prior: PlanarGaussian, config: SlamConfig
    ) -> None:
        self.begin_ns, self.begin, self.prior = time_ns, begin.copy(), prior
        self.pyramid = Pyramid(replace(config.map, size=min(SIDE, config.map.size)))
        self.localiser = Localiser(self.pyramid, motion, np.zeros(3), is_prior=False, writes=True)
        self.localiser.reset(time_ns, PlanarGaussian(begin.copy(), FIRST_MATCH.covariance))
        self.scans: deque[KeptScan] = deque(maxlen=KEPT)
        self.known: list[float] = []
        self._motion, self._mapper = motion, Mapper(self.pyramid, writes=True)

    def locate(
        self, scan: LaserScan, stabilised: StabilisedScan, prior: PlanarGaussian, config: SlamConfig
    ) -> LocalisedScan:
        """A scan located and written. The first one has the match that states its pose."""
        tracking = replace(config.tracking, relocalise=False, continue_from_prediction=False)
        config = replace(config, tracking=tracking, map=replace(config.map, update=True))
        placed, pose, match, verdict = found = self.localiser.locate(scan, stabilised, prior, config)
        self._mapper.update(placed, pose, match, verdict, scan.mid_ns, config.map, unaided=self._motion.unaided)
        if verdict.accepted and verdict.confirmed and self._is_due(pose):
            self.scans.append(KeptScan(placed, pose, scan.mid_ns))
        return found if match else found._replace(match=_stated(pose, len(placed.points)))

    def prior_at(self, pose: Float64s) -> PlanarGaussian:
        """A pose (3,) of this map with the covariance that it has in the map."""
        return PlanarGaussian(pose.copy(), self.prior.covariance)

    def settled(self, moved: Float64s) -> list[KeptScan]:
        """The kept scans as they lie in the map at a placement (3,), once tilt and velocity were known again."""
        from_ns = self.begin_ns + SETTLED_NS
        return [
            each._replace(pose=geometry.compose(moved, each.pose))
            for each in self.scans
            if each.time_ns >= from_ns
        ]

    def _is_due(self, pose: Float64s) -> bool:
        return not self.scans or geometry.apart(pose, self.scans[-1].pose, *SPACING)


def _stated(pose: Float64s, points: int) -> MatchResult:
    """The match of a first scan, which all of is unknown to the map."""
    residuals = np.full(points, 0.5, np.float32)
    return FIRST_MATCH._replace(pose=pose.copy(), residuals=residuals, fit=Fit(0.0, 0.0))
