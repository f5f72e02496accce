"""Each measurement at its own time, however late it comes, and copies that go their own way."""

import pickle
from copy import deepcopy
from dataclasses import replace

import numpy as np
import pytest

from slam_core import geometry
from slam_core.navigation.filter import NavigationFilter
from slam_core.results import NavigationState
from tests.filters import CONFIG, OMEGA, R, begun, same, xi
from tests.motions import gait, stamp


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
    assert np.array_equal(estimator.pose(stamp(0.0)).translation, oldest.T_map_base.translation)
    assert np.array_equal(estimator.pose(stamp(0.0)).rotation, oldest.T_map_base.rotation)


def test_a_measurement_older_than_the_history_is_refused() -> None:
    """It changes nothing, is counted, and a match gives the same belief before and after."""
    estimator = begun(6.0)
    state = estimator.state
    assert not estimator.update_height(stamp(0.6), 5.0)
    before = estimator.at(stamp(0.6))
    after = estimator.fuse_planar(stamp(0.6), np.ones(3), R, OMEGA)
    assert same(before, after, 0.0)
    assert estimator.counts["correction older than the history"] == 2
    assert same(state, estimator.state, 0.0)


def test_the_history_is_as_long_as_is_asked_for() -> None:
    """Four seconds late is too late by default, and in time for a history of five seconds."""
    for seconds, taken in ((1.5, False), (5.0, True)):
        estimator = begun(20.0, config=replace(CONFIG, history=seconds))
        assert estimator.update_height(stamp(16.0), 0.1) is taken
    assert not estimator.update_height(stamp(8.0), 0.1)


def test_a_copy_goes_its_own_way() -> None:
    """What happens to the copy leaves the original as it was, and the same input gives the same bytes."""
    ride = gait()
    samples = list(ride.samples(4.0, noise=1.0))
    estimator = NavigationFilter(CONFIG)
    for sample in samples[:300]:
        estimator.predict(sample)
    state, other = estimator.state, deepcopy(estimator)
    for branch in (other, estimator):
        if branch is estimator:
            assert same(state, estimator.state, 0.0)
        for sample in samples[300:]:
            branch.predict(sample)
        branch.fuse_planar(stamp(3.5), xi(ride, 3.5), R, OMEGA)
    assert same(estimator.state, other.state, 0.0) and estimator.counts == other.counts


@pytest.mark.parametrize("t", [0.9, 0.905])
def test_a_belief_that_was_handed_out_stays_as_it_was(t: float) -> None:
    """At a sample or between two, neither matches nor samples that come later change the numbers in it."""
    estimator = begun(1.0)
    estimator.fuse_planar(stamp(0.8), np.zeros(3), R, OMEGA)
    held = estimator.at(stamp(t))
    kept = held._replace(x=held.x.copy(), covariance=held.covariance.copy())
    estimator.fuse_planar(stamp(0.85), np.array([0.1, 0.0, 0.0]), R, OMEGA)
    later = estimator.at(stamp(0.99))
    assert not same(later, kept) and same(held, kept, 0.0)


@pytest.mark.parametrize("wait", [0.0, 0.05])
def test_what_was_kept_goes_on_to_the_last_byte(wait: float) -> None:
    """Kept after any second, with matches in time or late: what follows is what would have followed.

    The settings change half a second before some of them, so that estimates of both are kept.
    """
    ride = gait()
    estimator, kept, pending = NavigationFilter(CONFIG), [], []
    for k, sample in enumerate(ride.samples(9.0, noise=1.0)):
        every = [estimator, *kept]
        if k in (250, 450, 451):
            for each in every:
                each.configure(replace(CONFIG, gyro_noise=CONFIG.gyro_noise * (1 + k)))
        for each in every:
            each.predict(sample)
        if estimator.ready and k % 4 == 0:
            pending.append(k / 100)
        while pending and pending[0] + wait <= k / 100 + 1e-9:
            t = pending.pop(0)
            for each in every:
                each.fuse_planar(stamp(t), xi(ride, t), R, OMEGA)
                each.update_height(stamp(t), ride.position(t)[2])
        if estimator.ready and k % 100 == 99:
            kept.append(pickle.loads(pickle.dumps(estimator)))
    assert len(kept) >= 8
    for other in kept:
        for one, two in zip(estimator.state, other.state, strict=True):
            np.testing.assert_array_equal(one, two)
