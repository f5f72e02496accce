"""Figure 1 of the paper: laser scans and inertial data in, map and 6DOF pose out."""

from collections.abc import Sequence

from slam_core.diagnostics import NO_ATTITUDE, NO_BEAM, NOT_LOCALISED, REPEATED
from slam_core.localization.tracking import observed
from slam_core.measurements import LaserScan, Measurement
from slam_core.results import StepResult, Sweep
from slam_core.state import SlamState


class HectorSlam(SlamState):
    """The pipeline: `add` measurements of any sensor in order of arrival, then `finish`.

    `SlamState` has its parameters, and what can be asked of it between two measurements.
    """

    def add(self, measurement: Measurement) -> list[StepResult]:
        """Take in one measurement. The results of the scans that it completes: a scan waits for inertial data."""
        return self._run(self._sequencer.push(measurement))

    def finish(self) -> list[StepResult]:
        """The results of the scans that still wait when there are no more measurements."""
        return self._run(self._sequencer.flush())

    def step(self, measurement: Measurement) -> StepResult | None:
        """One measurement in the order of a `Sequencer`. A scan has a result unless it is skipped."""
        if not isinstance(measurement, LaserScan):
            self._take(measurement)
            return None
        result = self._scan(measurement)
        self._motion.monitor(result.aiding if result else self._motion.aiding, self._skipped, self._scan_ns)
        return result

    def _scan(self, scan: LaserScan) -> StepResult | None:
        """The path of a scan, in the order of figure 1."""
        config, motion, time_ns = self.config, self._motion, scan.mid_ns
        self._scan_ns = scan.end_ns
        raw, scan = scan, self._smooth(scan, config.scan)
        if reason := motion.refusal(scan, begun=self._scans > 0):
            return self._skip(reason)
        motion.catch_up(time_ns)
        stabilised = self._stabilise(scan, motion.poses, config.scan)  # section IV
        if not len(stabilised.points):
            return self._skip(NO_BEAM)
        if self._start and self._start.takes(scan, stabilised, config, self._use):
            return self._skip(NO_ATTITUDE)
        if not self._locator.initialise(stabilised, time_ns, config):
            return self._skip(NOT_LOCALISED)
        prior = self._predict(time_ns)  # section V-A
        if self._repeats.takes(raw, prior.mean, measured=not motion.unaided):
            return self._skip(REPEATED)
        placed, pose, match, verdict = self._locate(scan, stabilised, prior, config)  # sections IV-B, IV-C
        update = self._update(placed, pose, match, verdict, time_ns, config.map, unaided=motion.unaided)
        fused, navigation = self._fuse(time_ns, match, accepted=verdict.accepted)  # section V-B
        fused = self._locator.fused(fused)
        self._repeats.located(fused.mean)
        self._scans += 1
        return StepResult(
            index=self._scans - 1,
            stamp_ns=time_ns,
            T_map_base=navigation.T_map_base if navigation else motion.estimate(time_ns, pose),
            planar=pose.copy(),
            points=placed.points,
            heights=placed.heights,
            unexpected=update.unexpected,
            match=match,
            prior=prior if match else None,
            fused=self._mapper.with_drift(fused, match, verdict, prior),
            navigation=navigation,
            map_updated=update.written,
            beams=len(scan.ranges),
            durations=self._stopwatch.lap(),
            verdict=observed(verdict, match, fused),
            aiding=motion.aiding,
            world=motion.world,
            sweep=Sweep(scan, raw.ranges, placed.poses, config.scan, placed.laser),
        )

    def _skip(self, reason: str) -> StepResult | None:
        self._skipped[reason] += 1
        self._stopwatch.lap()  # of this scan, not of the next one
        return None

    def _run(self, measurements: Sequence[Measurement]) -> list[StepResult]:
        results = [result for measurement in measurements if (result := self.step(measurement))]
        for result in results:
            self._record.append(result)
        return results
