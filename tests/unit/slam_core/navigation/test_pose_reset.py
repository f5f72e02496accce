"""A belief that is set down somewhere else."""

import numpy as np
import pytest

from slam_core import geometry
from slam_core.config import NavigationConfig
from slam_core.navigation.filter import NavigationFilter
from slam_core.navigation.pose_reset import Origin
from slam_core.results import NavigationState, PlanarGaussian
from tests.motions import START_NS, gait, stamp

XI, R = np.array([12.0, -7.0, 2.5]), np.array([[4e-4, 1e-4, 0.0], [1e-4, 9e-4, 2e-5], [0.0, 2e-5, 1e-4]])

HERE = stamp(3.905)  # between two matches
START = PlanarGaussian(np.zeros(3), 1e-6 * np.eye(3))


def driven(seconds: float) -> NavigationFilter:
    """A filter after a walk that was matched all the way."""
    ride, nav = gait(), NavigationFilter(NavigationConfig())
    for k, imu in enumerate(ride.samples(seconds)):
        nav.predict(imu)
        if nav.ready and k % 10 == 0:
            t = (imu.stamp_ns - START_NS) * 1e-9
            xi = np.array(
                [*ride.position(t)[:2], geometry.heading(geometry.from_rotation_matrix(ride.attitude(t)))]
            )
            nav.fuse_planar(imu.stamp_ns, xi, 1e-4 * np.eye(3), 0.5)
    return nav


def test_the_base_is_where_it_was_put():
    """Place, heading and their covariance are the given ones, whatever was believed."""
    nav = driven(4.0)
    nav.reset_pose(HERE, PlanarGaussian(XI, R))
    planar = nav.planar(HERE)
    np.testing.assert_allclose(planar.mean, XI, atol=1e-12)
    np.testing.assert_allclose(planar.covariance, R, atol=1e-12)


def test_what_the_place_does_not_change_stays():
    """Roll, pitch, height, the velocity in the base's axes, the biases and how sure all these are."""
    nav = driven(4.0)
    before = nav.at(HERE)
    nav.reset_pose(HERE, PlanarGaussian(XI, R))
    after = nav.at(HERE)
    np.testing.assert_allclose(
        geometry.to_euler(after.T_map_base.rotation)[:2],
        geometry.to_euler(before.T_map_base.rotation)[:2],
        atol=1e-9,
    )
    assert after.T_map_base.translation[2] == before.T_map_base.translation[2]
    for state in (before, after):
        assert np.linalg.norm(state.velocity) > 0.1
    bodies = [geometry.rotation_matrix(s.T_map_base.rotation).T @ s.velocity for s in (before, after)]
    np.testing.assert_allclose(*bodies, atol=1e-9)
    np.testing.assert_array_equal(before.gyro_bias, after.gyro_bias)
    np.testing.assert_allclose(before.covariance[9:, 9:], after.covariance[9:, 9:], rtol=1e-9)
    np.testing.assert_allclose(
        np.trace(before.covariance[6:9, 6:9]), np.trace(after.covariance[6:9, 6:9]), rtol=1e-9
    )
    assert np.linalg.eigvalsh(after.covariance).min() > 0


def test_the_way_on_is_the_same_but_for_the_frame():
    """Some hundredths of a second later the base has come as far, in its own axes, as without the placement."""
    ways = []
    for put in (False, True):
        nav = driven(4.0)
        if put:
            nav.reset_pose(HERE, PlanarGaussian(XI, R))
        a, b = (nav.planar(time_ns).mean for time_ns in (HERE, stamp(3.99)))
        ways.append(geometry.compose(geometry.inverse(a), b))
    np.testing.assert_allclose(ways[0], ways[1], atol=2e-4)
    assert np.hypot(*ways[0][:2]) > 0.02


def test_a_place_that_is_none_is_refused():
    """Not finite, or with a noise that is no covariance: counted, and the belief stays."""
    nav = driven(2.0)
    before = nav.planar(stamp(1.9)).mean
    nav.reset_pose(stamp(1.9), PlanarGaussian(np.array([np.nan, 0.0, 0.0]), R))
    nav.reset_pose(stamp(1.9), PlanarGaussian(XI, -R))
    np.testing.assert_array_equal(nav.planar(stamp(1.9)).mean, before)
    assert nav.counts["correction without a usable value"] == 2


@pytest.mark.parametrize("has_velocity", [True, False])
def test_the_origin_of_a_map_is_where_the_base_is(has_velocity: bool) -> None:
    """Its pose and height are 0; the velocity turns with it, or is unknown; without biases the tilt stays."""
    nav = driven(4.0)
    estimate = nav.at(HERE)
    before = estimate._replace(x=np.concatenate([estimate.x[:13], np.zeros(3), estimate.x[16:]]))
    origin = Origin(pose=START, has_velocity=has_velocity, accel_bias_sigma=0.1)
    after = NavigationState(HERE, *origin.update(before.x, before.covariance)[:2])
    assert np.allclose(geometry.planar(after.T_map_base), 0.0, atol=1e-12)
    assert after.T_map_base.translation[2] == 0.0
    tilts = [geometry.split_heading(state.T_map_base.rotation)[1] for state in (before, after)]
    assert np.allclose(*tilts, atol=1e-12)
    speeds = [np.linalg.norm(state.velocity) for state in (before, after)]
    assert speeds[1] == pytest.approx(speeds[0] if has_velocity else 0.0)
    assert np.linalg.eigvalsh(after.covariance).min() > 0.0
    sigmas = [np.sqrt(np.trace(state.covariance[6:8, 6:8])) for state in (before, after)]
    assert 1.0 < sigmas[1] / sigmas[0] <= 3.0 if has_velocity else after.covariance[6, 6] == 1.0
    nav.correct(HERE, origin)
    assert np.allclose(nav.planar(HERE).mean, 0.0, atol=1e-12)


def test_at_the_origin_the_tilt_explains_what_a_bias_did() -> None:
    """A bias that nothing has shown goes, the tilt turns by bias / g, and neither is sure any more."""
    sigma, slope = 0.1, 1.0 / 9.81  # rad of tilt, by which a bias along x is confused with a turn about y
    x, P = np.zeros(19), 1e-4 * np.eye(15)
    x[0], x[13] = 1.0, 1.0
    P[12, 12], P[1, 1] = 0.5, 0.5 * slope**2 + 1e-8
    P[12, 1] = P[1, 12] = 0.5 * slope
    update = Origin(pose=START, has_velocity=True, accel_bias_sigma=sigma).update(x, P)
    assert abs(update.x[13]) < 0.01
    tilt = 2.0 * np.arcsin(update.x[2])
    assert tilt == pytest.approx(-slope, rel=0.02)
    assert np.sqrt(update.P[12, 12]) == pytest.approx(sigma, rel=0.01)
    assert update.P[0, 0] == pytest.approx(9e-4)
