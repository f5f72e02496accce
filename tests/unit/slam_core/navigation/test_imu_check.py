"""Inertial data as devices give it: broken, repeated, missing, clipped, by clocks that jump."""

from dataclasses import replace

import numpy as np
import pytest

from slam_core.kernels.imu_check import SAME, TOLD_APART
from slam_core.measurements import Imu
from slam_core.navigation.filter import NavigationFilter
from slam_core.navigation.imu_check import SENT_AGAIN
from tests.filters import CONFIG, OMEGA, R, begun, same, xi
from tests.motions import GRAVITY, gait, stamp


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e30])
def test_a_broken_sample_is_counted_and_dropped(value: float) -> None:
    """NaN, infinity and the impossible change nothing, in rates or in forces."""
    estimator = begun()
    state = estimator.state
    estimator.predict(Imu(stamp(1.01), np.array([0.0, value, 0.0]), -GRAVITY))
    estimator.predict(Imu(stamp(1.01), np.zeros(3), np.array([0.0, 0.0, value])))
    assert estimator.counts["inertial sample without a plausible value"] == 2
    assert same(state, estimator.state, 0.0)


def noisy(t: float, rng: np.random.Generator) -> Imu:
    """A sample at rest."""
    return Imu(stamp(t), 0.002 * rng.standard_normal(3), -GRAVITY + 0.05 * rng.standard_normal(3))


def sent(before: int, turn: float, *, noise: bool = True) -> NavigationFilter:
    """So many samples at rest at 100 Hz, then one in a turn (rad/s) again and again, for half a second."""
    estimator, rng = NavigationFilter(CONFIG), np.random.default_rng(0)
    rest = [noisy(1.01 + k / 100, rng) for k in range(before)]
    for sample in rest:
        estimator.predict(sample if noise else replace(rest[0], stamp_ns=sample.stamp_ns))
    last = Imu(0, np.array([0.0, 0.0, turn]), -GRAVITY)
    for k in range(50):
        estimator.predict(replace(last, stamp_ns=stamp(1.01 + (before + k) / 100)))
    return estimator


def test_a_sample_that_is_sent_again_and_again_is_no_measurement() -> None:
    """Its driver hangs: the heading stays what the first fifth of a second made of it. It is counted."""
    estimator = sent(300, 1.0)
    assert estimator.counts[SENT_AGAIN] == 50 - SAME + 1
    assert estimator.sample_ns == stamp(1.01 + (300 + SAME - 2) / 100)


@pytest.mark.parametrize(
    ("before", "turn", "noise"), [(300, 0.0, True), (300, 1.0, False), (TOLD_APART // 2, 1.0, True)]
)
def test_a_sensor_without_noise_may_repeat_itself(before: int, turn: float, noise: bool) -> None:
    """A gyro that is silent at rest, a simulation without noise, a sensor of which too little is known."""
    estimator = sent(before, turn, noise=noise)
    assert not estimator.counts[SENT_AGAIN]
    assert estimator.sample_ns == stamp(1.01 + (before + 49) / 100)


def test_samples_of_a_driver_that_goes_on_count_again() -> None:
    """Also after the second time that it hung."""
    estimator, rng, last = NavigationFilter(CONFIG), np.random.default_rng(0), noisy(0.0, np.random.default_rng(1))
    for k in range(800):
        hangs = k % 400 >= 300
        estimator.predict(replace(last, stamp_ns=stamp(1.01 + k / 100)) if hangs else noisy(1.01 + k / 100, rng))
        if not hangs and estimator.ready:
            assert estimator.sample_ns == stamp(1.01 + k / 100)
    assert estimator.counts[SENT_AGAIN] == 2 * (100 - SAME + 1)


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
            state = estimator.fuse_planar(stamp(at), xi(ride, at), R, OMEGA)
            off.append(np.linalg.norm((state.T_map_base.translation - ride.position(at))[:2]))
    assert len(off) > 90 and max(off) < 0.06
