"""Where each scan lies in the map; after a gap in the data in a local map, until its place in the map is found."""

import math
from collections import deque

import numpy as np

from slam_core import geometry
from slam_core.config import MapConfig, SlamConfig
from slam_core.localization.local_map import LocalMap
from slam_core.localization.localiser import LocalisedScan, Localiser, continued
from slam_core.localization.placements import (
    PARTLY,
    KeptScan,
    Placement,
    Placements,
    Usual,
    agrees,
    crossings,
    looked_at,
)
from slam_core.localization.relocalisation import Relocaliser
from slam_core.localization.search_parts import AT_REST
from slam_core.localization.tracking import GOOD, MOSTLY, exceeds_basin, is_good
from slam_core.mapping.mapper import Mapper
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.matcher import coarse_to_fine
from slam_core.measurements import Float64s, LaserScan
from slam_core.navigation.ego_motion import EgoMotion
from slam_core.results import MatchResult, PlanarGaussian, SearchFailure, Verdict
from slam_core.scan.stabilise import StabilisedScan

FAR = 1.0  # metres, one sigma of a prediction: from there on nothing is known of where the robot is
STRAYED = 2.0  # metres, one sigma: the same where inertial data still tells the heading
SILENT_NS = 1_500_000_000  # between two scans: where no inertial data shows a gap
JUDGED_NS = 50_000_000  # from one look at a placement to the next
JUDGING = 2e6  # looks at a cell that take as long
MOST_JUDGED = 4  # placements with one scan
NEAR = (0.1, 0.05)  # metres, radians: so near the scan is matched where the placement has it, or it waits
PLACED = np.diag([0.03, 0.03, 0.01]) ** 2.0  # covariance of a placement: metres, metres, radians
RESTED_NS = 2_000_000_000  # a robot at rest before and after a gap, for so long, was not moved over it
SAME = (0.15, 0.15)  # metres, radians
UNFOUND = 100  # scans of a local map, 20 m of path, that no place of the map explains: the robot has left it
LEARNED = 10  # scans, of which one shows how many beams cross walls where the place is sure
CROSSING, MEMORY = 0.02, 0.03  # of the beams at first; weight of the newest such scan
AT_ONCE = 2  # scans of a local map that are written into the map with one scan


