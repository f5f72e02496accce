"""The paper's figure 1: scans and inertial data in, map and 6DOF pose out."""

from collections import Counter
from collections.abc import Callable, Sequence

import numpy as np

from slam_core import geometry
from slam_core.config import ConfigError, SlamConfig, needs_restart
from slam_core.localization.prior_map import GivenMap
from slam_core.localization.relocalisation import Lookout
from slam_core.localization.tracking import WELL, Tracker, Verdict, disagreement, far_off, is_vague, search_window
from slam_core.mapping.drift import DrawnMap
from slam_core.mapping.keyframes import Updates
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.correlative import find_pose
from slam_core.matching.matcher import coarse_to_fine
from slam_core.measurements import Float64s, LaserScan, Measurement
from slam_core.navigation.ego_motion import EgoMotion
from slam_core.navigation.monitor import NO_ATTITUDE, NO_BEAM
from slam_core.results import NOWHERE, Durations, MatchResult, PlanarGaussian, StepResult
from slam_core.scan.deskew import refine
from slam_core.scan.stabilise import StabilisedScan, stabilise

# Where the map begins is where the first scan was taken: this sure.
FIRST = MatchResult(
    np.zeros(3), np.diag([1e-6, 1e-6, 1e-6]), np.zeros((3, 3)), np.empty(0, np.float32), (), True, np.empty((0, 4))
)


