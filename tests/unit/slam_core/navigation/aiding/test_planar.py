"""Satellites and compass without an IMU: the same corrections, gates and counters, in the plane."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from slam_core import geometry
from slam_core.config import MotionConfig
from slam_core.measurements import Float64s
from slam_core.navigation.aiding.planar import PlanarEstimator, _lifted, _lowered
from slam_core.navigation.aiding.sensors import MagneticHeading, Place, Velocity
from slam_core.navigation.planar_motion import PlanarMotion
from slam_core.results import PlanarGaussian

S = 1_000_000_000
CONFIG = MotionConfig()
SURE = PlanarGaussian(np.zeros(3), np.diag([1e-4, 1e-4, 1e-4]))


def standing(psi: float = 0.0) -> tuple[PlanarMotion, PlanarEstimator]:
    """At the origin at 10 s, heading somewhere, sure to a centimetre."""
    motion = PlanarMotion()
    motion.reset_pose(10 * S, PlanarGaussian(np.array([0.0, 0.0, psi]), SURE.covariance), CONFIG)
    estimator = PlanarEstimator(motion)
    estimator.configure(CONFIG, 5.0)
    return motion, estimator


def place(x: float, y: float, sigma: float = 0.5, antenna: Float64s | None = None) -> Place:
    arm = np.zeros(3) if antenna is None else antenna
    return Place(np.array([x, y, 30.0]), sigma**2 * np.eye(3), arm, 1.0, 5.0)


@given(st.lists(st.floats(-3.0, 3.0), min_size=6, max_size=6), st.integers(0, 10**6))
def test_a_belief_comes_back_as_it_went(mean: list[float], seed: int) -> None:
    """Written as a state of the filter and read back, mean and covariance are the same."""
    root = np.random.default_rng(seed).normal(size=(6, 6))
    covariance = root @ root.T + 0.01 * np.eye(6)
    x, P = _lifted(np.array(mean), covariance, geometry.yaw_quaternion(mean[2]))
    step, again = _lowered(np.array(mean), x, P)
    np.testing.assert_allclose(step, 0.0, atol=1e-12)
    np.testing.assert_allclose(again, covariance, rtol=1e-9, atol=1e-9)
    assert np.linalg.eigvalsh(P)[0] > 0.0


def test_satellites_hold_the_place_and_teach_the_speed() -> None:
    """A base that drives 2 m/s along the map's y axis, seen by fixes alone for ten seconds."""
    motion, estimator = standing(math.pi / 2)
    for k in range(1, 51):
        t = 0.2 * k
        assert estimator.correct(10 * S + round(t * S), place(0.0, 2.0 * t))
    belief = motion.prior(20 * S, CONFIG)
    np.testing.assert_allclose(belief.mean[:2], [0.0, 20.0], atol=0.3)
    np.testing.assert_allclose(motion.motion_at([20 * S])[0, 7:9], [0.0, 2.0], atol=0.2)
    (status,) = estimator.aiding
    assert (status.source, status.used, status.rejected) == ("gps", 50, 0)


def test_a_velocity_is_that_of_the_map() -> None:
    """A base that faces the map's y axis and moves along x moves to its right."""
    motion, estimator = standing(math.pi / 2)
    assert estimator.correct(10 * S, Velocity(np.array([1.0, 0.0, 0.0]), 0.01 * np.eye(3), 1.0, 0.0))
    np.testing.assert_allclose(motion.twist[:2], [0.0, -1.0], atol=0.05)


def test_a_compass_turns_the_base_and_a_late_fix_counts_at_its_own_time() -> None:
    """A heading told 0.1 rad further; a fix half a second old of a base at 2 m/s is no contradiction."""
    motion, estimator = standing()
    motion.prior(14 * S, CONFIG)  # long enough to be unsure
    field = geometry.rotate(geometry.yaw_quaternion(-0.1), np.array([2e-5, 0.0, -4e-5]))
    assert estimator.correct(14 * S, MagneticHeading(field, 0.0, 1e-4, 1.0, 0.0))
    assert abs(motion.prior(14 * S, CONFIG).mean[2] - 0.1) < 0.01
    motion, estimator = standing()
    estimator.correct(10 * S, Velocity(np.array([2.0, 0.0, 0.0]), 1e-6 * np.eye(3), 1.0, 0.0))
    motion.prior(round(10.5 * S), CONFIG)
    estimator.correct(10 * S, place(0.0, 0.0, 0.01))
    np.testing.assert_allclose(motion.prior(round(10.5 * S), CONFIG).mean[:2], [1.0, 0.0], atol=0.01)


def test_a_fix_that_jumps_is_kept_out_while_matches_vouch() -> None:
    """50 m for ten seconds beside matches: every one rejected. Without matches it is believed in the end."""
    for matched in (True, False):
        motion, estimator = standing()
        for k in range(1, 51):
            now_ns = 10 * S + k * S // 5
            if matched:
                motion.reset_pose(now_ns, SURE, CONFIG)
                estimator.matched(now_ns)
            estimator.correct(now_ns, place(50.0, 0.0))
        gps = next(status for status in estimator.aiding if status.source == "gps")
        x = motion.prior(20 * S, CONFIG).mean[0]
        assert (gps.used == 0 and abs(x) < 0.01) if matched else (gps.returns == 1 and abs(x - 50.0) < 1.0)


def test_what_cannot_be_used_is_counted() -> None:
    """Older than a second, far in the future, or without a share of news: each by its reason; nothing moves."""
    motion, estimator = standing()
    assert not estimator.correct(8 * S, place(1.0, 0.0))
    assert not estimator.correct(100 * S, place(1.0, 0.0))
    assert not estimator.correct(10 * S, Place(np.zeros(3), np.eye(3), np.zeros(3), 0.0, 5.0))
    assert sum(estimator.counts.values()) == 3 and len(estimator.counts) == 3
    np.testing.assert_array_equal(motion.prior(10 * S, CONFIG).mean, np.zeros(3))
