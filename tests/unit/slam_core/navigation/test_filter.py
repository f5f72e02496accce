"""What the filter is for: attitude, height and plane of a ride, bounded, on any platform."""

from copy import deepcopy
from dataclasses import replace

import numpy as np
import pytest

from slam_core import geometry
from slam_core.config import FusionMethod, NavigationConfig, PlatformConfig
from slam_core.measurements import Imu
from slam_core.navigation.filter import NavigationFilter
from tests.filters import CONFIG, OMEGA, R, begun, run, tilt_error, xi
from tests.motions import GRAVITY, Ride, euler_matrix, gait, grown, stamp, still, tumble


@pytest.mark.parametrize("seed", range(3))
def test_attitude_and_height_follow_a_walk(seed: int) -> None:
    """With biased, noisy sensors tilt stays within 1.0 deg rms, height within 0.15 m and the plane within 2 cm."""
    ride = gait()
    bias = np.random.default_rng(seed).uniform(-1, 1, 6) * np.repeat([0.009, 0.05], 3)
    tilts, heights, plane = [], [], []
    for t, state in run(ride, 12.0, seed=seed, bias=bias):
        tilts.append(tilt_error(state, ride, t))
        offset = state.T_map_base.translation - ride.position(t)
        heights.append(offset[2])
        plane.append(np.hypot(*offset[:2]))
    assert np.sqrt(np.mean(np.square(tilts))) < 1.0
    assert np.sqrt(np.mean(np.square(heights))) < 0.15
    assert np.sqrt(np.mean(np.square(plane))) < 0.02


def test_it_does_not_break_at_ninety_degrees_of_pitch() -> None:
    """Through 90 degrees and back attitude, position and heading stay accurate and continuous, P a covariance."""
    ride, last = tumble(), None
    steepest = 0.0
    for t, state in run(ride, 12.0, noise=0.2):
        found, true = state.T_map_base, geometry.from_rotation_matrix(ride.attitude(t))
        error = geometry.multiply(found.rotation, geometry.conjugate(true))
        assert np.degrees(np.linalg.norm(geometry.to_rotation_vector(error))) < 2.0
        assert np.linalg.norm(found.translation[:2] - ride.position(t)[:2]) < 0.05
        assert (state.covariance == state.covariance.T).all() and np.linalg.eigvalsh(state.covariance)[0] > 0.0
        if last is not None:
            assert abs(geometry.wrap(geometry.heading(found.rotation) - last)) < np.radians(3.0)
        last = geometry.heading(found.rotation)
        steepest = max(steepest, np.degrees(np.arccos(ride.attitude(t)[2, 2])))
    assert steepest > 120.0


def test_nothing_grows_without_end_when_only_matches_come() -> None:
    """What a match says nothing about, as height and biases, stays bounded through a minute of matches."""
    estimator = begun()
    for k in range(1, 6000):
        t = 1.0 + k / 100
        estimator.predict(Imu(stamp(t), np.zeros(3), -GRAVITY))
        if k % 5 < 2:
            estimator.fuse_planar(stamp(t - 0.005), np.zeros(3), R, 0.5)
    sigma = np.sqrt(np.diag(estimator.state.covariance))
    assert (sigma[:2] < 0.3).all() and sigma[5] < 3.0 and (sigma[6:9] < 5.0).all()
    assert (sigma[9:12] < 2 * CONFIG.gyro_bias_sigma).all() and (sigma[12:] < 2 * CONFIG.accel_bias_sigma).all()
    assert abs(estimator.state.T_map_base.translation[2]) < 1.0


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_base_that_shakes_keeps_its_height_without_a_source(seed: int) -> None:
    """Vertical accelerations that the configured noise does not cover do not carry it off."""
    rng, estimator, shake, heights = np.random.default_rng(seed), NavigationFilter(CONFIG), 0.0, []
    for k, sample in enumerate(still().samples(60.0, noise=1.0, seed=seed)):
        shake += -0.01 * shake + 0.1 * rng.normal() if k > 200 else 0.0  # 0.7 m/s^2, for about a second each
        force = sample.linear_acceleration + np.array([0.0, 0.0, shake])
        estimator.predict(replace(sample, linear_acceleration=force))
        if estimator.ready and k % 5 == 0:
            estimator.fuse_planar(sample.stamp_ns, np.zeros(3), R, OMEGA)
            heights.append(estimator.state.T_map_base.translation[2])
    assert np.abs(heights).max() < 1.5


