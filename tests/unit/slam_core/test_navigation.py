from dataclasses import replace

import numpy as np
import pytest

from slam_core import geometry
from slam_core.aiding import BodyVelocity
from slam_core.config import FusionMethod, NavigationConfig, PlatformConfig
from slam_core.kernels.navigation import ERRORS, inject
from slam_core.measurements import Imu, Transform
from slam_core.navigation import NavigationFilter
from slam_core.results import NavigationState, PlanarGaussian
from tests.motions import GRAVITY, Ride, euler_matrix, gait, grown, stamp, still, tumble

CONFIG = NavigationConfig()
R = np.diag([0.005, 0.005, np.radians(0.1)]) ** 2
OMEGA = 0.02


def xi(ride: Ride, t: float) -> np.ndarray:
    """The planar pose of the truth."""
    return geometry.planar(Transform(ride.position(t), geometry.from_rotation_matrix(ride.attitude(t))))


def begun(seconds: float = 1.0, ride: Ride | None = None, config: NavigationConfig = CONFIG) -> NavigationFilter:
    """A filter after the first seconds of a ride, without noise."""
    estimator = NavigationFilter(config)
    for sample in (ride or still()).samples(seconds):
        estimator.predict(sample)
    return estimator


def run(ride: Ride, seconds: float, noise: float = 1.0, seed: int = 0, bias: np.ndarray | None = None):
    """Inertial data, matches at 40 Hz and heights at 10 Hz; yields (time, state, ride) after each match."""
    estimator, rng, t = NavigationFilter(CONFIG), np.random.default_rng([seed, 1]), 0.0
    for k, sample in enumerate(ride.samples(seconds, noise=noise, bias=bias, seed=seed)):
        estimator.predict(sample)
        if k % 10 == 0:
            estimator.update_height(sample.stamp_ns, ride.position(k / 100)[2] + 0.15 * noise * rng.normal())
        while t + 0.015 <= k / 100:
            error = noise * np.array([0.01, 0.01, np.radians(0.1)]) * rng.normal(size=3)
            if estimator.ready:
                yield t, estimator.fuse_planar(stamp(t), xi(ride, t) + error, R, OMEGA)[1]
            t += 0.025


def same(a: NavigationState, b: NavigationState, tolerance: float = 1e-9) -> bool:
    """Whether two beliefs agree in every number."""
    return a.stamp_ns == b.stamp_ns and all(
        np.allclose(p, q, rtol=0.0, atol=tolerance)
        for p, q in [
            (a.T_map_base.rotation, b.T_map_base.rotation),
            (a.T_map_base.translation, b.T_map_base.translation),
            (a.velocity, b.velocity),
            (a.gyro_bias, b.gyro_bias),
            (a.accel_bias, b.accel_bias),
            (a.covariance, b.covariance),
        ]
    )


def tilt_error(state: NavigationState, ride: Ride, t: float) -> float:
    """Angle in degrees between the vertical of the belief and that of the truth."""
    up = geometry.rotation_matrix(state.T_map_base.rotation)[2]
    return float(np.degrees(np.arccos(np.clip(up @ ride.attitude(t)[2], -1.0, 1.0))))


# How it begins


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


# What it is for


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


# Corrections


def test_a_match_pulls_the_plane_and_leaves_the_height() -> None:
    """The belief after lies between the one before, which has not seen the match, and the match."""
    estimator = begun()
    wanted = np.array([0.02, -0.01, 0.001])
    before, after = estimator.fuse_planar(stamp(1.0), wanted, R, 0.3)
    moved = geometry.planar(after.T_map_base) / wanted
    assert np.allclose(geometry.planar(before.T_map_base), 0.0, atol=1e-6)
    assert (moved > 0.0).all() and (moved < 1.0).all()
    assert np.isclose(after.T_map_base.translation[2], before.T_map_base.translation[2], atol=1e-3)
    assert np.array_equal(estimator.at(stamp(1.0)).covariance, after.covariance)


