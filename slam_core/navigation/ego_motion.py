"""The motion of the base between matches: by the navigation filter, without inertial data by a planar model."""

from collections import Counter
from collections.abc import Iterable, Sequence

import numpy as np

from slam_core import geometry
from slam_core.config import SlamConfig
from slam_core.diagnostics import NO_ATTITUDE, TOO_LATE, Diagnostic
from slam_core.kernels.imu_propagation import MAX_GAP_NS
from slam_core.measurements import (
    Attitude,
    Float64s,
    GpsPosition,
    GpsVelocity,
    Height,
    Imu,
    Int64s,
    LaserScan,
    MagneticField,
    Measurement,
    Odometry,
    Transform,
)
from slam_core.navigation.aiding.aids import AidingMeasurement, Aids
from slam_core.navigation.aiding.planar import PlanarEstimator
from slam_core.navigation.aiding.plausibility import SOURCES, is_plausible
from slam_core.navigation.chi_square import bound
from slam_core.navigation.filter import NavigationFilter, projected
from slam_core.navigation.imu_spikes import SpikeFilter
from slam_core.navigation.monitor import SILENT_NS, Monitor
from slam_core.navigation.planar_motion import WHEELS_SILENT_NS, PlanarMotion, odometry_sigmas
from slam_core.navigation.pose_reset import Origin
from slam_core.navigation.rejections import GAP, SLIPPED, UNUSABLE
from slam_core.navigation.rest import shows_motion
from slam_core.navigation.waiting import Waiting
from slam_core.results import AidingStatus, MatchResult, NavigationState, PlanarGaussian

# The first scan defines the origin of the map: its pose has this covariance.
FIRST_MATCH = MatchResult(
    np.zeros(3), np.diag([1e-6, 1e-6, 1e-6]), np.zeros((3, 3)), np.empty(0, np.float32), (), True, np.empty((0, 4))
)


VAGUE, MOVED_SIGMAS = 0.1, 3.0  # metres, one sigma: nearer than that to where it was, the base is at rest
SETTLED = 10  # matches that many beams fix: by then the filter knows the speed
PATIENCE_NS = 2_000_000_000  # inertial data that shows no attitude is waited for so much longer than it takes


