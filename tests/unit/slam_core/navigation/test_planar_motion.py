"""The planar motion without an IMU: predicts, remembers attitudes, listens to wheels."""

import math

import numpy as np
import pytest

from slam_core import geometry
from slam_core.config import FusionConfig, MotionConfig
from slam_core.measurements import Attitude, Odometry
from slam_core.navigation.planar_motion import PlanarMotion
from slam_core.results import PlanarGaussian

CONFIG = MotionConfig()
TIGHT = np.diag([1e-6, 1e-6, 1e-6])


def arc(t, speed=1.0, rate=0.8):
    """Exact pose on a circle driven from the origin."""
    psi = rate * t
    return np.array([speed / rate * math.sin(psi), speed / rate * (1 - math.cos(psi)), geometry.wrap(psi)])


def driven(until=2.0, step=0.1):
    """A motion that has been told the arc every tenth of a second."""
    motion = PlanarMotion()
    for k in range(round(until / step) + 1):
        motion.prior(round(k * step * 1e9), CONFIG)
        motion.fuse(PlanarGaussian(arc(k * step), TIGHT), FusionConfig(omega=0.5))
    return motion


def test_a_steady_arc_is_predicted():
    """After two seconds on a circle the next tenth of a second is foreseen to a few millimetres."""
    predicted = driven().prior(2_100_000_000, CONFIG).mean
    np.testing.assert_allclose(predicted, arc(2.1), atol=0.005)


def jumped(step, seconds):
    """A steady drive at 0.5 m/s with a match every tenth of a second, and one that lies a step further left."""
    motion = PlanarMotion()
    for k in range(21):
        motion.prior(k * 100_000_000, CONFIG)
        motion.fuse(PlanarGaussian(np.array([0.05 * k, 0.0, 0.0]), TIGHT), FusionConfig(omega=0.5))
    motion.prior(2_000_000_000 + round(seconds * 1e9), CONFIG)
    motion.fuse(PlanarGaussian(np.array([1.0 + 0.5 * seconds, step, 0.0]), TIGHT), FusionConfig(omega=0.5))
    return motion


def test_a_jump_that_is_no_motion_corrects_the_pose_and_not_the_speed():
    """0.4 m within a tenth of a second is an error that a match ends: the drive goes on straight from there."""
    motion = jumped(0.4, 0.1)
    np.testing.assert_allclose(motion.twist[:2], [0.5, 0.0], atol=0.02)
    np.testing.assert_allclose(motion.prior(2_200_000_000, CONFIG).mean[:2], [1.1, 0.4], atol=0.01)


def test_a_step_that_may_be_a_motion_is_a_velocity():
    """0.1 m within a tenth of a second, or 0.4 m within two tenths: a robot that was pushed, maybe."""
    assert jumped(0.1, 0.1).twist[1] > 0.4
    assert jumped(0.4, 0.2).twist[1] > 0.8


def test_jumps_that_go_on_become_a_velocity():
    """A robot that is carried off sideways at 3 m/s is followed again within a second."""
    motion = jumped(0.3, 0.1)
    for k in range(1, 11):
        motion.prior(2_100_000_000 + k * 100_000_000, CONFIG)
        motion.fuse(PlanarGaussian(np.array([1.05, 0.3 + 0.3 * k, 0.0]), TIGHT), FusionConfig(omega=0.5))
    assert motion.twist[1] == pytest.approx(3.0, abs=0.3)


def test_wheels_are_believed_less_the_faster_they_turn():
    """They slip: a sharp turn by the wheels alone is taken over less than a slow one; without slip, as much."""

    def heard(rate, config):
        motion = PlanarMotion()
        motion.prior(0, config)
        motion.add_odometry(Odometry(0, np.zeros(2), rate), config)
        return (motion.prior(100_000_000, config).mean[2]) / (0.1 * rate)

    stiff = MotionConfig(odometry_slip=0.0)
    assert heard(0.2, CONFIG) > 0.98 > heard(4.0, CONFIG) + 0.2
    assert heard(4.0, stiff) == pytest.approx(heard(0.2, stiff))


def test_pose_within_a_sweep_follows_the_arc():
    """Between scans, forwards and a little backwards, the pose keeps to the motion: what deskewing needs."""
    motion = driven()
    for t in (1.95, 2.0, 2.05):
        np.testing.assert_allclose(geometry.planar(motion.pose(round(t * 1e9))), arc(t), atol=0.005)


def test_uncertainty_grows_with_time_and_shrinks_with_a_match():
    """The covariance is a covariance, larger the further ahead."""
    motion = driven()
    soon = motion.copy().prior(2_050_000_000, CONFIG).covariance
    late = motion.copy().prior(3_000_000_000, CONFIG).covariance
    assert np.linalg.eigvalsh(soon).min() > 0
    assert (np.diag(late) > np.diag(soon)).all()


