"""Aiding sensors: from measurements to corrections, with what each has to know besides the state of the filter.

A compass needs the direction of north in the map, a satellite receiver the pose of the map, a beam to the ground
its height. All of it is estimated while scans are matched, and used against drift when they are not.
"""

import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np

from slam_core import geometry
from slam_core.config import AidingConfig
from slam_core.measurements import (
    Attitude,
    Float64s,
    GpsPosition,
    GpsVelocity,
    GroundDistance,
    Imu,
    MagneticField,
    Transform,
)
from slam_core.navigation.aiding.compass import Compass
from slam_core.navigation.aiding.georeference import Georeference
from slam_core.navigation.aiding.sensors import (
    Gravity,
    GroundBeam,
    MagneticHeading,
    Place,
    Standstill,
    Tilt,
    Velocity,
    ZeroRate,
)
from slam_core.navigation.aiding.standstill import StandstillDetector
from slam_core.navigation.corrections import Correction
from slam_core.navigation.filter import NavigationFilter
from slam_core.navigation.planar_motion import SET_BACK_NS
from slam_core.results import AidingStatus, PlanarGaussian

AidingMeasurement = Attitude | GroundDistance | MagneticField | GpsPosition | GpsVelocity


class Estimator(Protocol):
    """What aids correct: the navigation filter, or the planar motion without an IMU."""

    @property
    def ready(self) -> bool:
        """Whether there is an estimate."""

    @property
    def aiding(self) -> tuple[AidingStatus, ...]:
        """What became of every source."""

    def pose(self, time_ns: int, /) -> Transform:
        """T_map_base at an instant."""

    def motion_at(self, times_ns: Sequence[int], /) -> Float64s:
        """(k, 10) position, attitude, velocity in the map at k instants."""

    def correct(self, time_ns: int, correction: Correction, /) -> bool:
        """A measurement at its own time. Whether it came to its gate."""

    def drop(self, source: str, reason: str, /) -> None:
        """Count a measurement that is of no use."""


# Seconds over which the error of a source is much the same.
LASTING = {"gps": 30.0, "gps velocity": 1.0, "compass": 10.0, "attitude": 2.0, "ground": 0.5}
TRUST_NS = 1_000_000_000  # a match is good for this long
STEP_NS = 300_000_000  # a ground that lies elsewhere for this long has a step
STEEPEST = 0.05  # of the horizontal part of a magnetic field to its vertical one: less shows no north
REGAUGE_NS = 60_000_000_000  # satellites that contradict the map for this long: where it lies was learned wrongly
REST_SPEED = 0.02  # m/s: how still a base stands that stands still
DRIFT_SPEED = 0.3  # m/s: drift of the velocity of an unaided filter at rest
REST_RATE, REST_FORCE = 5e-4, 0.03  # rad/s, m/s²: what is left of motion at rest