class EgoMotion:
    """Measurements of the motion and matches in, poses and their covariance out.

    inertial: whether the filter is used, which is so from the moment its attitude is known. begins_in_motion:
    whether the base moved then, so that the attitude has to be confirmed.
    """

    def __init__(self, config: SlamConfig) -> None:
        self.inertial = self.begins_in_motion = False
        self._config = config
        self._planar = PlanarMotion()
        self._plane = PlanarEstimator(self._planar)
        self._filter = NavigationFilter(config.navigation, config.platform)
        self._aids = Aids()
        self._monitor = Monitor()
        self._spikes = SpikeFilter(self._filter.counts)
        self._waiting = Waiting()
        self._has_imu = False
        self._first_scan: LaserScan | None = None
        self._lacks_attitude = False
        self._gaps, self._well_fixed = 0, SETTLED  # gaps in the inertial data, and well fixed matches since

    def configure(self, config: SlamConfig) -> None:
        """Change settings from the next measurement on."""
        self._config = config
        self._filter.configure(config.navigation, config.platform)

    @property
    def planar_fallback(self) -> PlanarMotion | None:
        """The planar model, as long as the filter is not used."""
        return None if self.inertial else self._planar

    @property
    def unaided(self) -> bool:
        """Whether nothing but matches observes the motion and the tilt of the base."""
        return not (self.inertial or self._planar.aided)

    @property
    def by_wheels(self) -> bool:
        """Whether wheels measure the motion, and no inertial data."""
        return not self.inertial and self.driven

    @property
    def driven(self) -> bool:
        """Whether wheels measure the motion, by themselves or beside inertial data."""
        if not self.inertial:
            return self._planar.driven
        used = (each.used_ns for each in self._filter.aiding if each.source == SOURCES[Odometry])
        return self._filter.sample_ns - max(used, default=0) <= WHEELS_SILENT_NS

    @property
    def measured(self) -> bool:
        """Whether inertial data or wheels measure the motion."""
        return self.inertial or self.driven

    @property
    def unused(self) -> Counter[str]:
        """Measurements that were not used as they came, by reason."""
        return self._filter.counts + self._plane.counts

    @property
    def aiding(self) -> tuple[AidingStatus, ...]:
        """The status of every source; sensors that only the filter can use are dropped without it."""
        return self._filter.aiding if self.inertial else (*self._plane.aiding, *self._filter.aiding)

    @property
    def world(self) -> PlanarGaussian | None:
        """The pose of the map in the tangent plane of the satellites, once it is known."""
        return self._aids.world

    def latest_ns(self, scan_ns: int) -> int:
        """Time of the latest inertial sample, or of the last scan without any."""
        current = self.inertial and scan_ns - self._filter.sample_ns < SILENT_NS
        return self._filter.sample_ns if current else scan_ns

    def monitor(self, aiding: tuple[AidingStatus, ...], skipped: Counter[str], scan_ns: int) -> None:
        """Find faults of the sources, after a scan."""
        self._monitor.update(self._filter, aiding, skipped, scan_ns)

    def diagnostics(self, scan_ns: int) -> tuple[Diagnostic, ...]:
        """What is wrong with the sources at the time of the last scan."""
        found = self._monitor.diagnostics(scan_ns)
        lacks_attitude = self._lacks_attitude and not (self._filter.ready or self._filter.weightless)
        return (*found, Diagnostic("no_attitude")) if lacks_attitude else found

    def take(self, measurement: Measurement) -> None:
        """Anything but a scan, to the model that is used."""
        if isinstance(measurement, Imu):
            self._add_imu(measurement)
        elif isinstance(measurement, LaserScan):
            return
        elif not is_plausible(measurement):
            estimator = self._filter if self._filter.ready else self._plane
            estimator.drop(SOURCES[type(measurement)], UNUSABLE)
        elif isinstance(measurement, Height):
            self._filter.update_height(measurement.stamp_ns, measurement.height)
        elif self._filter.ready:
            self._aid(measurement)
        elif isinstance(measurement, Attitude):
            self._planar.add_attitude(measurement)
        else:
            self._take_planar(self._waiting.push(measurement))

    def catch_up(self, time_ns: int) -> None:
        """Let the planar model take what was measured up to the time of a scan."""
        self._take_planar(self._waiting.until(time_ns))

    def _take_planar(self, measurements: Iterable[Measurement]) -> None:
        """Yaw rates, wheels and aids to the planar model, which has no distance to the ground."""
        motion = self._config.motion
        for each in measurements:
            if isinstance(each, Imu):
                self._planar.add_yaw_rate(each.stamp_ns, float(each.angular_velocity[2]), motion)
            elif isinstance(each, Odometry):
                if not self._planar.add_odometry(each, motion):
                    self._filter.counts[SLIPPED] += 1
            elif isinstance(each, MagneticField | GpsPosition | GpsVelocity):
                self._plane.configure(motion, self._config.navigation.gate_reset_time)
                self._aids.take(each, self._plane, self._config.aiding)

    def _add_imu(self, imu: Imu) -> None:
        """Inertial data to the filter; while that cannot begin, only the yaw rate is used."""
        self._has_imu = True
        for sample in self._spikes.admit(imu):
            self._filter.predict(sample, self._spikes.hit)
            self._aids.add_imu(sample, self._filter, self._config.aiding)
            if self._filter.weightless:
                self._take_planar(self._waiting.push(sample))

    def _aid(self, aid: AidingMeasurement | Odometry) -> None:
        """Wheels and the other sensors to the filter."""
        if isinstance(aid, Odometry):
            sigma = float(odometry_sigmas(aid, self._config.motion)[0])
            self._filter.update_velocity_body(aid.stamp_ns, aid.velocity, sigma)
        else:
            self._aids.take(aid, self._filter, self._config.aiding)

    def refusal(self, scan: LaserScan, *, begun: bool) -> str:
        """Why a scan has to be skipped; empty if the motion is known at its time. begun: there were scans."""
        if self.awaits_filter(scan, begun):
            return NO_ATTITUDE
        time_ns = scan.mid_ns
        late = self.inertial and self._filter.begin_ns <= time_ns < self._filter.oldest_ns
        return TOO_LATE if late else ""

    def awaits_filter(self, scan: LaserScan, begun: bool) -> bool:
        """Switch to the filter once it is ready. Whether a scan has to be skipped until then, as the first one.

        begun: whether there were scans already.
        """
        if self._filter.ready and not self.inertial:
            self._take_planar(self._waiting.flush())
            if begun:
                self._filter.begin_at(self._planar.prior(self._filter.sample_ns, self._config.motion))
            self.inertial, self._first_scan = True, None
            self.begins_in_motion = self._filter.begins_in_motion and not begun
        if self.inertial:
            return self.begins_in_motion and scan.stamp_ns < self._filter.begin_ns
        if begun or not self._has_imu or self._filter.weightless:
            return False
        if self._first_scan is None or scan.stamp_ns < self._first_scan.stamp_ns:
            self._first_scan = scan
        waited_ns = scan.stamp_ns - self._first_scan.stamp_ns
        self._lacks_attitude = waited_ns > self._config.navigation.level_time * 1e9 + PATIENCE_NS
        self._filter.moves = shows_motion(self._first_scan, scan)
        return not self._lacks_attitude

    def begin_at_origin(self, time_ns: int, *, has_velocity: bool) -> None:
        """The origin of the map is where the base is at a time, with its velocity if that is known."""
        sigma = self._config.navigation.accel_bias_sigma
        self._filter.correct(
            time_ns, Origin(FIRST_MATCH.gaussian, has_velocity=has_velocity, accel_bias_sigma=sigma)
        )
        self._aids = Aids()

    def poses(self, from_ns: int, since_ns: Int64s) -> Float64s:
        """Attitude and position of the base in the map at instants (k,) after `from_ns`: (k, 7) or wider."""
        return (self._filter if self.inertial else self._planar).poses(from_ns, since_ns)

    def motion_at(self, times_ns: Sequence[int]) -> Float64s:
        """(k, 10) position, attitude, and velocity in the map at k instants, predicted on if need be."""
        return self._filter.motion_at(times_ns) if self.inertial else self._planar.motion_at(times_ns)

    def prior(self, time_ns: int) -> PlanarGaussian:
        """The predicted pose in the plane at an instant."""
        if self.inertial:
            return self._filter.planar(time_ns)
        if self._config.platform.no_slip:
            self._planar.constrain_sideways()
        return self._planar.prior(time_ns, self._config.motion)

    def knows_speed(self, time_ns: int) -> bool:
        """Whether inertial data know the speed at a time: after a gap in them matches have to show it again."""
        if not self.inertial or time_ns - self._filter.sample_ns > MAX_GAP_NS:
            return False
        return self._well_fixed >= SETTLED and self._filter.counts[GAP] == self._gaps

    def reaches(self, time_ns: int) -> bool:
        """Whether the state buffer reaches back to a time."""
        return not self.inertial or self._filter.oldest_ns <= time_ns

    def reset_pose(self, time_ns: int, start: PlanarGaussian) -> None:
        """Continue at a pose in the map at a time, wherever the base was estimated before."""
        if self.inertial:
            self._filter.reset_pose(time_ns, start)
        else:
            self._planar.reset_pose(time_ns, start, self._config.motion)

    def keep_speed(self, time_ns: int, direction: Float64s, speed: float) -> PlanarGaussian:
        """The prediction at a speed, m/s, along a direction (2,) of the map; only matches observe the motion."""
        self._planar.keep_speed(direction, speed)
        return self.prior(time_ns)

    def judge_wheels(self, time_ns: int, *, slips: bool) -> None:
        """Whether a scan of this time shows that the wheels slip."""
        self._planar.judge_wheels(time_ns, slips=slips)

    def hold(self, time_ns: int, pose: PlanarGaussian) -> None:
        """Stay at a pose at a time, where only matches observe the motion."""
        self._planar.hold(time_ns, pose, self._config.motion)

    def correct(
        self, time_ns: int, match: MatchResult | None, *, accepted: bool
    ) -> tuple[PlanarGaussian, NavigationState | None]:
        """Section V-B: the fused pose in the plane and the state at a time; a rejected match changes neither.

        match: None for the first scan, whose pose defines the origin of the map.
        """
        if accepted and (match is not None or self.reaches(time_ns)):  # the filter may begin after the first scan
            return self._fuse(time_ns, match or FIRST_MATCH)
        return self.prior(time_ns), self._filter.at(time_ns) if self.inertial else None

    def _fuse(self, time_ns: int, match: MatchResult) -> tuple[PlanarGaussian, NavigationState | None]:
        """Covariance intersection with a match, eqs. (18)-(20)."""
        config = self._config.fusion
        if not self.inertial:
            if match is FIRST_MATCH:
                self._planar.begin_at_origin()
            fused, navigation = self._planar.fuse(match.gaussian, config, match.unobservable), None
            self._plane.matched(time_ns)
        else:
            rule = config.omega, config.method, config.gate
            if match is FIRST_MATCH and self._may_have_moved(time_ns):
                self._filter.reset_pose(time_ns, match.gaussian)
                self._aids = Aids()  # where the map lies in the world is no longer what was found
            navigation = self._filter.fuse_planar(
                time_ns,
                match.pose,
                match.covariance,
                *rule,
                unobservable=match.unobservable,
                widen_vertical=config.widen_vertical,
            )
            fused = projected(navigation)
            if self._filter.counts[GAP] != self._gaps:
                self._gaps, self._well_fixed = self._filter.counts[GAP], 0
            self._well_fixed += not match.is_badly_fixed
        self._aids.matched(time_ns)
        return fused, navigation

    def _may_have_moved(self, time_ns: int) -> bool:
        """Whether the base may be elsewhere than where inertial data began: no map tells where that was."""
        mean, covariance = predicted = self._filter.planar(time_ns)
        off = float(mean @ np.linalg.solve(covariance, mean))
        return predicted.sigma > VAGUE or off > bound(MOVED_SIGMAS, len(mean))

    def estimate(self, time_ns: int, pose: Float64s) -> Transform:
        """T_map_base without inertial data: the pose (3,) of the match, and the tilt of an external attitude."""
        tilt = geometry.split_heading(self._planar.pose(time_ns).rotation)[1]
        rotation = geometry.multiply(geometry.yaw_quaternion(pose[2]), tilt)
        return Transform(np.array([pose[0], pose[1], 0.0]), rotation)