def test_the_covariance_of_the_prediction_is_consistent():
    """Monte-Carlo arcs with white acceleration scatter as the filter says they do."""
    rng, motion = np.random.default_rng(0), driven()
    twist, cov = motion._mean[3:], motion._covariance
    dt, n, ends = 0.2, 20, []
    root = np.linalg.cholesky(cov)
    for _ in range(800):
        state = motion._mean + root @ rng.standard_normal(6)
        for _ in range(n):
            h = dt / n
            state[3:] += rng.standard_normal(3) * math.sqrt(h) * [1.0, 1.0, CONFIG.yaw_acceleration]
            state[:3] = geometry.compose(state[:3], np.array([state[3] * h, state[4] * h, state[5] * h]))
        ends.append(state[:3].copy())
    scatter = np.cov(np.array(ends).T)
    said = motion.prior(2_200_000_000, CONFIG).covariance
    np.testing.assert_allclose(np.diag(scatter), np.diag(said), rtol=0.25)
    assert abs(twist[0] - 1.0) < 0.05


def test_wheels_set_the_velocity():
    """Odometry alone moves the prediction."""
    motion = PlanarMotion()
    for k in range(20):
        motion.add_odometry(Odometry(k * 50_000_000, np.array([0.5, 0.0]), 0.2), CONFIG)
    assert motion.prior(2_000_000_000, CONFIG).mean == pytest.approx(arc(2.0, 0.5, 0.2), abs=0.05)


def test_roll_and_pitch_come_from_the_attitudes_around():
    """The attitude is interpolated; its heading is not used."""
    motion = driven()
    for t, roll in ((1_900_000_000, 0.1), (2_100_000_000, 0.3)):
        motion.add_attitude(Attitude(t, geometry.from_euler(roll, 0.0, 2.5)))
    pose = motion.pose(2_000_000_000)
    assert geometry.heading(pose.rotation) == pytest.approx(arc(2.0)[2], abs=0.01)
    tilt = geometry.split_heading(pose.rotation)[1]
    np.testing.assert_allclose(np.abs(geometry.to_euler(tilt)[0]), 0.2, atol=0.02)


def test_a_copy_is_independent():
    """Predicting with a copy leaves the original where it was."""
    motion = driven()
    motion.copy().prior(9_000_000_000, CONFIG)
    np.testing.assert_allclose(motion.prior(2_000_000_000, CONFIG).mean, arc(2.0), atol=1e-3)


def test_a_clock_set_by_an_hour_moves_nothing():
    """Forwards or backwards the robot is near where it was, unsure by metres, and is followed again."""
    for hour in (3600, -3600):
        motion = driven(1.0)
        before = motion.prior(10**9, CONFIG)
        after = motion.prior((1 + hour) * 10**9, CONFIG)
        assert np.linalg.norm((after.mean - before.mean)[:2]) < 2.1
        assert 0.1 < math.sqrt(after.covariance[0, 0]) < 10.0
        later = motion.prior((1 + hour) * 10**9 + 10**8, CONFIG)
        assert motion.stamp_ns == (1 + hour) * 10**9 + 10**8 and np.isfinite(later.mean).all()


def test_a_gyro_corrects_the_yaw_rate():
    """A robot at rest that begins to turn is turned; a rate that is none is not taken."""
    motion = PlanarMotion()
    motion.prior(0, CONFIG)
    for k in range(1, 51):
        motion.add_yaw_rate(k * 10**7, 0.5, CONFIG)
        motion.add_yaw_rate(k * 10**7, math.nan, CONFIG)
    assert motion.prior(5 * 10**8, CONFIG).mean[2] == pytest.approx(0.25, abs=0.02)


def test_wheels_that_grip_give_no_velocity_to_the_left():
    """A push sideways, as matches may feign it, is taken out of the velocity."""
    motion = PlanarMotion()
    for k in range(20):
        motion.prior(k * 10**8, CONFIG)
        motion.fuse(PlanarGaussian(np.array([0.0, 0.1 * k, 0.0]), TIGHT), FusionConfig(omega=0.5))
    left = motion.prior(20 * 10**8, CONFIG).mean[1]
    motion.constrain_sideways()
    assert left > 1.9 and motion.prior(25 * 10**8, CONFIG).mean[1] - left < 0.1


@pytest.mark.parametrize("rate", [10, 40])
def test_a_mean_speed_is_kept_along_its_direction(rate: int) -> None:
    """Along the map's y axis 0.2 m/s, whatever matches say; its way is known to 0.3 m after four seconds."""
    motion, y = driven(), np.array([0.0, 1.0])
    start = motion.planar.mean
    for k in range(1, 4 * rate + 1):
        motion.prior(2_000_000_000 + round(k / rate * 1e9), CONFIG)
        motion.keep_speed(y, 0.2)
        still = PlanarGaussian(np.array([*start[:2] - y, start[2]]), TIGHT)
        motion.fuse(still, FusionConfig(omega=0.5), y)
    pose = motion.planar
    np.testing.assert_allclose(pose.mean, start + np.array([0.0, 0.8, 0.0]), atol=0.1)
    assert np.sqrt(pose.covariance[1, 1]) == pytest.approx(0.28, abs=0.03)