def test_planar_is_the_projection_of_the_belief() -> None:
    """C x and C P C^T: with the derivative of heading by finite differences."""
    ride = tumble()
    estimator = begun(3.5, ride)
    state, plane = estimator.at(stamp(3.4)), estimator.planar(stamp(3.4))
    q = state.T_map_base.rotation
    C = np.zeros((3, 15))
    C[0, 3] = C[1, 4] = 1.0
    for i, axis in enumerate(np.eye(3)):
        ahead, behind = (geometry.multiply(geometry.from_rotation_vector(h * axis), q) for h in (1e-6, -1e-6))
        C[2, i] = (geometry.heading(ahead) - geometry.heading(behind)) / 2e-6
    assert np.allclose(plane.mean, geometry.planar(state.T_map_base))
    assert np.allclose(plane.covariance, C @ state.covariance @ C.T, rtol=1e-4, atol=1e-12)


def test_a_match_across_half_a_turn_is_near() -> None:
    """A heading of -179 degrees corrects one of 179 by two degrees, not by 358."""
    ride = Ride(lambda t: np.zeros(3), lambda t: euler_matrix(0.0, 0.0, np.radians(179.0) * grown(t)))
    estimator = begun(3.5, ride)
    start = estimator.planar(stamp(3.0)).mean
    assert abs(start[2] - np.radians(179.0)) < np.radians(0.5)
    _, after = estimator.fuse_planar(stamp(3.0), np.array([0.0, 0.0, np.radians(-179.0)]), 1e-6 * np.eye(3), 0.9)
    assert abs(geometry.wrap(geometry.planar(after.T_map_base)[2] - start[2])) < np.radians(3.0)


def test_wheels_correct_the_velocity_in_the_axes_of_the_base() -> None:
    """A base that heads to the left and drives forward moves along the map's y axis."""
    ride = Ride(lambda t: np.zeros(3), lambda t: euler_matrix(0.0, 0.0, np.pi / 2 * grown(t)))
    estimator = begun(3.5, ride)
    for _ in range(20):
        assert estimator.update_velocity_body(stamp(3.5), np.array([1.0, 0.0]), 0.01)
    assert np.allclose(estimator.state.velocity, [0.0, 1.0, 0.0], atol=0.03)


def test_a_body_velocity_is_linearised_rightly() -> None:
    """A tiny correction moves the state along the gain that finite differences of R^T v predict."""
    rng = np.random.default_rng(3)
    x = rng.normal(size=19)
    x[:4] /= np.linalg.norm(x[:4])
    root = rng.normal(size=(ERRORS, ERRORS)) * 0.1
    P = root @ root.T + 1e-3 * np.eye(ERRORS)

    def measured(y: np.ndarray) -> np.ndarray:
        return geometry.rotation_matrix(y[:4]).T @ y[7:10]

    C = np.array(
        [(measured(inject(x, 1e-6 * e)) - measured(inject(x, -1e-6 * e))) / 2e-6 for e in np.eye(ERRORS)]
    ).T
    step = 1e-5 * np.ones(3)
    expected = P @ C.T @ np.linalg.inv(C @ P @ C.T + 0.01 * np.eye(3)) @ step
    better = BodyVelocity(measured(x) + step, 0.1).update(x, P).x
    assert np.allclose(better[4:16] - x[4:16], expected[3:], atol=1e-9)


# Time


def late_and_in_time(delay: float) -> tuple[NavigationState, NavigationState]:
    """The same ride with each match fused at once, and each `delay` seconds later."""
    ride, finals = gait(), []
    for wait in (0.0, delay):
        estimator, pending = NavigationFilter(CONFIG), []
        for k, sample in enumerate(ride.samples(4.0, noise=1.0)):
            estimator.predict(sample)
            if estimator.ready and k % 4 == 0:
                pending.append(k / 100)
            while pending and pending[0] + wait <= k / 100 + 1e-9:
                t = pending.pop(0)
                estimator.fuse_planar(stamp(t), xi(ride, t), R, OMEGA)
                estimator.update_height(stamp(t), ride.position(t)[2])
        for t in pending:
            estimator.fuse_planar(stamp(t), xi(ride, t), R, OMEGA)
            estimator.update_height(stamp(t), ride.position(t)[2])
        finals.append(estimator.state)
    return finals[0], finals[1]