class HectorSlam:
    """The pipeline. Feed it measurements in the order of a `Sequencer`; every scan gives a StepResult.

    clock: nanoseconds for the durations in the results; without one they are 0.
    given: the map to begin with. Scans give results once the robot's place in it is known.
    """

    def __init__(
        self, config: SlamConfig, clock: Callable[[], int] = lambda: 0, given: GivenMap | None = None
    ) -> None:
        self.config = config
        self.pyramid = given.pyramid(config.map) if given else Pyramid(config.map)
        self._lookout = Lookout(given.start if given else FIRST.pose)
        self._placed = given is None
        self._writes = given is None or given.write
        self.skipped: Counter[str] = Counter()
        self.trace = False
        self._clock = clock
        self._motion = EgoMotion(config)
        self._tracker = Tracker()
        self._scan_ns = 0
        self._index = 0
        self._pose = np.zeros(3)
        self._fused = np.zeros(3)
        self._drawn = DrawnMap()
        self._updates = Updates()
        self._doubted_ns = 0
        self._waiting_ns = 0

    def configure(self, config: SlamConfig) -> None:
        """Change settings from the next measurement on; ConfigError if the map would have to be rebuilt."""
        if needs_restart(self.config, config):
            raise ConfigError("this change needs a new map: restart the run with it")
        self.config = config
        self._motion.configure(config)

    @property
    def searching(self) -> str:
        """Why the robot's place in the map is unknown at this moment; empty while it is known."""
        return self._lookout.reason

    @property
    def notes(self) -> tuple[str, ...]:
        """What is worth telling once: where in a given map the run began."""
        return (self._lookout.note,) if self._lookout.note else ()

    @property
    def now_ns(self) -> int | None:
        """The latest instant of which anything was heard; None before the first scan."""
        return self._motion.heard_ns(self._scan_ns) if self._index else None

    def motion_at(self, times_ns: Sequence[int]) -> Float64s:
        """(k, 10) position, attitude, and velocity in the map at k instants, predicted on if need be."""
        return self._motion.motion_at(times_ns)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What holds the pipeline back at the time of the last scan, a sentence each with its remedy."""
        limit = self.pyramid.stopped_at
        warnings = self._motion.warnings(self._scan_ns)
        if not limit:
            return warnings
        full = f"the map stopped growing at its limit of {limit:g} MB: raise map.limit or map.resolution"
        return full, *warnings

    @property
    def unused(self) -> Counter[str]:
        """Inertial data, and what aids it, that was not used as it came, by reason."""
        return self._motion.unused

    def step(self, measurement: Measurement) -> StepResult | None:
        """Take in one measurement. Scans give a result, unless they are skipped (counted in `skipped`)."""
        if isinstance(measurement, LaserScan):
            result = self._scan(measurement)
            aiding = result.aiding if result else self._motion.aiding
            self._motion.look(aiding, self.skipped, self._scan_ns)
            return result
        begin = self._clock()
        self._motion.take(measurement)
        self._waiting_ns += self._clock() - begin
        return None

    def _scan(self, scan: LaserScan) -> StepResult | None:
        self._scan_ns = scan.end_ns
        mid_ns = (scan.stamp_ns + self._scan_ns) // 2
        if self._motion.awaits_filter(self._index > 0):
            self.skipped[NO_ATTITUDE] += 1
            return None
        clock = self._clock
        begun = clock()
        leveled = stabilise(scan, self._motion.poses, self.config.scan)
        leveled_at = clock()
        if not len(leveled.points):
            self.skipped[NO_BEAM] += 1
            return None
        if not self._placed and not self._begin(leveled, mid_ns):
            self.skipped["scan before the robot was found in the map"] += 1
            return None
        prior = self._motion.prior(mid_ns)
        matching_at = clock()
        leveled, match, verdict = self._match(scan, leveled, prior, mid_ns)
        matched_at = clock()
        unexpected = self.pyramid.unexpected(leveled.points, self._pose)
        updated = verdict.believed and self._map(leveled, match, mid_ns)
        if match and verdict.believed:
            self._doubt(leveled, mid_ns)
        mapped_at = clock()
        seen, motion = match or FIRST, self._motion
        fuses = verdict.believed and (match is not None or motion.reaches(mid_ns))  # the filter may begin later
        fused, navigation = motion.fuse(mid_ns, seen) if fuses else motion.coast(mid_ns)
        self._fused = fused.mean
        if self._writes:  # a map that is only read was drawn by another drive, whatever this one loses
            fused = self._drawn.claim(fused, seen.blind)
        T_map_base = navigation.T_map_base if navigation else motion.estimate(mid_ns, self._pose)
        filtering_ns = matching_at - leveled_at + clock() - mapped_at + self._waiting_ns
        self._index, self._waiting_ns = self._index + 1, 0
        return StepResult(
            index=self._index - 1,
            stamp_ns=mid_ns,
            T_map_base=T_map_base,
            planar=self._pose.copy(),
            points=leveled.points,
            heights=leveled.heights,
            unexpected=unexpected,
            match=match,
            prior=prior if match else None,
            fused=fused,
            navigation=navigation,
            map_updated=updated,
            beams=len(scan.ranges),
            durations=Durations(
                leveled_at - begun, matched_at - matching_at, mapped_at - matched_at, filtering_ns
            ),
            tracking=verdict.state,
            reason=verdict.reason,
            aiding=motion.aiding,
            world=motion.world,
        )

    def _begin(self, leveled: StabilisedScan, time_ns: int) -> bool:
        """Set the robot down where it starts in the given map, once that is known."""
        if not self._motion.reaches(time_ns):
            return False  # no belief that could be set down
        start = self._lookout.start(self.pyramid, leveled, time_ns, self.config)
        if start is not None:
            self._place(time_ns, start)
            self._placed = True
        return self._placed

    def _place(self, time_ns: int, start: PlanarGaussian) -> None:
        """Set the motion down at a pose in the map."""
        self._motion.place(time_ns, start)
        self._pose = self._fused = start.mean

    def _match(
        self, scan: LaserScan, leveled: StabilisedScan, prior: PlanarGaussian, time_ns: int
    ) -> tuple[StabilisedScan, MatchResult | None, Verdict]:
        """Align the scan with the map and judge that; no match for the first scan, whose pose is the origin.

        With it comes the scan as its beams lie by what the match says of the motion.
        """
        if self.pyramid.empty:
            return leveled, None, WELL
        leveled, match = self._align(scan, leveled, self._start_estimate(prior), prior)
        verdict = WELL
        if self.config.tracking.check:
            leveled, match, verdict = self._judge(scan, leveled, match, prior)
        if verdict.state == "lost" and self.config.tracking.relocalise:
            match, verdict = self._seek(match, verdict, leveled, time_ns)
        if verdict.beyond and self._writes and self.config.tracking.continue_from_prediction:
            match, verdict = self._go_on(match, verdict, prior)
        if verdict.believed:
            self._lookout.rest()
        self._pose = match.pose if verdict.believed else prior.mean
        return leveled, match, verdict

    def _align(
        self, scan: LaserScan, leveled: StabilisedScan, start: Float64s, prior: PlanarGaussian | None
    ) -> tuple[StabilisedScan, MatchResult]:
        """A scan matched from a start, and how its beams lie then."""
        match = coarse_to_fine(
            self.pyramid, leveled.points, start, self.config.matcher, prior=prior, trace=self.trace
        )
        guess = self._motion.guessed
        if guess is None:
            return leveled, match
        return refine(scan, leveled, match, prior, self.pyramid, guess, self.config, trace=self.trace)

    def _judge(
        self, scan: LaserScan, leveled: StabilisedScan, match: MatchResult, prior: PlanarGaussian
    ) -> tuple[StabilisedScan, MatchResult, Verdict]:
        """The match if it can be believed, else one found further away, else the verdict against both.

        Where matches alone tell the motion, and seldom, a sudden turn and a match astray look alike: what then
        surprises is looked at twice.
        """
        config, tracker = self.config.tracking, self._tracker
        sigmas = disagreement(match, prior)
        reason = tracker.doubt(match.fit, sigmas, config)
        surprises = self._motion.unaided and is_vague(prior) and sigmas > config.unaided_mahalanobis_limit
        if not (reason or surprises):
            return leveled, match, tracker.believe(match.fit, reason)
        start = find_pose(self.pyramid.levels[-1], leveled.points, prior.mean, search_window(prior, config))
        start[:2] -= match.blind * (match.blind @ (start - prior.mean)[:2])  # there any place fits as well
        for placed, candidate in (self._align(scan, leveled, start, None), (leveled, match)):
            if tracker.convinces(candidate.fit, disagreement(candidate, prior), config):
                return placed, candidate, tracker.believe(candidate.fit, reason)
        return leveled, match, tracker.miss(match.fit, reason or far_off(sigmas), config)

    def _seek(
        self, match: MatchResult, verdict: Verdict, leveled: StabilisedScan, time_ns: int
    ) -> tuple[MatchResult, Verdict]:
        """A lost robot, sought in the whole map; as it was if it is not found."""
        found = self._lookout.again(self.pyramid, leveled, time_ns, self.config)
        if found is None:
            return match, verdict
        self._place(time_ns, found.gaussian)
        return found, self._tracker.believe(found.fit, f"{verdict.reason}; found by a search of the whole map")

    def _go_on(self, match: MatchResult, verdict: Verdict, prior: PlanarGaussian) -> tuple[MatchResult, Verdict]:
        """Of a robot that got lost beyond its map: that goes on from the prediction, as uncertain as it is.

        With nothing to match against the pose would drift for good.
        """
        self._tracker.rest()
        self._drawn.go_on(prior)
        self._updates.forget()
        nothing = np.full_like(match.residuals, 0.5)
        match = match._replace(pose=prior.mean, covariance=prior.covariance, residuals=nothing, blind=NOWHERE)
        return match, Verdict("recovered", f"{verdict.reason}: the map goes on from the prediction")

    def _start_estimate(self, prior: PlanarGaussian) -> Float64s:
        """Section V-B: the filter projected to the plane, its motion since the last match, or that match."""
        if self.config.matcher.start_estimate == "filter":
            return prior.mean
        if self.config.matcher.start_estimate == "velocity":
            moved = geometry.compose(geometry.inverse(self._fused), prior.mean)
            return geometry.compose(self._pose, moved)
        return self._pose

    def _map(self, leveled: StabilisedScan, match: MatchResult | None, time_ns: int) -> bool:
        """Write the scan at the matched pose if it is time to write one."""
        residuals = match.residuals if match and self._motion.unaided else None
        if not (self._writes and self._updates.writes(self._pose, time_ns, residuals, self.config.map)):
            return False
        self.pyramid.update(leveled.points, leveled.cleared, leveled.laser, self._pose, self.config.map)
        return True

    def _doubt(self, leveled: StabilisedScan, time_ns: int) -> None:
        """Every now and then, doubt what the scan says has moved on: a robot at rest, too, sees people go."""
        interval_ns = round(self.config.map.clear_interval * 1e9)
        if self._writes and 0 < interval_ns <= time_ns - self._doubted_ns:
            self._doubted_ns = time_ns
            self.pyramid.doubt(leveled.points, leveled.laser, self._pose, self.config.map)
