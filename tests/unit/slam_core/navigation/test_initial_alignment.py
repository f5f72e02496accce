"""How the filter begins: level, at rest, and at the pose of somebody else."""

import numpy as np
import pytest

from slam_core import geometry
from slam_core.config import NavigationConfig
from slam_core.measurements import Imu
from slam_core.navigation.filter import NavigationFilter
from slam_core.results import PlanarGaussian
from tests.filters import CONFIG, begun, tilt_error
from tests.motions import GRAVITY, Ride, euler_matrix, grown, stamp, still


def test_it_is_ready_after_the_leveling_time() -> None:
    """Before it there is no belief and corrections are counted; after it the attitude is known."""
    estimator = begun(0.49)
    assert not estimator.ready and not estimator.update_height(stamp(0.4), 1.0)
    assert estimator.counts["correction before the attitude was known"] == 1
    with pytest.raises(RuntimeError, match="no attitude yet"):
        estimator.at(stamp(0.4))
    assert begun(0.5).ready


@pytest.mark.parametrize(("roll", "pitch"), [(0.0, 0.0), (0.4, -0.3), (0.0, 1.57), (3.1, 0.0), (np.pi, 0.0)])
def test_it_finds_its_tilt_in_any_attitude(roll: float, pitch: float) -> None:
    """A base at rest knows where down is, heads along its own x, and has not moved."""
    ride = Ride(lambda t: np.zeros(3), lambda t: euler_matrix(roll, pitch, 0.0))
    state = begun(0.6, ride).state
    assert tilt_error(state, ride, 0.0) < 1e-3
    assert np.allclose(state.T_map_base.translation, 0.0, atol=1e-6)
    if abs(roll) < 3.0:
        assert abs(geometry.heading(state.T_map_base.rotation)) < 1e-9


def test_a_base_at_rest_shows_its_gyro_biases() -> None:
    """They are the mean rate while nothing moves, and a base that moves does not take its rate for a bias."""
    bias = np.array([0.01, -0.02, 0.015, 0.0, 0.0, 0.0])
    estimator = NavigationFilter(CONFIG)
    for sample in still().samples(0.6, noise=1.0, bias=bias):
        estimator.predict(sample)
    assert np.allclose(estimator.state.gyro_bias, bias[:3], atol=0.003)
    turning = Ride(lambda t: np.zeros(3), lambda t: euler_matrix(0.0, 0.0, 0.5 * t))
    assert np.allclose(begun(0.6, turning).state.gyro_bias, 0.0)


def test_it_does_not_begin_without_gravity() -> None:
    """Accelerometers that say nothing are counted, and a gap starts the leveling again."""
    estimator = NavigationFilter(CONFIG)
    for k in range(100):
        estimator.predict(Imu(stamp(k / 100), np.zeros(3), np.zeros(3)))
    assert not estimator.ready and estimator.counts["start without gravity in the accelerometers"] == 1
    estimator = NavigationFilter(CONFIG)
    for t in (0.0, 0.3, 0.4, 0.5, 0.6, 0.7):
        estimator.predict(Imu(stamp(t), np.zeros(3), -GRAVITY))
    assert not estimator.ready


def test_it_takes_over_at_the_pose_of_somebody_else() -> None:
    """Placed, it stands there, turned with its velocity, and is as unsure of the plane as that pose."""
    ride = Ride(lambda t: np.array([grown(t), 0.0, 0.0]), lambda t: euler_matrix(0.1 * grown(t), 0.0, 0.0))
    estimator = begun(2.0, ride)
    before = estimator.state
    estimator.begin_at(PlanarGaussian(np.array([3.0, -2.0, np.pi / 2]), 0.04 * np.eye(3)))
    after = estimator.state
    assert np.allclose(geometry.planar(after.T_map_base), [3.0, -2.0, np.pi / 2])
    assert np.allclose(after.velocity, [-before.velocity[1], before.velocity[0], before.velocity[2]])
    assert after.T_map_base.translation[2] == before.T_map_base.translation[2]
    assert after.covariance[3, 3] == pytest.approx(0.04)


def test_a_base_that_turns_about_its_axes_finds_its_tilt() -> None:
    """The forces are laid on each other by the gyros: their mean in body axes shows no direction."""
    ride = Ride(lambda t: np.zeros(3), lambda t: euler_matrix(0.4 * np.sin(9.0 * t), 0.3 * np.cos(7.0 * t), t))
    at_once = NavigationConfig(start_in_motion=False)
    assert tilt_error(begun(0.5, ride).state, ride, 0.5) < 0.1
    assert tilt_error(begun(0.5, ride, at_once).state, ride, 0.5) > 1.0


def test_a_base_that_was_seen_to_move_has_an_unknown_velocity() -> None:
    """Inertial data at rest and at a constant velocity are alike."""
    for moves, sigma in ((False, 0.05), (True, 1.0)):
        estimator = NavigationFilter(CONFIG)
        estimator.moves = moves
        for sample in still().samples(0.5):
            estimator.predict(sample)
        assert estimator.begins_in_motion is moves
        assert np.sqrt(estimator.state.covariance[6, 6]) == pytest.approx(sigma, rel=0.1)
