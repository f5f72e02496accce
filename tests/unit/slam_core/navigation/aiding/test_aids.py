"""Aiding sensors and the filter together, on rides whose truth is known."""

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
import pytest

from slam_core import geometry
from slam_core.config import AidingConfig, NavigationConfig
from slam_core.measurements import Attitude, GpsPosition, GpsVelocity, GroundDistance, MagneticField
from slam_core.navigation.aiding.aids import AidingMeasurement, Aids
from slam_core.navigation.filter import NavigationFilter
from slam_core.results import AidingStatus
from tests.motions import Ride, gait, stamp, still

ON = AidingConfig()
OFF = AidingConfig(gps=False, compass=False, ground=False, attitude=False, standstill=False)
R = np.diag([0.005, 0.005, np.radians(0.1)]) ** 2
TURN = 0.7  # of the map in the plane of the satellites
NORTH = geometry.rotate(geometry.yaw_quaternion(-TURN), np.array([0.0, 2e-5, -4e-5]))
Measure = Callable[[Ride, float], AidingMeasurement]


def to_plane(vector: np.ndarray) -> np.ndarray:
    return geometry.rotate(geometry.yaw_quaternion(TURN), vector)


def fix(ride: Ride, t: float) -> GpsPosition:
    return GpsPosition(stamp(t), to_plane(ride.position(t)) + 50.0, np.eye(3), np.zeros(3))


def speed(ride: Ride, t: float) -> GpsVelocity:
    return GpsVelocity(stamp(t), to_plane(ride.velocity(t)))


def field(ride: Ride, t: float) -> MagneticField:
    return MagneticField(stamp(t), ride.attitude(t).T @ NORTH)


def beam(ride: Ride, t: float, floor: float = -1.0) -> GroundDistance:
    down = ride.attitude(t)[2, 2]
    return GroundDistance(stamp(t), (ride.position(t)[2] - floor) / down, np.zeros(3), np.array([0.0, 0.0, -1.0]))


def upright(ride: Ride, t: float) -> Attitude:
    """With a yaw of its own, which does not matter."""
    turned = geometry.multiply(geometry.yaw_quaternion(2.0), geometry.from_rotation_matrix(ride.attitude(t)))
    return Attitude(stamp(t), turned)


class Drive:
    """A ride with inertial data at 100 Hz, matches at 20 Hz until `blind_s`, and aids at 10 Hz."""

    def __init__(self, ride: Ride, *measures: Measure, config: AidingConfig = ON, blind_s: float = 1e9) -> None:
        self.ride, self.measures, self.config, self.blind_s = ride, measures, config, blind_s
        self.drift = np.zeros(3)  # of the gyros once there are no more matches
        walk = NavigationConfig(zero_velocity_threshold=2.0)  # it comes to no more
        self.estimator, self.aids = NavigationFilter(walk), Aids()

    def run(self, seconds: float, bias: np.ndarray | None = None, seed: int = 0) -> Iterator[float]:
        """Yields the time after every tenth of a second."""
        estimator, aids = self.estimator, self.aids
        for k, sample in enumerate(self.ride.samples(seconds, noise=1.0, bias=bias, seed=seed)):
            drift = self.drift if k / 100 > self.blind_s else 0.0
            felt = replace(sample, angular_velocity=sample.angular_velocity + drift)
            estimator.predict(felt)
            aids.add_imu(felt, estimator, self.config)
            t = k / 100
            if k % 5 == 0 and estimator.ready and t < self.blind_s:
                attitude = geometry.from_rotation_matrix(self.ride.attitude(t))
                xi = np.array([*self.ride.position(t)[:2], geometry.heading(attitude)])
                estimator.fuse_planar(stamp(t), xi, R, 0.02)
                aids.matched(stamp(t))
            if k % 10 == 0:
                for measure in self.measures:
                    aids.take(measure(self.ride, t), estimator, self.config)
                yield t

    def finish(self, seconds: float, bias: np.ndarray | None = None) -> "Drive":
        """The whole of it."""
        for _ in self.run(seconds, bias):
            pass
        return self

    def off_course(self, t: float) -> float:
        """Error of the position in the plane, metres."""
        there = self.estimator.at(stamp(t)).T_map_base.translation
        return float(np.hypot(*(there - self.ride.position(t))[:2]))

    def status(self, source: str) -> AidingStatus:
        """What became of a source."""
        return next(status for status in self.estimator.aiding if status.source == source)


def test_satellites_hold_the_position_when_the_matches_end() -> None:
    """15 s of walking without a match: within 0.3 m with satellites, far off without."""
    aided = Drive(gait(), fix, speed, blind_s=15.0).finish(30.0)
    alone = Drive(gait(), fix, speed, config=OFF, blind_s=15.0).finish(30.0)
    assert aided.aids.world is not None
    assert aided.aids.world.mean[2] == pytest.approx(TURN, abs=0.05)
    np.testing.assert_allclose(aided.aids.world.mean[:2], 50.0, atol=0.5)
    assert aided.off_course(30.0) < 0.3 < 1.0 < alone.off_course(30.0)


def test_satellites_are_not_used_before_it_is_known_where_the_map_lies() -> None:
    """A robot that stands tells no direction, so that no fix is fused; without matches nothing is learned."""
    assert not any(s.source.startswith("gps") for s in Drive(still(), fix, speed).finish(5.0).estimator.aiding)
    assert Drive(gait(), fix, speed, blind_s=0.0).finish(8.0).aids.world is None