class Aids:
    """One for each run; `matched` is called after every accepted match."""

    def __init__(self) -> None:
        self._compass = Compass()
        self._georeference = Georeference()
        self._standstill = StandstillDetector()
        self._ground: float | None = None
        self._last_ns: dict[str, int] = {}
        self._trusted_ns: int | None = None

    @property
    def world(self) -> PlanarGaussian | None:
        """The pose of the map in the tangent plane of the satellites; None while it is not known."""
        return self._georeference.pose() if self._georeference.known else None

    def matched(self, time_ns: int) -> None:
        """A match was accepted at this time."""
        self._trusted_ns = time_ns

    def add_imu(self, imu: Imu, estimator: NavigationFilter, config: AidingConfig) -> None:
        """Every inertial sample: a base that stands still has no velocity, and its gyros read their bias.

        While scans are matched, the matches observe that bias, and standstill corrects tilt and velocity only.
        """
        rest = self._standstill.add(imu) if config.standstill else None
        if rest is None or not estimator.ready or not _may_rest(estimator):
            return
        estimator.correct(imu.stamp_ns, Standstill(REST_SPEED**2, config.gate))
        status = _status("standstill", estimator)
        if status is None or not status.accepted:
            return
        estimator.correct(imu.stamp_ns, Gravity(rest.force, rest.force_variance + REST_FORCE**2, config.gate))
        if not self._trusted(imu.stamp_ns):
            estimator.correct(imu.stamp_ns, ZeroRate(rest.rate, rest.rate_variance + REST_RATE**2, config.gate))

    def take(self, measurement: AidingMeasurement, estimator: Estimator, config: AidingConfig) -> None:
        """One measurement, to the filter if it is of use."""
        if not estimator.ready:
            return
        match measurement:
            case Attitude() if config.attitude:
                self._tilt(measurement, estimator, config)
            case GroundDistance() if config.ground:
                self._beam(measurement, estimator, config)
            case MagneticField() if config.compass:
                self._heading(measurement, estimator, config)
            case GpsPosition() if config.gps:
                self._place(measurement, estimator, config)
            case GpsVelocity() if config.gps:
                self._velocity(measurement, estimator, config)

    def _trusted(self, time_ns: int) -> bool:
        return self._trusted_ns is not None and abs(time_ns - self._trusted_ns) < TRUST_NS

    def _share(self, source: str, time_ns: int) -> float:
        """How much of a source's error is new since its last measurement: 0 for one that is not later."""
        last_ns = self._last_ns.get(source)
        if last_ns is None or time_ns < last_ns - SET_BACK_NS:
            self._last_ns[source] = time_ns
            return 1.0
        self._last_ns[source] = max(time_ns, last_ns)
        return min(max((time_ns - last_ns) * 1e-9 / LASTING[source], 0.0), 1.0)

    def _tilt(self, attitude: Attitude, estimator: Estimator, config: AidingConfig) -> None:
        up = geometry.rotation_matrix(attitude.rotation)[2]
        share = self._share("attitude", attitude.stamp_ns)
        estimator.correct(attitude.stamp_ns, Tilt(up, config.attitude_sigma, share, config.gate))

    def _beam(self, beam: GroundDistance, estimator: Estimator, config: AidingConfig) -> None:
        """A ground that jumped is a step of the ground: the height is kept, and the ground's level moves."""
        status = _status("ground", estimator)
        stepped = status is not None and status.streak > 2 and status.stamp_ns - status.streak_ns > STEP_NS
        if self._ground is None or stepped:
            pose = estimator.pose(beam.stamp_ns)
            end = beam.origin + beam.distance * beam.direction
            self._ground = float(pose.translation[2] + geometry.rotate(pose.rotation, end)[2])
        share = self._share("ground", beam.stamp_ns)
        sigma, parts = config.ground_sigma, (beam.distance, beam.origin, beam.direction)
        estimator.correct(beam.stamp_ns, GroundBeam(*parts, self._ground, sigma, share, config.gate))

    def _heading(self, magnetic: MagneticField, estimator: Estimator, config: AidingConfig) -> None:
        compass, time_ns = self._compass, magnetic.stamp_ns
        x, y, z = geometry.rotate(estimator.pose(time_ns).rotation, magnetic.field).tolist()
        if math.hypot(x, y) <= STEEPEST * abs(z):
            estimator.drop("compass", "magnetic field that points up or down")
            return
        share, variance = self._share("compass", time_ns), config.compass_sigma**2
        if compass.norths:
            variance *= 1.0 + 1.0 / compass.norths
            heading = MagneticHeading(magnetic.field, compass.north, variance, share, config.gate)
            estimator.correct(time_ns, heading)
        if self._trusted(time_ns):
            compass.learn_north(math.atan2(y, x), share, config.compass_sigma)
            if compass.norths:
                turn = math.pi / 2 - config.declination - compass.north
                self._georeference.set_compass(turn, config.compass_sigma)

    def _place(self, fix: GpsPosition, estimator: Estimator, config: AidingConfig) -> None:
        """Fuse it if it is known where the map lies; learn that from it if the map is trusted."""
        R = np.eye(3) * config.gps_sigma**2 if fix.covariance is None else fix.covariance
        share, georeference, accepted = self._share("gps", fix.stamp_ns), self._georeference, True
        if share and georeference.known:
            place, spread = georeference.place(fix.position)
            noise = _turned(georeference.turn, R) + spread
            estimator.correct(fix.stamp_ns, Place(place, noise, fix.antenna, share, config.gate))
            accepted = self._agrees("gps", estimator)
        if share and accepted and self._trusted(fix.stamp_ns):
            pose = estimator.pose(fix.stamp_ns)
            antenna = pose.translation + geometry.rotate(pose.rotation, fix.antenna)
            georeference.add_place(antenna, fix.position, share / float(max(R[0, 0], R[1, 1])))

    def _velocity(self, gps: GpsVelocity, estimator: Estimator, config: AidingConfig) -> None:
        share, georeference, accepted = self._share("gps velocity", gps.stamp_ns), self._georeference, True
        variance = config.gps_velocity_sigma**2
        if share and georeference.turn_known:
            velocity, spread = georeference.vector(gps.velocity)
            noise = variance * np.eye(3) + spread
            estimator.correct(gps.stamp_ns, Velocity(velocity, noise, share, config.gate))
            accepted = self._agrees("gps velocity", estimator)
        if share and accepted and self._trusted(gps.stamp_ns):
            moving = estimator.motion_at([gps.stamp_ns])[0, 7:]
            georeference.add_vector(moving, gps.velocity, share / variance)

    def _agrees(self, source: str, estimator: Estimator) -> bool:
        """Whether the last measurement passed; a long contradiction makes forget where the map lies."""
        status = _status(source, estimator)
        if status is None or status.accepted:
            return True
        if status.streak and status.stamp_ns - status.streak_ns > REGAUGE_NS:
            self._georeference = Georeference()
        return False


def _may_rest(estimator: NavigationFilter) -> bool:
    """Whether the filter's velocity allows for rest: a smooth drive looks the same to inertial sensors.

    A velocity that is merely uncertain, as along a bare corridor, is no reason to take a drive for rest.
    """
    state = estimator.state
    sigma = math.sqrt(float(state.covariance.diagonal()[6:8].max()))
    return math.hypot(state.velocity[0], state.velocity[1]) < min(3.0 * (sigma + REST_SPEED), DRIFT_SPEED)


def _status(source: str, estimator: Estimator) -> AidingStatus | None:
    return next((status for status in estimator.aiding if status.source == source), None)


def _turned(turn: float, covariance: Float64s) -> Float64s:
    """A covariance (3, 3) of the plane in the axes of the map."""
    R = geometry.rotation_matrix(geometry.yaw_quaternion(-turn))
    return np.asarray(R @ covariance @ R.T, np.float64)
