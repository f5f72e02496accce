"""Where each scan lies in the map; after a gap in the data in a local map, until its place in the map is found."""

from slam_core.config import SlamConfig
from slam_core.localization.hidden_walls import covered
from slam_core.localization.joining import Joining
from slam_core.localization.local_map import LocalMap
from slam_core.localization.localiser import LocalisedScan, Localiser, continued
from slam_core.localization.map_view import HITS, looked_at
from slam_core.localization.relocalisation import Relocaliser
from slam_core.localization.search_parts import AT_REST
from slam_core.localization.tracking import GOOD, MOSTLY, exceeds_basin, is_good
from slam_core.mapping.mapper import Mapper
from slam_core.mapping.pyramid import Pyramid
from slam_core.measurements import LaserScan
from slam_core.navigation.ego_motion import EgoMotion
from slam_core.results import PlanarGaussian, Verdict
from slam_core.scan.stabilise import StabilisedScan

FAR = 1.0  # metres, one sigma of a prediction: from there on nothing is known of where the robot is
STRAYED = 2.0  # metres, one sigma: the same where inertial data still tells the heading
LOST_NS, LOST_UNAIDED_NS = 5_000_000_000, 1_500_000_000  # from so long on, where only matches observe the motion
SILENT_NS = 1_500_000_000  # between two scans: where no inertial data shows a gap
UNFOUND = 100  # scans of a local map, 20 m of path, that no place of the map explains: the robot has left it


class Locator:
    """One for each run. It has what is asked of a localiser.

    mapper: writes the map, and what a local map has seen once its place is found.
    """

    def __init__(self, pyramid: Pyramid, motion: EgoMotion, localiser: Localiser, mapper: Mapper) -> None:
        self._pyramid, self._motion, self._main = pyramid, motion, localiser
        self._local: LocalMap | None = None
        self._joining = Joining(pyramid, localiser, mapper)
        self._located_ns = self._lost_ns = 0

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
        self._joining.forget()
        self._lost_ns = 0
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
        time_ns = scan.mid_ns
        if not (config.tracking.check and config.tracking.relocalise) or self._pyramid.empty:
            self._local = None
        elif self._is_unknown(stabilised, time_ns, prior, config):
            self._begin(stabilised, time_ns, prior, config)
        if self._local is None:
            self._joining.write(config.map)
            found = self._main.locate(scan, stabilised, prior, config)
            self._joining.learn(found)
        else:
            found = self._locate_in(self._local, scan, stabilised, prior, config)
        if not found.verdict.hidden:
            self._count(found.verdict, time_ns - self._located_ns)
            self._located_ns = time_ns
        return found

    def _count(self, verdict: Verdict, lapse_ns: int) -> None:
        """How long the robot has been lost, without gaps."""
        self._lost_ns = self._lost_ns + min(max(lapse_ns, 0), SILENT_NS) if verdict.state == "lost" else 0

    def _locate_in(
        self, local: LocalMap, scan: LaserScan, stabilised: StabilisedScan, prior: PlanarGaussian,
        config: SlamConfig,
    ) -> LocalisedScan:  # fmt: skip
        """A scan in the local map, or in the map once it is known where the local map lies there."""
        found = local.locate(scan, stabilised, prior, config)
        if found.verdict.state == "lost" and not found.verdict.hidden:
            local = self._begin(stabilised, scan.mid_ns, local.prior_at(found.pose), config)
            found = local.locate(scan, stabilised, prior, config)
        match = self._joining.place(local, found, scan.mid_ns, config) if found.verdict.accepted else None
        if match is None and found.verdict.accepted and self._is_outside(local, found, config):
            return self._continue(local, found, scan.mid_ns)
        if match is None:
            lost = Verdict("lost", found.verdict.rejection, found.verdict.accepted, confirmed=False)
            return found._replace(verdict=lost)
        self._local = None
        self._main.reset(scan.mid_ns, match.gaussian)
        return LocalisedScan(found.scan, match.pose, match, Verdict("recovered", recovery="relocalised"))

    def _is_unknown(self, scan: StabilisedScan, time_ns: int, prior: PlanarGaussian, config: SlamConfig) -> bool:
        """Whether a local map has to begin: the robot was lost for long, or a gap in the data leaves it unknown.

        It does not begin with a scan that shows too little.
        """
        local = self._local
        if local:
            return time_ns < local.begin_ns or self._follows_gap(scan, prior, time_ns - self._located_ns, config)
        self._joining.carried = self._lost_ns > (LOST_UNAIDED_NS if self._motion.unaided else LOST_NS)
        if self._joining.carried:
            return True
        lapse_ns = time_ns - self._located_ns
        unknown = self._follows_gap(scan, prior, lapse_ns, config)
        return unknown and not covered(self._pyramid, scan, prior, self._main.sure, lapse_ns)

    def _follows_gap(self, scan: StabilisedScan, prior: PlanarGaussian, lapse_ns: int, config: SlamConfig) -> bool:
        """Whether a prediction follows so long a gap in the data, or in the scans, that it tells too little.

        Behind a short gap in the inertial data it does if the scan fits nowhere near it.
        """
        if not (self._motion.inertial and exceeds_basin(prior)):
            return lapse_ns > SILENT_NS and prior.sigma > (STRAYED if self._motion.inertial else FAR)
        if self._local or prior.sigma > FAR:
            return prior.sigma > FAR
        near = self._main.relocaliser.near(prior, self._pyramid, scan, config)
        return near.fit.hit < HITS * self._main.usual

    def _begin(self, scan: StabilisedScan, time_ns: int, prior: PlanarGaussian, config: SlamConfig) -> LocalMap:
        """A local map. It begins where the scan fits near the prediction.

        Otherwise it begins there if the heading is known or matches follow the robot from where it was found; else
        where the robot was sure last.
        """
        main = self._main
        near = main.relocaliser.near(prior, self._pyramid, scan, config)
        if exceeds_basin(prior):
            fits = is_good(near.fit, main.usual)
            otherwise = prior.mean if main.pending else main.sure
        else:
            fits = near.fit.known >= config.tracking.min_overlap and near.fit.hit >= GOOD * main.usual
            otherwise = prior.mean
        begin = near.pose if fits else otherwise
        self._local = local = LocalMap(self._motion, time_ns, begin, prior, config)
        self._joining.begin(begin)
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
        unfound = len(local.scans) >= UNFOUND and not self._joining.any_supported
        return unfound and sum(local.known) < MOSTLY * len(local.known)

    def _continue(self, local: LocalMap, found: LocalisedScan, time_ns: int) -> LocalisedScan:
        """The map goes on where the robot is in the local map."""
        assert found.match is not None
        pose = PlanarGaussian(found.pose, found.match.covariance + local.prior.covariance)
        self._joining.take(local, AT_REST)
        self._local = None
        self._main.reset(time_ns, pose)
        return LocalisedScan(found.scan, found.pose, *continued(found.match, pose, found.verdict))