def test_a_fix_that_jumps_moves_nothing() -> None:
    """50 m for five seconds: every such fix is rejected, the pose stays, and later ones are used again."""

    def jumping(ride: Ride, t: float) -> GpsPosition:
        there = fix(ride, t)
        return replace(there, position=there.position + (50.0 if 15.0 <= t < 20.0 else 0.0))

    drive = Drive(gait(), jumping, speed)
    worst = max(drive.off_course(t) for t in drive.run(25.0) if t > 2.0)
    assert worst < 0.05
    assert drive.status("gps").rejected == 50
    assert drive.status("gps").accepted


def test_a_compass_holds_the_heading_when_the_matches_end() -> None:
    """A gyro that begins to drift by 0.2 degrees a second turns a blind filter away, less so with a compass."""

    def error(config: AidingConfig) -> float:
        drive = Drive(gait(), field, config=config, blind_s=10.0)
        drive.drift = np.array([0.0, 0.0, np.radians(0.2)])
        estimate = geometry.heading(drive.finish(40.0).estimator.state.T_map_base.rotation)
        truth = geometry.heading(geometry.from_rotation_matrix(gait().attitude(40.0)))
        return abs(float(np.degrees(geometry.wrap(estimate - truth))))

    assert error(replace(ON, compass_sigma=0.03)) < 2.5 < 5.0 < error(OFF)


def test_one_stamp_far_ahead_does_not_silence_a_sensor() -> None:
    """An attitude that claims to be an hour late in time is dropped; those after it count as before."""

    def stamped(ride: Ride, t: float) -> Attitude:
        return replace(upright(ride, t), stamp_ns=stamp(t + 3600.0 if t == 2.0 else t))

    regular, ahead = (Drive(gait(), each).finish(6.0).status("attitude") for each in (upright, stamped))
    assert ahead.used == regular.used - 1
    assert sum(ahead.dropped.values()) == 1


def test_metal_moves_nothing() -> None:
    """A field that doubles for two seconds is rejected by the gate, and the heading stays."""

    def disturbed(ride: Ride, t: float) -> MagneticField:
        metal = np.array([6e-5, 0.0, 0.0]) if 10.0 <= t < 12.0 else np.zeros(3)
        return MagneticField(stamp(t), ride.attitude(t).T @ (NORTH + metal))

    drive = Drive(gait(), disturbed, blind_s=9.0).finish(14.0)
    assert drive.status("compass").rejected == 20
    truth = geometry.heading(geometry.from_rotation_matrix(gait().attitude(14.0)))
    assert geometry.heading(drive.estimator.state.T_map_base.rotation) == pytest.approx(truth, abs=0.1)


@pytest.mark.parametrize("up", [np.array([0.0, 0.0, 5e-5]), np.array([0.0, 0.0, -5e-5]), np.zeros(3)])
def test_a_field_without_a_direction_is_dropped(up: np.ndarray) -> None:
    """It points up or down, or there is none: such a field is named and changes no heading."""

    def vertical(ride: Ride, t: float) -> MagneticField:
        return MagneticField(stamp(t), ride.attitude(t).T @ up)

    drive = Drive(gait(), vertical, blind_s=9.0).finish(14.0)
    status = drive.status("compass")
    assert status.used == 0
    assert set(status.dropped) == {"magnetic field that points up or down"}


def test_a_beam_to_the_ground_holds_the_height_and_takes_a_step_for_a_step() -> None:
    """The height follows to 0.1 m; a floor that drops by half a metre leaves it there, and is used again."""

    def stepped(ride: Ride, t: float) -> GroundDistance:
        return beam(ride, t, -1.0 if t < 10.0 else -1.5)

    drive = Drive(gait(), stepped)
    times = (t for t in drive.run(20.0) if drive.estimator.ready)
    errors = [drive.estimator.state.T_map_base.translation[2] - gait().position(t)[2] for t in times]
    assert np.abs(errors).max() < 0.1
    assert 3 <= drive.status("ground").rejected < 10
    assert drive.status("ground").accepted


def test_an_attitude_of_somebody_else_levels_the_filter() -> None:
    """Its yaw does not matter; the filter's tilt comes within a degree and stays there."""
    drive = Drive(gait(), upright).finish(20.0)
    up = geometry.rotation_matrix(drive.estimator.state.T_map_base.rotation)[2]
    assert up @ gait().attitude(20.0)[2] > np.cos(np.radians(1.0))
    assert drive.status("attitude").used > 150


def test_rest_shows_the_biases_of_the_gyros_and_stops_the_drift() -> None:
    """Ten seconds of rest without a match: biases to 0.05 degrees a second, and no velocity worth the name."""
    bias = np.array([0.004, -0.003, 0.006, 0.0, 0.0, 0.0])
    drive = Drive(still(), blind_s=0.0).finish(10.0, bias)
    state = drive.estimator.state
    np.testing.assert_allclose(state.gyro_bias, bias[:3], atol=np.radians(0.05))
    assert np.abs(state.velocity).max() < 0.05
    assert {"standstill", "gravity", "zero rate"} <= {status.source for status in drive.estimator.aiding}


def test_a_smooth_drive_is_no_rest() -> None:
    """A base that glides at 1 m/s without a shake feels like rest; the matches tell otherwise."""

    def glide(t: float) -> np.ndarray:
        return np.array([max(0.0, t - 1.0) - 0.5 * (1.0 - np.exp(-2.0 * max(0.0, t - 1.0))), 0.0, 0.0])

    drive = Drive(Ride(glide, lambda t: np.eye(3))).finish(15.0)
    assert drive.estimator.state.velocity[0] == pytest.approx(1.0, abs=0.05)
    assert all(status.used_ns < stamp(4.0) for status in drive.estimator.aiding if status.source == "standstill")


def test_what_is_switched_off_is_not_used() -> None:
    """No source but the matches is heard."""
    drive = Drive(gait(), fix, speed, field, beam, upright, config=OFF).finish(8.0)
    assert [status.source for status in drive.estimator.aiding] == ["scan"]
    assert drive.aids.world is None
