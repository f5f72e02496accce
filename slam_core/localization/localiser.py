"""The pose of each scan in the map: scan matching, acceptance of the match, and recovery after a bad one."""

from typing import NamedTuple

import numpy as np

from slam_core import geometry
from slam_core.config import SlamConfig
from slam_core.localization.confirmation import Confirmation, is_vague
from slam_core.localization.dynamic_beams import mostly_objects
from slam_core.localization.hidden_walls import covered, misled
from slam_core.localization.place_search import apart
from slam_core.localization.rejected_matches import CONTRADICTS
from slam_core.localization.relocalisation import Relocaliser
from slam_core.localization.scan_matching import ScanMatching
from slam_core.localization.search_parts import Region
from slam_core.localization.tracking import (
    NEAR,
    exceeds_basin,
    is_good,
    least_unusual,
    mahalanobis_distance,
    too_few,
)
from slam_core.localization.weak_direction import WeakDirection
from slam_core.mapping.pyramid import Pyramid
from slam_core.measurements import Float64s, LaserScan, Transform
from slam_core.navigation.ego_motion import EgoMotion
from slam_core.results import (
    ACCEPTED,
    NOWHERE,
    Fit,
    MatchResult,
    PlanarGaussian,
    Rejection,
    Tracking,
    Verdict,
)
from slam_core.scan.stabilise import StabilisedScan

DOUBTED = 0.2  # metres from the prediction; nearer, a match that fits badly is believed as well
# Metres, metres, radians: how far off a robot may be that stays where it was sure last, and more a scan since.
HELD, HELD_GROWTH, HELD_MOST = np.array([0.3, 0.3, 0.5]), 0.1, 2.0


class LocalisedScan(NamedTuple):
    """A scan at its pose (3,) in the map: that of the match if it is accepted, else as a `Verdict` says.

    scan: its beams are placed by the motion that the match shows. match: None for the first scan of a map.
    """

    scan: StabilisedScan
    pose: Float64s
    match: MatchResult | None
    verdict: Verdict