@pytest.mark.parametrize("delay", [0.01, 0.05, 0.5])
def test_a_late_match_does_what_it_would_have_done_in_time(delay: float) -> None:
    """The final belief is the same to 1e-9 whether matches come at once or late."""
    in_time, late = late_and_in_time(delay)
    assert same(in_time, late)


def test_the_order_of_arrival_does_not_matter() -> None:
    """Matches and heights between two samples, given in any order, before or after the samples around them."""
    ride = gait()
    samples = list(ride.samples(3.0, noise=1.0))
    times = [2.413, 2.5004, 2.6, 2.777]

    def final(order: list[int], early: bool) -> NavigationState:
        estimator = NavigationFilter(CONFIG)
        cut = 245 if early else len(samples)
        for sample in samples[:cut]:
            estimator.predict(sample)
        for i in order:
            if i % 2:
                estimator.update_height(stamp(times[i]), 0.1)
            else:
                estimator.fuse_planar(stamp(times[i]), xi(ride, times[i]), R, OMEGA)
        for sample in samples[cut:]:
            estimator.predict(sample)
        return estimator.state

    expected = final([0, 1, 2, 3], early=False)
    assert same(expected, final([3, 1, 0, 2], early=False))
    assert same(expected, final([2, 3, 1, 0], early=True))


def test_at_gives_the_belief_of_any_instant() -> None:
    """On a sample it is the belief of that sample, between two it lies between, beyond the last it goes on."""
    ride = gait()
    estimator = begun(3.0, ride)
    for t in (2.0, 2.505, 2.9999, 3.02):
        state = estimator.at(stamp(t))
        assert state.stamp_ns == stamp(t)
        assert np.allclose(state.T_map_base.translation, ride.position(t), atol=0.01)
        assert np.allclose(geometry.rotation_matrix(state.T_map_base.rotation), ride.attitude(t), atol=0.01)
        pose = estimator.pose(stamp(t))
        assert np.allclose(pose.translation, state.T_map_base.translation)
        assert np.allclose(pose.rotation, state.T_map_base.rotation)
    assert same(estimator.state, estimator.at(stamp(3.0)), 0.0)


def test_an_instant_before_the_history_gives_the_oldest_belief() -> None:
    """Its stamp says which instant it is."""
    estimator = begun(6.0)
    oldest = estimator.at(stamp(0.0))
    assert stamp(2.0) < oldest.stamp_ns < stamp(5.0)
    assert estimator.pose(stamp(0.0)).rotation is not None


def test_a_measurement_older_than_the_history_is_refused() -> None:
    """It changes nothing, is counted, and a match gives the same belief before and after."""
    estimator = begun(6.0)
    state = estimator.state
    assert not estimator.update_height(stamp(0.6), 5.0)
    before, after = estimator.fuse_planar(stamp(0.6), np.ones(3), R, OMEGA)
    assert before is after
    assert estimator.counts["correction older than the history"] == 2
    assert same(state, estimator.state, 0.0)


# Broken input


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e30])
def test_a_broken_sample_is_counted_and_dropped(value: float) -> None:
    """NaN, infinity and the impossible change nothing, in rates or in forces."""
    estimator = begun()
    state = estimator.state
    estimator.predict(Imu(stamp(1.01), np.array([0.0, value, 0.0]), -GRAVITY))
    estimator.predict(Imu(stamp(1.01), np.zeros(3), np.array([0.0, 0.0, value])))
    assert estimator.counts["inertial sample without a plausible value"] == 2
    assert same(state, estimator.state, 0.0)


def test_a_broken_correction_is_counted_and_dropped() -> None:
    """A match with NaN, a covariance that is none, a height without end: nothing of it reaches the belief."""
    estimator = begun()
    state = estimator.state
    estimator.fuse_planar(stamp(1.0), np.array([0.0, np.nan, 0.0]), R, OMEGA)
    estimator.fuse_planar(stamp(1.0), np.zeros(3), -R, OMEGA)
    estimator.fuse_planar(stamp(1.0), np.zeros(3), np.full((3, 3), np.nan), OMEGA)
    estimator.update_height(stamp(1.0), np.inf)
    estimator.update_velocity_body(stamp(1.0), np.array([np.nan, 0.0]), 0.1)
    assert estimator.counts["correction without a usable value"] == 5
    assert same(state, estimator.state, 0.0)