def test_without_any_aid_velocity_and_tilt_stay_bounded() -> None:
    """Pseudo measurements alone keep a biased filter level and slow for a minute."""
    estimator = NavigationFilter(NavigationConfig(zero_velocity_threshold=2.0))
    ride = still()
    for sample in ride.samples(60.0, noise=1.0, bias=np.array([0.005, -0.005, 0.0, 0.03, -0.03, 0.03])):
        estimator.predict(sample)
    state = estimator.state
    assert tilt_error(state, ride, 60.0) < 1.0
    assert np.linalg.norm(state.velocity) < 5.0
    assert (np.sqrt(np.diag(state.covariance))[6:9] < 3.0).all()


def test_settings_change_from_the_next_measurement_on() -> None:
    """A lower bound on height noise makes the next height count for more."""
    estimator = begun()
    other = deepcopy(estimator)
    other.configure(replace(CONFIG, height_sigma=0.001))
    for each in (estimator, other):
        each.update_height(stamp(1.0), 0.05)
    heights = [each.state.T_map_base.translation[2] for each in (estimator, other)]
    assert heights[1] > 2 * heights[0] > 0.0


@pytest.mark.parametrize("method", ["fixed", "trace", "determinant", "kalman"])
def test_every_method_of_fusion_follows_a_walk(method: FusionMethod) -> None:
    """Matches fused by each of them keep the plane within 5 cm, and P is a covariance."""
    ride, estimator, off = gait(), NavigationFilter(CONFIG), []
    for k, sample in enumerate(ride.samples(6.0, noise=1.0)):
        estimator.predict(sample)
        if estimator.ready and k % 3 == 0:
            state = estimator.fuse_planar(sample.stamp_ns, xi(ride, k / 100), R, OMEGA, method)
            off.append(np.linalg.norm((state.T_map_base.translation - ride.position(k / 100))[:2]))
            assert np.linalg.eigvalsh(state.covariance)[0] > 0.0
    assert max(off) < 0.05


def test_a_planar_platform_has_no_roll_pitch_and_height() -> None:
    """They are zero and certain, whatever the samples say, and the plane is followed as ever."""
    ride = Ride(lambda t: np.array([0.5 * grown(t), 0.0, 0.0]), lambda t: euler_matrix(0.0, 0.0, grown(t)))
    estimator = NavigationFilter(CONFIG, PlatformConfig(planar=True))
    for k, sample in enumerate(ride.samples(5.0, noise=1.0, bias=np.repeat([0.005, 0.1], 3))):
        estimator.predict(sample)
        if estimator.ready and k % 3 == 0:
            estimator.fuse_planar(sample.stamp_ns, xi(ride, k / 100), R, OMEGA)
            estimator.update_height(sample.stamp_ns, 0.4)
    state = estimator.state
    assert np.abs(geometry.to_euler(state.T_map_base.rotation)[:2]).max() < 1e-9
    assert state.T_map_base.translation[2] == pytest.approx(0.0, abs=1e-6)
    assert (np.diag(state.covariance)[[0, 1, 5, 8]] < 1e-9).all()
    assert np.allclose(geometry.planar(state.T_map_base), [0.5, 0.0, 1.0], atol=0.03)


def test_wheels_that_do_not_slip_take_the_sideways_velocity_out() -> None:
    """Of an acceleration that is felt to the left nothing comes, forward all of it."""
    moved = {}
    for no_slip in (False, True):
        estimator = begun(1.0, config=replace(CONFIG, tilt_threshold=1.0))
        estimator.configure(replace(CONFIG, tilt_threshold=1.0), PlatformConfig(no_slip=no_slip))
        for k in range(101, 151):
            estimator.predict(Imu(stamp(k / 100), np.zeros(3), np.array([1.0, 1.0, 0.0]) - GRAVITY))
        moved[no_slip] = estimator.state.velocity
    assert moved[False][0] > 0.3 and moved[False][1] > 0.3
    assert moved[True][0] > 0.3 and abs(moved[True][1]) < 0.1