class Localiser:
    """One for each run.

    start: (3,) where the run begins; None if that may be anywhere in a prior map. is_prior: the map is a prior
    map. writes: the run writes the map. fused: (3,) the mean of the last fused pose.
    """

    def __init__(
        self, pyramid: Pyramid, motion: EgoMotion, start: Float64s | None, *, is_prior: bool, writes: bool
    ) -> None:
        self.relocaliser = Relocaliser(start)
        self.fused = self._pose = np.zeros(3)
        self._pyramid = pyramid
        self._motion = motion
        self._is_localised = not is_prior
        self._writes = writes
        self._located_ns = 0
        self._mount: Transform | None = None  # of the last scan whose pose was sure
        self._matching = ScanMatching(pyramid, motion)
        self._confirmation = Confirmation(self._pose)

    def initialise(self, scan: StabilisedScan, time_ns: int, config: SlamConfig) -> bool:
        """Whether the pose in the map is known; at the start in a prior map it is searched for."""
        if not (self._is_localised or too_few(scan.points)) and self._motion.reaches(time_ns):
            start = self.relocaliser.start(self._pyramid, scan, time_ns, config)
            if start is not None:
                self._reset_pose(time_ns, start)
                self._is_localised = True
        return self._is_localised

    def locate(
        self, scan: LaserScan, stabilised: StabilisedScan, prior: PlanarGaussian, config: SlamConfig
    ) -> LocalisedScan:
        """Sections IV-B and IV-C. The first scan of a map is not matched: its pose is the origin."""
        time_ns = scan.mid_ns
        lapse_ns = time_ns - self._located_ns
        if self._pyramid.empty or not config.tracking.check:
            self._located_ns, self._mount = time_ns, scan.T_base_laser
            return self._unchecked(scan, stabilised, prior, config)
        matching, tracker = self._matching, self._matching.tracker
        config, prior, stabilised, match = matching.matched(
            scan, stabilised, self.start_estimate, prior, lapse_ns, config
        )
        if why := self._tells_nothing(stabilised, match, prior, lapse_ns, len(scan.ranges)):
            return self._hidden(stabilised, match, prior, why)
        self._located_ns = time_ns
        stabilised, match, verdict = matching.check(scan, stabilised, match, prior, config)
        if self._begins_view(scan, verdict, prior):
            tracker.reset()
            match, verdict = continued(match, prior, verdict)
        elif not verdict.accepted:
            prior, verdict = self._miss(verdict, match.fit, prior, time_ns, config)
        if config.tracking.relocalise and (verdict.state == "lost" or self._confirmation.awaits_search):
            match, verdict = self._relocalise(stabilised, match, verdict, time_ns, prior, config)
        if verdict.outside_map and not tracker.is_missing and self.may_continue(prior, config):
            match, verdict = self._continue(match, verdict, prior)
        elif verdict.accepted:
            verdict = self._confirmation.accepted(
                match.pose,
                match.fit,
                verdict,
                prior,
                tracker.usual,
                time_ns,
                config.tracking,
                is_unusual=self._motion.unaided and tracker.is_unusual(match, prior, DOUBTED),
                measured=self._is_measured(prior),
            )
            if verdict.confirmed:
                tracker.learn(match, prior)
        if verdict.accepted and verdict.confirmed:
            self.relocaliser.reset()
            self._mount = scan.T_base_laser
        self._jump(match, verdict, prior, time_ns)
        self._pose = match.pose if verdict.accepted else prior.mean
        if self._motion.unaided:
            matching.weak_direction.moved(time_ns, self._pose)
        return LocalisedScan(stabilised, self._pose, match, verdict)

    def _unchecked(
        self, scan: LaserScan, stabilised: StabilisedScan, prior: PlanarGaussian, config: SlamConfig
    ) -> LocalisedScan:
        """The first scan of a map, or the match of another as it is."""
        if self._pyramid.empty:
            return LocalisedScan(stabilised, self._pose, None, ACCEPTED)
        self._matching.weak_direction.held = False
        stabilised, match = self._matching.align(
            scan, stabilised, self.start_estimate(prior, config), prior, config
        )
        self._pose = match.pose
        self._forget()
        return LocalisedScan(stabilised, self._pose, match, ACCEPTED)

    def _tells_nothing(
        self, scan: StabilisedScan, match: MatchResult, prior: PlanarGaussian, lapse_ns: int, beams: int
    ) -> Rejection | None:
        """Why a scan tells neither for nor against the prediction; None if it tells something."""
        tracker, why = self._matching.tracker, None
        if self._motion.inertial and tracker.is_unusual(match, prior, least_unusual(lapse_ns)):
            why = misled(self._pyramid, scan, match, prior)
        fits = self._fits(match.fit, prior)
        if why is None and not (fits and self._confirmation.is_sure):
            why = too_few(scan.points)
        if why is None and not fits and self._motion.driven:
            why = mostly_objects(scan.points, beams)
        if why is None and (tracker.is_missing or not fits):
            why = covered(self._pyramid, scan, prior, self.sure, lapse_ns)
        return why

    def _begins_view(self, scan: LaserScan, verdict: Verdict, prior: PlanarGaussian) -> bool:
        """Whether a second laser looks where there is no map yet, at a pose that is known by the first."""
        if verdict.accepted or verdict.rejection is None or verdict.rejection.code != "overlap":
            return False
        is_other = self._mount is not None and not self._mount.is_same(scan.T_base_laser)
        return is_other and self._confirmation.is_sure and not is_vague(prior)

    def _fits(self, fit: Fit, prior: PlanarGaussian) -> bool:
        """Whether a match fits so well that the laser is not covered.

        Between two scans at a low rate a robot that only matches observe moves on: the others may fit badly, too.
        """
        if self._motion.unaided and is_vague(prior):
            return fit.hit >= CONTRADICTS * self._matching.tracker.usual
        return is_good(fit, self._matching.tracker.usual)

    def _hidden(
        self, scan: StabilisedScan, match: MatchResult, prior: PlanarGaussian, why: Rejection
    ) -> LocalisedScan:
        """A scan that tells neither for nor against the prediction, where it stays.

        What hides the map may still be there in the next one; objects show themselves in each. Without other
        sensors a vague prediction is worth less than the last sure pose.
        """
        vague = is_vague(prior)
        if why.code == "hidden":
            self._matching.tracker.miss()
        self._pose = prior.mean
        if vague and self._motion.unaided:
            self._pose, self._matching.weak_direction = self.sure, WeakDirection()
        state: Tracking = "lost" if vague or self._confirmation.is_lost else "degraded"
        return LocalisedScan(scan, self._pose, match, Verdict(state, why, accepted=False))

    def start_estimate(self, prior: PlanarGaussian, config: SlamConfig) -> Float64s:
        """Section V-B: the filter projected to the plane, its motion since the last match, or that match."""
        if config.matcher.start_estimate == "filter":
            return prior.mean
        if config.matcher.start_estimate == "velocity":
            moved = geometry.compose(geometry.inverse(self.fused), prior.mean)
            return geometry.compose(self._pose, moved)
        return self._pose

    def _miss(
        self, verdict: Verdict, fit: Fit, prior: PlanarGaussian, time_ns: int, config: SlamConfig
    ) -> tuple[PlanarGaussian, Verdict]:
        """After a rejected match: the pose to go on from, and the verdict.

        Where only matches observe the motion, a robot that is lost, or was found at a wrong place, stays where it
        was sure last. Other sensors have one that was found at a wrong place go on from where it was predicted.
        """
        confirmation, rejected = self._confirmation, self._confirmation.rejected_matches
        rejected.add(fit, self._matching.tracker.usual, config.tracking, is_vague=is_vague(prior))
        predicted = confirmation.as_predicted(prior.mean, time_ns) if self._is_measured(prior) else None
        failed = confirmation.rejected()
        if predicted is not None:
            self._reset_pose(time_ns, predicted)
            prior = predicted
        lost_long = confirmation.missed >= config.tracking.lost_after
        if confirmation.is_lost or lost_long:
            outside = rejected.count >= config.tracking.lost_after and rejected.outside_map
            verdict = verdict._replace(state="lost", outside_map=outside)
        if self._motion.unaided and (failed or verdict.state == "lost"):
            sigmas = np.minimum(HELD + HELD_GROWTH * confirmation.missed, HELD_MOST)
            prior = PlanarGaussian(confirmation.pose.copy(), np.diag(sigmas**2))
            self._motion.hold(time_ns, prior)
            self._matching.weak_direction = WeakDirection()
        return prior, verdict

    def _relocalise(
        self, scan: StabilisedScan, match: MatchResult, verdict: Verdict, time_ns: int, prior: PlanarGaussian,
        config: SlamConfig,
    ) -> tuple[MatchResult, Verdict]:  # fmt: skip
        """Look for a lost robot where it can have come, or for a better place than the one it was found at."""
        waiting = match.pose if verdict.accepted else None
        predicted = prior if self._is_measured(prior) else None
        region = self._confirmation.region(time_ns, waiting, predicted)
        found = self.relocaliser.search(self._pyramid, scan, time_ns, prior.mean, region, config, waiting)
        if found is None:
            return match, verdict
        if verdict.accepted:
            if not apart(found.pose, match.pose):
                self._confirmation.agrees()
                return match, verdict
            self._confirmation.rejected()
        self._reset_pose(time_ns, found.gaussian)
        accepted = self._matching.tracker.accept(verdict.rejection)
        return found, accepted._replace(recovery="relocalised")

    def _is_measured(self, prior: PlanarGaussian) -> bool:
        """Whether other sensors made a prediction: over a gap in them even the heading becomes unknown."""
        return self._motion.measured and not exceeds_basin(prior)

    def _jump(self, match: MatchResult, verdict: Verdict, prior: PlanarGaussian, time_ns: int) -> None:
        """Go on at a match that a local search found far beyond the noise of an inertial prediction.

        The robot did not move there: as a measurement it would change the velocity and the tilt.
        """
        was_searched = verdict.accepted and verdict.rejection is not None and not verdict.recovery
        if self._motion.inertial and was_searched and mahalanobis_distance(match, prior) > NEAR:
            self._reset_pose(time_ns, match.gaussian)

    def _continue(
        self, match: MatchResult, verdict: Verdict, prior: PlanarGaussian
    ) -> tuple[MatchResult, Verdict]:
        """The prediction as the pose of a robot that got lost outside of the map: the map continues from it.

        With nothing to match against the pose would drift for good.
        """
        self._matching.tracker.reset()
        self._confirmation = Confirmation(prior.mean)
        return continued(match, prior, verdict)

    def may_continue(self, prior: PlanarGaussian, config: SlamConfig) -> bool:
        """Whether the map may go on from a prediction outside of it, which nothing shows to be wrong."""
        possible = self._writes and not self._motion.unaided and config.tracking.continue_from_prediction
        return possible and not (exceeds_basin(prior) or self._confirmation.rejected_matches.contradict)

    @property
    def pending(self) -> bool:
        """Whether matches follow the robot from a place that waits to be confirmed."""
        return self._confirmation.pending

    @property
    def sure(self) -> Float64s:
        """(3,) the last pose that was sure."""
        return self._confirmation.pose

    @property
    def rested(self) -> bool:
        """Whether the robot stood still when it was sure last."""
        return self._confirmation.rested

    @property
    def usual(self) -> float:
        """The mean inlier ratio of accepted matches."""
        return self._matching.tracker.usual

    def region(self, time_ns: int, motion: Float64s, prior: PlanarGaussian) -> Region | None:
        """Where the robot can have been at a time, with its motion (3,) from then on.

        prior: the prediction at that time.
        """
        return self._confirmation.limited(time_ns, motion, prior if self._is_measured(prior) else None)

    def reset(self, time_ns: int, pose: PlanarGaussian) -> None:
        """Continue at a pose that somebody states, and match from there."""
        self._reset_pose(time_ns, pose)
        self._is_localised = True
        self._forget()

    def _forget(self) -> None:
        """What matches before the present pose showed, and a search that has not ended."""
        self._matching.tracker.reset()
        self._confirmation = Confirmation(self._pose)
        self.relocaliser.reset()

    def _reset_pose(self, time_ns: int, pose: PlanarGaussian) -> None:
        """Continue at a pose in the map, wherever the robot was estimated before."""
        self._motion.reset_pose(time_ns, pose)
        self._matching.weak_direction = WeakDirection()
        self._pose = self.fused = pose.mean


def continued(match: MatchResult, prior: PlanarGaussian, verdict: Verdict) -> tuple[MatchResult, Verdict]:
    """The match and the verdict of a scan outside of the map, which goes on from its prediction."""
    unknown = np.full_like(match.residuals, 0.5)
    match = match._replace(pose=prior.mean, covariance=prior.covariance, residuals=unknown, unobservable=NOWHERE)
    return match, Verdict("recovered", verdict.rejection, recovery="continued")
