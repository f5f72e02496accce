"""How a scan is matched: as predicted, without what moves, after a search; and whether its match is accepted."""

from collections.abc import Callable

from slam_core.config import MatcherConfig, SlamConfig
from slam_core.localization.along_walls import best_along, measured
from slam_core.localization.deskew_refinement import refine
from slam_core.localization.dynamic_beams import match_background, without_dynamic
from slam_core.localization.few_beams import few_as_none, few_mislead
from slam_core.localization.hidden_walls import match_visible
from slam_core.localization.motion_hypotheses import best_match
from slam_core.localization.tracking import (
    LEAP_SIGMAS,
    NEAR,
    Tracker,
    exceeds_basin,
    is_beyond,
    is_sharp,
    least_unusual,
    mahalanobis_distance,
    search_window,
    sigmas_off,
)
from slam_core.localization.weak_direction import WeakDirection
from slam_core.localization.wheel_prediction import slipped, weighed
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.correlative import find_pose
from slam_core.matching.matcher import coarse_to_fine
from slam_core.measurements import Float64s, LaserScan
from slam_core.navigation.ego_motion import EgoMotion
from slam_core.results import MatchResult, PlanarGaussian, Rejection, Verdict
from slam_core.scan.stabilise import StabilisedScan

Start = Callable[[PlanarGaussian, SlamConfig], Float64s]
"""Where the match of a scan begins, (3,), by its prediction and the settings."""


