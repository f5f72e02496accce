"""Samples of an IMU that leap: spikes are left out, motions are used, those of a base that is hit count less."""

from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slam_core.kernels.imu_spikes import LONGEST, MOST_WAITING
from slam_core.measurements import Float64s, Imu
from slam_core.navigation.filter import NavigationFilter, projected
from slam_core.navigation.imu_check import AFTER_LEAP
from slam_core.navigation.imu_spikes import NEAR_NS, SPIKE, SpikeFilter
from tests.filters import CONFIG, OMEGA, R, begun
from tests.motions import GRAVITY, stamp

REST = np.concatenate([np.zeros(3), -GRAVITY])
TURN, PUSH = np.array([0.0, 5.0, 0.0, 0.0, 0.0, 0.0]), np.array([0.0, 0.0, 0.0, 30.0, 0.0, 0.0])


def sample(k: int, values: Float64s, rate: float = 100.0) -> Imu:
    """The k-th of an IMU, (6,) rates and forces."""
    return Imu(stamp(k / rate), values[:3].copy(), values[3:].copy())


def admitted(samples: list[Imu]) -> tuple[list[Imu], int]:
    """What is used of them, and how many spikes were counted."""
    counts: Counter[str] = Counter()
    spikes = SpikeFilter(counts)
    return [each for imu in samples for each in spikes.admit(imu)], counts[SPIKE]


@pytest.mark.parametrize("leap", [TURN, PUSH, -TURN - PUSH])
def test_a_spike_is_left_out_and_counted(leap: Float64s) -> None:
    """One sample that leaps, in rates, in forces, or in both; those around it are used as they come."""
    samples = [sample(k, REST + leap * (k in (20, 40, 42))) for k in range(60)]
    used, spikes = admitted(samples)
    assert used == [imu for k, imu in enumerate(samples) if k not in (20, 40, 42)]
    assert spikes == 3


@pytest.mark.parametrize(
    ("leap", "samples", "rate"), [(PUSH, 2, 100.0), (TURN, 4, 100.0), (TURN, 16, 400.0), (-TURN - PUSH, 2, 50.0)]
)
def test_a_spike_may_last_some_samples(leap: Float64s, samples: int, rate: float) -> None:
    """Up to 40 ms, as of a driver that sends what is wrong again; each sample of it counts."""
    values = [sample(k, REST + leap * (20 <= k < 20 + samples), rate) for k in range(60)]
    used, spikes = admitted(values)
    assert used == values[:20] + values[20 + samples :]
    assert spikes == samples


@pytest.mark.parametrize("rebound", [-16.0, -8.0, 5.0])
def test_a_base_that_is_hit_has_no_spike(rebound: float) -> None:
    """It is pushed for 20 ms, and does not move as before at once: all samples are used, in their order."""
    push = [40.0, 40.0, *[rebound] * 5]
    samples = [sample(k, REST + PUSH / 30.0 * (push[k - 120] if 120 <= k < 127 else 0.0)) for k in range(160)]
    assert admitted(samples) == (samples, 0)


@pytest.mark.parametrize(("leap", "lasts"), [(TURN, 20), (PUSH, 20), (4.0 * TURN, 8)])
def test_a_motion_that_begins_at_once_is_used(leap: Float64s, lasts: int) -> None:
    """The next samples follow the one that leapt: all are used, in their order."""
    samples = [sample(k, REST + leap * (20 <= k < 20 + lasts)) for k in range(60)]
    assert admitted(samples) == (samples, 0)


def test_a_base_that_shakes_all_the_time_has_no_spikes() -> None:
    """Forces to and fro by 4 g from sample to sample, as on an engine: after the first second all are used."""
    rng = np.random.default_rng(1)
    samples = [sample(k, REST + np.repeat([1.0, 40.0], 3) * rng.uniform(-1, 1, 6)) for k in range(500)]
    used, _ = admitted(samples)
    assert used[-400:] == samples[-400:]


def test_an_imu_that_is_slow_is_used_as_it_is() -> None:
    """Between samples that far apart a base begins and ends a motion."""
    samples = [sample(k, REST + TURN * (k % 7 == 6), rate=8.0) for k in range(60)]
    assert admitted(samples) == (samples, 0)


@pytest.mark.parametrize(("push", "leaps"), [(20.0, False), (40.0, True)])
def test_the_further_apart_samples_are_the_more_they_may_differ(push: float, leaps: bool) -> None:
    """At 30 Hz 20 m/s² in one of them are a motion, which makes nothing unsure; 40 m/s² are a spike or a hit."""
    values = [REST + push / 30.0 * PUSH * (k == 40) for k in range(100)]
    samples = [sample(k, each, rate=30.0) for k, each in enumerate(values)]
    estimator = NavigationFilter(CONFIG)
    for each in samples:
        estimator.predict(each)
    assert (admitted(samples)[1] > 0) == (estimator.counts[AFTER_LEAP] > 0) == leaps


