"""How the base moves between matches: as the navigation filter believes, or while there is none, in the plane."""

from collections import Counter
from collections.abc import Sequence

import numpy as np

from slam_core import geometry
from slam_core.config import SlamConfig
from slam_core.measurements import (
    Attitude,
    Float64s,
    GroundDistance,
    Height,
    Imu,
    Int64s,
    LaserScan,
    Measurement,
    Odometry,
    Transform,
)
from slam_core.navigation.aiding.aids import AidingMeasurement, Aids
from slam_core.navigation.aiding.planar import PlanarEstimator
from slam_core.navigation.filter import UNUSABLE, NavigationFilter, projected
from slam_core.navigation.monitor import SILENT_NS, Watch
from slam_core.navigation.planar_motion import PlanarMotion, odometry_sigmas
from slam_core.results import AidingStatus, MatchResult, NavigationState, PlanarGaussian


class EgoMotion:
    """Measurements of the motion go in, and what matches say of it; poses and their uncertainty come out.

    inertial: whether the filter is believed, which is so from the moment it knows its attitude.
    """

    def __init__(self, config: SlamConfig) -> None:
        self.inertial = False
        self._config = config
        self._planar = PlanarMotion()
        self._plane = PlanarEstimator(self._planar)
        self._filter = NavigationFilter(config.navigation, config.platform)
        self._aids = Aids()
        self._watch = Watch()
        self._felt = False

    def configure(self, config: SlamConfig) -> None:
        """Change settings from the next measurement on."""
        self._config = config
        self._filter.configure(config.navigation, config.platform)

    @property
    def guessed(self) -> PlanarMotion | None:
        """The planar motion, as long as nothing better is believed."""
        return None if self.inertial else self._planar

    @property
    def unaided(self) -> bool:
        """Whether nothing but matches tells how the base moves and is tilted."""
        return not (self.inertial or self._planar.aided)

    @property
    def unused(self) -> Counter[str]:
        """Inertial data, and what aids it, that was not used as it came, by reason."""
        return self._filter.counts + self._plane.counts

    @property
    def aiding(self) -> tuple[AidingStatus, ...]:
        """What became of every source; sensors that only the filter can use are dropped without it."""
        return self._filter.aiding if self.inertial else (*self._plane.aiding, *self._filter.aiding)

    @property
    def world(self) -> PlanarGaussian | None:
        """Where the map lies on the earth, once satellites have told."""
        return self._aids.world

    def heard_ns(self, scan_ns: int) -> int:
        """The latest instant of which anything was heard, the last scan's among them."""
        heard = self.inertial and scan_ns - self._filter.sample_ns < SILENT_NS
        return self._filter.sample_ns if heard else scan_ns

    def look(self, aiding: tuple[AidingStatus, ...], skipped: Counter[str], scan_ns: int) -> None:
        """After a scan: notice what is wrong with the sources."""
        self._watch.look(self._filter, aiding, skipped, scan_ns)

    def warnings(self, scan_ns: int) -> tuple[str, ...]:
        """What is wrong with the sources at the time of the last scan, a sentence each with its remedy."""
        return self._watch.warnings(scan_ns)

    def take(self, measurement: Measurement) -> None:
        """Anything but a scan, for whichever motion is believed."""
        if isinstance(measurement, Imu):
            self._feel(measurement)
        elif isinstance(measurement, Height):
            self._filter.update_height(measurement.stamp_ns, measurement.height)
        elif isinstance(measurement, Odometry):
            self._wheels(measurement)
        elif not isinstance(measurement, LaserScan):
            self._aid(measurement)

    def _feel(self, imu: Imu) -> None:
        """Inertial data: to the filter; while that cannot begin, its yaw rate is better than nothing."""
        self._felt = True
        self._filter.predict(imu)
        self._aids.feel(imu, self._filter, self._config.aiding)
        if self._filter.weightless:
            self._planar.add_yaw_rate(imu.stamp_ns, float(imu.angular_velocity[2]), self._config.motion)

    def _wheels(self, odometry: Odometry) -> None:
        motion = self._config.motion
        if self._filter.ready:
            sigma = float(odometry_sigmas(odometry, motion)[0])
            self._filter.update_velocity_body(odometry.stamp_ns, odometry.velocity, sigma, motion.odometry_gate)
        elif np.isfinite([*odometry.velocity, odometry.yaw_rate]).all():
            self._planar.add_odometry(odometry, motion)
        else:
            self._plane.drop("wheels", UNUSABLE)

    def _aid(self, aid: AidingMeasurement) -> None:
        """The other sensors; in the plane there is no distance to the ground."""
        if self._filter.ready:
            self._aids.take(aid, self._filter, self._config.aiding)
        elif isinstance(aid, Attitude):
            self._planar.add_attitude(aid)
        elif not isinstance(aid, GroundDistance):
            self._plane.configure(self._config.motion, self._config.navigation.gate_reset_time)
            self._aids.take(aid, self._plane, self._config.aiding)

    def awaits_filter(self, begun: bool) -> bool:
        """Change over to the filter once it is ready; whether the first scan has to be skipped until then.

        begun: whether there were scans already.
        """
        if self._filter.ready and not self.inertial:
            if begun:
                self._filter.place(self._planar.prior(self._filter.sample_ns, self._config.motion))
            self.inertial = True
        return self._felt and not (self.inertial or begun or self._filter.weightless)

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
            self._planar.grip()
        return self._planar.prior(time_ns, self._config.motion)

    def reaches(self, time_ns: int) -> bool:
        """Whether a belief is kept that reaches back to an instant."""
        return not self.inertial or self._filter.at(time_ns).stamp_ns <= time_ns

    def place(self, time_ns: int, start: PlanarGaussian) -> None:
        """Be at a pose in the map at an instant, wherever the base was believed to be before."""
        if self.inertial:
            self._filter.place_at(time_ns, start)
        else:
            self._planar.place(time_ns, start, self._config.motion)

    def fuse(self, time_ns: int, match: MatchResult) -> tuple[PlanarGaussian, NavigationState | None]:
        """Covariance intersection of the motion with a match at an instant, eqs. (18)-(20)."""
        config = self._config.fusion
        if not self.inertial:
            observed_only = self._config.motion.observed_only
            fused, navigation = self._planar.fuse(match.gaussian, config, match.blind, observed_only), None
            self._plane.matched(time_ns)
        else:
            rule = config.omega, config.method, config.gate
            navigation = self._filter.fuse_planar(
                time_ns,
                match.pose,
                match.covariance,
                *rule,
                blind=match.blind,
                widen_vertical=config.widen_vertical,
            )
            fused = projected(navigation)
        self._aids.believe(time_ns)
        return fused, navigation

    def coast(self, time_ns: int) -> tuple[PlanarGaussian, NavigationState | None]:
        """What `fuse` returns where there is no match to believe: the motion alone."""
        return self.prior(time_ns), self._filter.at(time_ns) if self.inertial else None

    def estimate(self, time_ns: int, pose: Float64s) -> Transform:
        """T_map_base without inertial data: a match (3,), which nothing independent improves; another's tilt."""
        tilt = geometry.split_heading(self._planar.pose(time_ns).rotation)[1]
        rotation = geometry.multiply(geometry.yaw_quaternion(pose[2]), tilt)
        return Transform(np.array([pose[0], pose[1], 0.0]), rotation)