def test_repeated_and_backward_samples_are_counted_and_dropped() -> None:
    """Only a later stamp moves the filter on."""
    estimator = begun()
    state = estimator.state
    for t in (1.0, 0.99, 0.2):
        estimator.predict(Imu(stamp(t), np.ones(3), np.ones(3)))
    assert estimator.counts["inertial sample not later than the one before"] == 3
    assert same(state, estimator.state, 0.0)


def test_a_gap_is_counted_and_costs_certainty() -> None:
    """Over a second without samples the belief stays where it was, and knows that it may have turned and moved."""
    estimator = begun()
    before = estimator.state
    estimator.predict(Imu(stamp(2.0), np.zeros(3), -GRAVITY))
    after = estimator.state
    assert estimator.counts["gap in the inertial data"] == 1
    assert np.allclose(after.T_map_base.translation, before.T_map_base.translation, atol=1e-3)
    assert np.sqrt(after.covariance[2, 2]) > 0.3
    assert np.sqrt(after.covariance[3, 3]) > 0.5


def test_matches_carry_the_filter_while_inertial_data_is_missing() -> None:
    """With matches alone the position follows a moving base, and samples that come back are used again."""
    estimator = begun()
    for k in range(1, 120):
        t = 1.0 + k / 40
        estimator.fuse_planar(stamp(t), np.array([0.5 * (t - 1.0), 0.0, 0.0]), R, OMEGA)
    found = estimator.at(stamp(4.0)).T_map_base.translation
    assert abs(found[0] - 1.5) < 0.2 and abs(found[1]) < 0.05
    stamp_ns = estimator.stamp_ns
    for k in range(100):
        estimator.predict(Imu(stamp(4.0 + k / 100), np.zeros(3), -GRAVITY))
    assert estimator.stamp_ns > stamp_ns and np.isfinite(estimator.state.covariance).all()


def test_a_single_stamp_far_ahead_is_not_believed() -> None:
    """A sample from next year is dropped, the next good one used; a real pause is believed at its second stamp."""
    estimator = begun()
    estimator.predict(Imu(stamp(3e7), np.zeros(3), -GRAVITY))
    estimator.predict(Imu(stamp(1.01), np.zeros(3), -GRAVITY))
    assert estimator.stamp_ns == stamp(1.01) and estimator.counts["stamp far ahead"] == 1
    for t in (60.0, 60.01):
        estimator.predict(Imu(stamp(t), np.zeros(3), -GRAVITY))
    assert estimator.stamp_ns == stamp(60.01)


# Copies


def test_a_copy_goes_its_own_way() -> None:
    """What happens to the copy leaves the original as it was, and the same input gives the same bytes."""
    ride = gait()
    samples = list(ride.samples(4.0, noise=1.0))
    estimator = NavigationFilter(CONFIG)
    for sample in samples[:300]:
        estimator.predict(sample)
    state, other = estimator.state, estimator.copy()
    for branch in (other, estimator):
        if branch is estimator:
            assert same(state, estimator.state, 0.0)
        for sample in samples[300:]:
            branch.predict(sample)
        branch.fuse_planar(stamp(3.5), xi(ride, 3.5), R, OMEGA)
    assert same(estimator.state, other.state, 0.0) and estimator.counts == other.counts


def test_settings_change_from_the_next_measurement_on() -> None:
    """A lower bound on height noise makes the next height count for more."""
    estimator = begun()
    other = estimator.copy()
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
            _, state = estimator.fuse_planar(sample.stamp_ns, xi(ride, k / 100), R, OMEGA, method)
            off.append(np.linalg.norm((state.T_map_base.translation - ride.position(k / 100))[:2]))
            assert np.linalg.eigvalsh(state.covariance)[0] > 0.0
    assert max(off) < 0.05


# What the platform cannot do


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


# Settings of time, and clocks


def test_the_history_is_as_long_as_is_asked_for() -> None:
    """Four seconds late is too late by default, and in time for a history of five seconds."""
    for seconds, taken in ((1.5, False), (5.0, True)):
        estimator = begun(20.0, config=replace(CONFIG, history=seconds))
        assert estimator.update_height(stamp(16.0), 0.1) is taken
    assert not estimator.update_height(stamp(8.0), 0.1)