class Locator:
    """One for each run. It has what is asked of a localiser.

    mapper: writes the map, and what a local map has seen once its place is found.
    """

    def __init__(self, pyramid: Pyramid, motion: EgoMotion, localiser: Localiser, mapper: Mapper) -> None:
        self._pyramid, self._motion, self._mapper = pyramid, motion, mapper
        self._main = localiser
        self._local: LocalMap | None = None
        self._placements = Placements()
        self._joined: deque[KeptScan] = deque()
        self._judged_ns = self._located_ns = 0
        self._crossing, self._located = CROSSING, 0

    @property
    def pyramid(self) -> Pyramid:
        """The map that scans are matched with: the local one while the pose in the map is unknown."""
        return self._local.pyramid if self._local else self._pyramid

    @property
    def localiser(self) -> Localiser:
        """What locates scans in that map."""
        return self._local.localiser if self._local else self._main

    @property
    def relocaliser(self) -> Relocaliser:
        """What searches the map."""
        return self._main.relocaliser

    def initialise(self, scan: StabilisedScan, time_ns: int, config: SlamConfig) -> bool:
        """Whether the pose in the map is known; at the start in a prior map it is searched for."""
        return self._main.initialise(scan, time_ns, config)

    def reset(self, time_ns: int, pose: PlanarGaussian) -> None:
        """Continue at a pose that somebody states, and match from there."""
        self._local = None
        self._joined.clear()
        self._main.reset(time_ns, pose)

    def fused(self, pose: PlanarGaussian) -> PlanarGaussian:
        """Take the fused pose of a scan. As it is in the map: while that is unknown, less certain."""
        self.localiser.fused = pose.mean
        if self._local is None:
            return pose
        return PlanarGaussian(pose.mean, pose.covariance + self._local.prior.covariance)

    def locate(
        self, scan: LaserScan, stabilised: StabilisedScan, prior: PlanarGaussian, config: SlamConfig
    ) -> LocalisedScan:
        """Sections IV-B and IV-C. The pose of a scan in a local map is accepted, but *lost* and not confirmed."""
        lapse_ns, self._located_ns = scan.mid_ns - self._located_ns, scan.mid_ns
        if not (config.tracking.check and config.tracking.relocalise) or self._pyramid.empty:
            self._local = None
        elif self._is_unknown(prior, lapse_ns) or (self._local and scan.mid_ns < self._local.begin_ns):
            self._begin(stabilised, scan.mid_ns, prior, config)
        local = self._local
        if local is None:
            self._write_joined(config.map)
            found = self._main.locate(scan, stabilised, prior, config)
            self._learn(found)
            return found
        found = local.locate(scan, stabilised, prior, config)
        if found.verdict.state == "lost":
            local = self._begin(stabilised, scan.mid_ns, local.prior_at(found.pose), config)
            found = local.locate(scan, stabilised, prior, config)
        match = self._look(local, found, scan.mid_ns, config) if found.verdict.accepted else None
        if match is None and found.verdict.accepted and self._is_outside(local, found, config):
            return self._continue(local, found, scan.mid_ns)
        if match is None:
            lost = Verdict("lost", found.verdict.rejection, found.verdict.accepted, confirmed=False)
            return found._replace(verdict=lost)
        self._local = None
        self._main.reset(scan.mid_ns, match.gaussian)
        return LocalisedScan(found.scan, match.pose, match, Verdict("recovered", recovery="relocalised"))

    def _learn(self, found: LocalisedScan) -> None:
        """Now and then: how many beams cross walls of the map at a place that is sure."""
        self._located += 1
        if self._located % LEARNED == 0 and found.match and found.verdict.accepted and found.verdict.confirmed:
            known, crossed = crossings(self._pyramid, found.scan, found.pose)
            if known:
                self._crossing += MEMORY * (crossed / known - self._crossing)

    def _is_unknown(self, prior: PlanarGaussian, lapse_ns: int) -> bool:
        """Whether a prediction follows so long a gap in the data, or in the scans, that it tells too little."""
        sigma = math.sqrt(float(prior.covariance.diagonal()[:2].max()))
        if self._motion.inertial and exceeds_basin(prior):
            return sigma > FAR
        return lapse_ns > SILENT_NS and sigma > (STRAYED if self._motion.inertial else FAR)

    def _begin(self, scan: StabilisedScan, time_ns: int, prior: PlanarGaussian, config: SlamConfig) -> LocalMap:
        """A local map. It begins where the scan fits near the prediction, else there if the heading is known.

        With an unknown heading it begins where the robot was sure last.
        """
        main = self._main
        near = main.relocaliser.near(prior, self._pyramid, scan, config)
        if exceeds_basin(prior):
            fits, otherwise = is_good(near.fit, main.usual), main.sure
        else:
            fits = near.fit.known >= config.tracking.min_overlap and near.fit.hit >= GOOD * main.usual
            otherwise = prior.mean
        begin = near.pose if fits else otherwise
        self._local = local = LocalMap(self._motion, time_ns, begin, prior, config)
        self._placements = Placements()
        self._placements.add((begin, main.sure), begin)
        main.relocaliser.reset()
        return local

    def _is_outside(self, local: LocalMap, found: LocalisedScan, config: SlamConfig) -> bool:
        """Whether the robot has left the map for good.

        Its first scans lie outside of it where inertial data has them, and no place of it agrees with the scans of
        20 m of path since.
        """
        if not self._main.may_continue(local.prior, config):
            return False
        if len(local.known) < config.tracking.lost_after:
            local.known.append(looked_at(self._pyramid, found.scan, found.pose)[0].known)
        unfound = len(local.scans) >= UNFOUND and not self._placements.any_supported
        return unfound and sum(local.known) < MOSTLY * len(local.known)

    def _continue(self, local: LocalMap, found: LocalisedScan, time_ns: int) -> LocalisedScan:
        """The map goes on where the robot is in the local map."""
        assert found.match is not None
        pose = PlanarGaussian(found.pose, found.match.covariance + local.prior.covariance)
        self._joined.extend(local.settled(AT_REST))
        self._local = None
        self._main.reset(time_ns, pose)
        return LocalisedScan(found.scan, found.pose, *continued(found.match, pose, found.verdict))

    def _look(self, local: LocalMap, found: LocalisedScan, time_ns: int, config: SlamConfig) -> MatchResult | None:
        """The match in the map once it is known where the local map lies there."""
        main, placements, here = self._main, self._placements, found.pose
        motion = geometry.compose(geometry.inverse(local.begin), here)
        region = main.region(local.begin_ns, motion, local.prior)
        places = main.relocaliser.places(self._pyramid, found.scan, time_ns, here, region, config)
        placements.add(places, here)
        main.relocaliser.failure = SearchFailure("unconfirmed", len(placements))
        if not self._judge(local, time_ns, config):
            return None
        best = placements.best(here, time_ns) or self._at_rest(local, here, time_ns)
        return self._join(local, best, found, config) if best else None

    def _judge(self, local: LocalMap, time_ns: int, config: SlamConfig) -> bool:
        """Look at a placement for each JUDGED_NS since the last one. Whether all of them were looked at by now."""
        passed_ns = time_ns - self._judged_ns
        if 0 <= passed_ns < JUDGED_NS:
            return False
        self._judged_ns = time_ns
        usual = Usual(self._main.usual, self._crossing)
        for _ in range(min(MOST_JUDGED, max(1, passed_ns // JUDGED_NS))):
            if not self._placements.judge(self._pyramid, local.scans, usual, config):
                return True
            self._main.relocaliser.spend(JUDGING)
        return False

    def _at_rest(self, local: LocalMap, here: Float64s, time_ns: int) -> Placement | None:
        """Where a robot stands that stood before the gap, and stands now."""
        main = self._main
        stands = main.rested and time_ns - local.begin_ns >= RESTED_NS
        if not stands or geometry.apart(here, local.begin, *SAME):
            return None
        return self._placements.at(main.sure, here, *SAME)

    def _join(
        self, local: LocalMap, placement: Placement, found: LocalisedScan, config: SlamConfig
    ) -> MatchResult | None:
        """The match where a placement has the robot; what the local map has seen is handed to the mapper.

        The placement comes from all scans, so that it counts where this one alone tells little.
        """
        there = geometry.compose(placement.moved, found.pose)
        prior = PlanarGaussian(there, PLACED)
        match = coarse_to_fine(self._pyramid, found.scan.points, there, config.matcher, prior=prior)
        if geometry.apart(match.pose, there, *NEAR):
            return None
        self._joined.extend(local.settled(placement.moved))
        return match

    def _write_joined(self, config: MapConfig) -> None:
        """Some of what the last local map has seen, but for scans that the map contradicts."""
        for _ in range(min(AT_ONCE, len(self._joined))):
            scan, pose, _ = self._joined.popleft()
            fit, free = looked_at(self._pyramid, scan, pose)
            if fit.known < PARTLY or agrees(fit, free, self._main.usual):
                self._mapper.add(scan, pose, config)