class ScanMatching:
    """In one map. tracker: what is usual of its matches. weak_direction: in which matches scatter."""

    def __init__(self, pyramid: Pyramid, motion: EgoMotion) -> None:
        self.tracker = Tracker()
        self.weak_direction = WeakDirection()
        self._pyramid, self._motion = pyramid, motion

    def matched(
        self, scan: LaserScan, predicted: StabilisedScan, start: Start, prior: PlanarGaussian, lapse_ns: int,
        config: SlamConfig,
    ) -> tuple[SlamConfig, PlanarGaussian, StabilisedScan, MatchResult]:  # fmt: skip
        """A scan as its match places it. Returns the settings and the prediction to go on with as well.

        A direction that few beams fix may be left to inertial data. Behind a gap in these the heading is unknown,
        and the pose is searched for.
        """
        if self._motion.unaided and config.tracking.keep_speed:
            config, prior, stabilised, match = self._steadied(scan, predicted, start, prior, lapse_ns, config)
        elif self._motion.by_wheels:
            self.weak_direction.held = False
            config, stabilised, match = self._driven(scan, predicted, start, prior, config)
        else:
            self.weak_direction.held = False
            stabilised, match = self.align(scan, predicted, start(prior, config), prior, config)
            if self._motion.knows_speed(scan.mid_ns) and few_mislead(
                self._pyramid, stabilised.points, match, prior, config.matcher
            ):
                config = few_as_none(config)
                stabilised, match = self.align(scan, predicted, start(prior, config), prior, config)
        if self._motion.inertial and exceeds_basin(prior):
            found = self._nearby(scan, predicted, match, prior, config)
            stabilised, match = max((stabilised, match), found, key=lambda each: each[1].fit.hit)
        if config.tracking.ignore_dynamic:
            aligned = stabilised, match
            stabilised, match = self._without_dynamic(predicted, aligned, prior, lapse_ns, config.matcher)
        return config, prior, stabilised, match

    def align(
        self,
        scan: LaserScan,
        stabilised: StabilisedScan,
        start: Float64s,
        prior: PlanarGaussian | None,
        config: SlamConfig,
    ) -> tuple[StabilisedScan, MatchResult]:
        """A scan matched from a start estimate, and its beams as the motion of the match places them."""
        match = coarse_to_fine(self._pyramid, stabilised.points, start, config.matcher, prior=prior)
        motion = self._motion.planar_fallback
        if motion is None:
            return stabilised, match
        return refine(scan, stabilised, match, prior, self._pyramid, motion, config)

    def _steadied(
        self,
        scan: LaserScan,
        stabilised: StabilisedScan,
        start: Start,
        prior: PlanarGaussian,
        lapse_ns: int,
        config: SlamConfig,
    ) -> tuple[SlamConfig, PlanarGaussian, StabilisedScan, MatchResult]:
        """A scan matched by the prediction, and along a direction that few beams fix where most of them fit.

        Where these do not tell either, matches that scatter leave the direction to the mean speed before. Returns
        the settings and the prediction to go on with as well.
        """
        weak, motion, predicted = self.weak_direction, self._motion, stabilised
        applied = weak.configured(config)
        if weak.held:
            prior = motion.keep_speed(scan.mid_ns, weak.direction, weak.speed)
        stabilised, match = self.align(scan, predicted, start(prior, applied), prior, applied)
        begins = weak.begins(match, scan.mid_ns, lapse_ns)
        along = best_along(self._pyramid, stabilised.points, match, prior)
        told = weak.held and along is not None and along.is_observed
        if told:
            weak.release()
        elif begins:
            prior = motion.keep_speed(scan.mid_ns, weak.direction, weak.speed)
        if told or begins:
            applied = weak.configured(config)
            stabilised, match = self.align(scan, predicted, start(prior, applied), prior, applied)
            along = best_along(self._pyramid, stabilised.points, match, prior)
        if along is not None and (match.leaves_direction or along.is_better):
            place = match.pose.copy()
            place[:2] += along.offset
            stabilised, match = self.align(scan, predicted, place, prior, few_as_none(applied))
            match = measured(match, along)
        return applied, prior, stabilised, match

    def _driven(
        self, scan: LaserScan, predicted: StabilisedScan, start: Start, prior: PlanarGaussian, config: SlamConfig
    ) -> tuple[SlamConfig, StabilisedScan, MatchResult]:
        """A scan matched by a prediction of wheels, unless it shows that they slip. Returns the settings, too."""
        heavier = weighed(config)
        stabilised, match = self.align(scan, predicted, start(prior, heavier), prior, heavier)
        if heavier is config:
            return config, stabilised, match
        placed, alone = self.align(scan, predicted, start(prior, config), prior, config)
        slips = slipped(self._pyramid, predicted.points, match, alone, prior)
        self._motion.judge_wheels(scan.mid_ns, slips=slips)
        return (config, placed, alone) if slips else (heavier, stabilised, match)

    def _without_dynamic(
        self, predicted: StabilisedScan, aligned: tuple[StabilisedScan, MatchResult], prior: PlanarGaussian,
        lapse_ns: int, config: MatcherConfig,
    ) -> tuple[StabilisedScan, MatchResult]:  # fmt: skip
        """A scan and its match without what may move, where that is the better one; else as they are."""
        scan, match = aligned
        is_unusual = self.tracker.is_unusual(match, prior, least_unusual(lapse_ns))
        if self._motion.unaided:
            return without_dynamic(self._pyramid, predicted, aligned, prior, config, is_unusual=is_unusual)
        if self._motion.measured and (
            is_unusual or self.tracker.is_bad(match.fit) or mahalanobis_distance(match, prior) > NEAR
        ):
            match = (
                match_background(self._pyramid, scan.points, match, prior, config, measured=True)
                or match_visible(self._pyramid, scan, prior, self.tracker.usual, config)
                or match
            )
        return scan, match

    def check(
        self,
        scan: LaserScan,
        stabilised: StabilisedScan,
        match: MatchResult,
        prior: PlanarGaussian,
        config: SlamConfig,
    ) -> tuple[StabilisedScan, MatchResult, Verdict]:
        """The match if it is accepted, else one that a local search finds, else the verdict against both.

        Where only matches observe the motion, at a low rate, a sudden turn and a wrong match look alike. A match
        that is far from the prediction is compared with the outcome of a search then. One that leaps is no motion.
        Wheels slip in a turn: where they alone observe it besides, a match that fits worse than most is compared,
        too, with what is found at the position of the prediction. So is one whose heading inertial data leave
        unsure.
        """
        tracker, tracking, unaided = self.tracker, config.tracking, self._motion.unaided
        distance = mahalanobis_distance(match, prior)
        rejection = tracker.check(match.fit, distance, tracking)
        limit = tracking.unaided_mahalanobis_limit
        doubtful = unaided and exceeds_basin(prior)
        if doubtful and (rejection or distance > limit or tracker.is_poor(match.fit)):
            better = self._other_motion(scan, (stabilised, match), prior, config)
            if better is not None:
                stabilised, match = better
                distance = mahalanobis_distance(match, prior)
                rejection = tracker.check(match.fit, distance, tracking)
        leaps = unaided and tracker.leaps(match, prior)
        if not (rejection or (doubtful and distance > limit) or leaps):
            sharp = self._motion.inertial and is_sharp(prior)
            if not (unaided or sharp) and tracker.is_poor(match.fit):
                placed, found = self._nearby(scan, stabilised, match, prior, config)
                moved = self._motion.by_wheels and sigmas_off(found, prior) > LEAP_SIGMAS
                if tracker.is_better(found.fit, match.fit) and not moved:
                    stabilised, match = placed, found
            return stabilised, match, tracker.accept(None)
        for placed, candidate in (self._nearby(scan, stabilised, match, prior, config), (stabilised, match)):
            if (unaided and tracker.leaps(candidate, prior)) or is_beyond(candidate, prior, tracking):
                continue
            if tracker.confirms(candidate.fit, mahalanobis_distance(candidate, prior), tracking):
                return placed, candidate, tracker.accept(rejection)
        rejection = rejection or Rejection("mahalanobis_distance", distance, LEAP_SIGMAS if leaps else limit)
        return stabilised, match, tracker.reject(rejection, tracking)

    def _nearby(
        self, scan: LaserScan, stabilised: StabilisedScan, match: MatchResult, prior: PlanarGaussian,
        config: SlamConfig,
    ) -> tuple[StabilisedScan, MatchResult]:  # fmt: skip
        """The match that a local search finds, in place of one that is suspect."""
        self._pyramid.cover(stabilised.points, prior.mean)
        window = search_window(prior, config.tracking)
        start = find_pose(self._pyramid.levels[-1], stabilised.points, prior.mean, window)
        start[:2] -= match.unobservable * (match.unobservable @ (start - prior.mean)[:2])  # any place fits there
        return self.align(scan, stabilised, start, None, config)

    def _other_motion(
        self, scan: LaserScan, aligned: tuple[StabilisedScan, MatchResult], prior: PlanarGaussian,
        config: SlamConfig,
    ) -> tuple[StabilisedScan, MatchResult] | None:  # fmt: skip
        """A clearly better match by another motion of the sweep than the predicted one; None without it."""
        motion = self._motion.planar_fallback
        return best_match(scan, aligned, prior, self._pyramid, motion, config) if motion else None