def test_a_clock_set_back_goes_on_from_the_last_belief() -> None:
    """Samples of an hour ago are dropped; after a fifth of a second of them the filter goes on, less sure."""
    estimator = begun(2.0)
    before = estimator.state
    for k in range(40):
        estimator.predict(Imu(stamp(-3600.0 + k / 100), np.zeros(3), -GRAVITY))
    after = estimator.state
    assert after.stamp_ns == stamp(-3600.0 + 0.39) and estimator.counts["clock set back"] == 1
    assert np.allclose(after.T_map_base.translation, before.T_map_base.translation, atol=0.05)
    assert after.covariance[3, 3] > 100 * before.covariance[3, 3]
    assert estimator.update_height(stamp(-3600.0 + 0.3), 0.0)


def test_a_second_unit_whose_clock_is_behind_changes_nothing() -> None:
    """Its samples are dropped for ever: those of the first go on between them."""
    estimator, alone = begun(2.0), begun(4.0)
    for k in range(1, 201):
        estimator.predict(Imu(stamp(1.0 + k / 100), np.ones(3), np.ones(3)))
        estimator.predict(Imu(stamp(2.0 + k / 100), np.zeros(3), -GRAVITY))
    assert same(estimator.state, alone.state) and estimator.counts["clock set back"] == 0


def test_a_clipped_gyro_makes_the_attitude_unsure() -> None:
    """One value again and again at the end of the range, known or found; a gyro at rest is not clipped."""
    for limit in (0.0, 4.0):
        config = replace(CONFIG, gyro_range=limit)
        estimator = begun(1.0, config=config)
        sure = estimator.state.covariance[2, 2]
        for k in range(101, 131):
            estimator.predict(Imu(stamp(k / 100), np.array([0.0, 0.0, 4.0]), -GRAVITY))
        assert estimator.counts["gyro at the end of its range"] >= 28
        assert np.sqrt(estimator.state.covariance[2, 2]) > max(0.3, 10 * np.sqrt(sure))
    assert begun(3.0).counts["gyro at the end of its range"] == 0


def test_it_takes_over_at_the_pose_of_somebody_else() -> None:
    """Placed, it stands there, turned with its velocity, and is as unsure of the plane as that pose."""
    ride = Ride(lambda t: np.array([grown(t), 0.0, 0.0]), lambda t: euler_matrix(0.1 * grown(t), 0.0, 0.0))
    estimator = begun(2.0, ride)
    before = estimator.state
    estimator.place(PlanarGaussian(np.array([3.0, -2.0, np.pi / 2]), 0.04 * np.eye(3)))
    after = estimator.state
    assert np.allclose(geometry.planar(after.T_map_base), [3.0, -2.0, np.pi / 2])
    assert np.allclose(after.velocity, [-before.velocity[1], before.velocity[0], before.velocity[2]])
    assert after.T_map_base.translation[2] == before.T_map_base.translation[2]
    assert after.covariance[3, 3] == pytest.approx(0.04)


@pytest.mark.parametrize("rate", [30.0, 200.0, 1000.0])
def test_any_rate_of_samples_with_gaps_jitter_and_duplicates(rate: float) -> None:
    """A tenth lost, a tenth doubled, each stamp off by a fifth of the interval: the walk is still followed."""
    ride, rng, estimator, off, due = gait(), np.random.default_rng(7), NavigationFilter(CONFIG), [], 1.0
    for k in range(round(6.0 * rate)):
        t = (k + rng.uniform(-0.2, 0.2)) / rate
        for _ in range(rng.choice([0, 1, 1, 1, 1, 1, 1, 1, 1, 2])):
            estimator.predict(Imu(stamp(t), ride.rate(t), ride.force(t)))
        if estimator.ready and t > due:
            due += 0.05
            at = t - 0.01
            _, state = estimator.fuse_planar(stamp(at), xi(ride, at), R, OMEGA)
            off.append(np.linalg.norm((state.T_map_base.translation - ride.position(at))[:2]))
    assert len(off) > 90 and max(off) < 0.06