NUMBERS = st.sampled_from([0.0, 0.5, -3.0, 20.0, 90.0, -250.0, 1e4, np.nan, np.inf])


@given(st.lists(st.tuples(st.sampled_from([-5, 0, 1, 10, 40, 120]), NUMBERS, NUMBERS), max_size=60))
def test_nothing_is_held_for_long_used_twice_or_lost_uncounted(drawn: list[tuple[int, float, float]]) -> None:
    """Whatever comes, by clocks that stop and go back, too: those that wait follow soon, and the order is kept."""
    counts: Counter[str] = Counter()
    spikes, used, stamp_ns = SpikeFilter(counts), [], 0
    samples = []
    for step, rate, force in drawn:
        stamp_ns += step * 1_000_000
        samples.append(Imu(stamp_ns, np.full(3, rate), np.full(3, force)))
        used += spikes.admit(samples[-1])
    order = [next(k for k, each in enumerate(samples) if each is imu) for imu in used]
    waiting = len(samples) - len(used) - counts[SPIKE]
    assert len(set(order)) == len(order) and waiting >= 0
    held = samples[len(samples) - waiting :]
    assert all(each.stamp_ns - used[-1].stamp_ns < 1e9 * LONGEST for each in held[1:])
    possible = [k for k in order if abs(samples[k].angular_velocity[0]) < 200.0]
    assert possible == sorted(possible)
    later = spikes.admit(Imu(stamp_ns + 2 * NEAR_NS, np.zeros(3), np.zeros(3)))
    assert len(later) == 1 + waiting


def test_little_waits_behind_a_clock_that_stands() -> None:
    """A stamp that comes for ever, with other values than before: they pass."""
    samples = [sample(min(k, 50), REST + PUSH * (k >= 50)) for k in range(50 + 3 * MOST_WAITING)]
    assert len(admitted(samples)[0]) >= len(samples) - MOST_WAITING


@pytest.mark.parametrize(("samples", "degrees"), [(1, 2.0), (2, 2.5)])
def test_a_base_may_have_turned_in_what_passed_for_a_spike(samples: int, degrees: float) -> None:
    """If it was knocked round, its heading is unsure by a good part of that."""
    estimator, spikes, turned = NavigationFilter(CONFIG), SpikeFilter(Counter()), np.radians(degrees)
    for k in range(300):
        knocked = np.array([0.0, 0.0, 100.0 * turned / samples, 0.0, 0.0, 0.0]) * (290 <= k < 290 + samples)
        for imu in spikes.admit(sample(k, REST + knocked)):
            estimator.predict(imu, spikes.hit)
        if k % 5 == 0 and 100 < k < 290:
            estimator.fuse_planar(stamp(k / 100), np.zeros(3), R, OMEGA)
    unsure = np.sqrt(projected(estimator.at(stamp(2.99))).covariance[2, 2])
    assert turned / 4.0 < unsure < turned


def hit(samples: int, leap: Float64s, rest: int) -> NavigationFilter:
    """At rest for 2 s, hit for so many samples, at rest for so many, at 100 Hz; matches at 20 Hz."""
    estimator = begun(2.0)
    for k in range(201, 201 + samples + rest):
        t = k / 100
        values = REST + leap * (k < 201 + samples)
        estimator.predict(sample(k, values))
        if k % 5 == 0:
            estimator.fuse_planar(stamp(t), np.zeros(3), R, OMEGA)
    return estimator


@pytest.mark.parametrize("samples", [2, 3])
def test_the_tilt_is_found_again_after_a_hit(samples: int) -> None:
    """Samples that leap by 5 rad/s and 3 g, and follow each other: what they showed is soon not believed."""
    estimator = hit(samples, TURN + PUSH, 150 - samples)
    state = estimator.state
    tilt = np.degrees(2.0 * np.hypot(*state.T_map_base.rotation[1:3]))
    assert estimator.counts[AFTER_LEAP] > samples
    assert tilt < 2.0 and np.linalg.norm(state.velocity[:2]) < 0.15


@pytest.mark.parametrize("samples", [2, 3, 4])
def test_a_push_does_not_show_where_down_is(samples: int) -> None:
    """The smoothed force takes in nothing while a base is shaken: a push of 3 g does not tilt it by 1 degree."""
    estimator = hit(samples, PUSH, 1)
    assert estimator.sample_ns is not None
    force = estimator.poses(estimator.sample_ns, np.zeros(1, np.int64))[0, 16:19]
    assert np.degrees(np.arctan2(np.hypot(*force[:2]), force[2])) < 1.0
