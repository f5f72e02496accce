"""Scans and inertial data that came together, stamped on arrival, are put back to when they were measured."""

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from slam_core.batches import MOST, Batches
from slam_core.measurements import Imu, LaserScan, Transform

MS = 1_000_000
STEADY = range(0, 1000, 50)  # milliseconds


def scan(t: float, sweep: float = 0.0) -> LaserScan:
    """A scan of 21 beams at t milliseconds, told from others by its ranges; the sweep lasts so many."""
    ranges = np.full(21, 1.0 + 1e-4 * t, np.float32)
    return LaserScan(round(t * MS), ranges, 0.0, 0.1, time_increment=sweep / 20 * 1e-3)


def given_out(batches: Batches, scans: Iterable[LaserScan]) -> list[LaserScan]:
    """What comes out, in the end with what was held."""
    return [each for one in scans for each in batches.push(one)] + batches.flush()


def times(scans: Iterable[LaserScan]) -> list[float]:
    """Milliseconds."""
    return [each.stamp_ns / MS for each in scans]


def after_steady(*later: float, sweep: float = 0.0) -> list[float]:
    """Times of scans that come at these times after some at a steady rate."""
    return times(given_out(Batches("scans"), (scan(t, sweep) for t in (*STEADY, *later))))[len(STEADY) :]


def test_scans_at_a_steady_rate_pass_at_once_as_they_are() -> None:
    """Each of them, and their stamps jitter."""
    batches = Batches("scans")
    scans = [scan(50 * k + (7 * k) % 11) for k in range(60)]
    assert [batches.push(each) for each in scans] == [[each] for each in scans]


def test_those_that_came_together_are_taken_a_period_apart() -> None:
    """The last one was measured at its stamp, the others before it."""
    assert after_steady(1198, 1199, 1199.5, 1200, 1250) == [1050, 1100, 1150, 1200, 1250]


def test_none_is_put_before_what_was_measured_before() -> None:
    """More came than a steady rate explains: they share the time since the one before."""
    assert after_steady(1148, 1149, 1149.5, 1150) == [1000, 1050, 1100, 1150]
    assert after_steady(1098, 1099, 1099.5, 1100) == [987.5, 1025, 1062.5, 1100]


def test_a_pause_alone_changes_nothing() -> None:
    """Scans that are missing were not held up."""
    assert after_steady(1200, 1250, 3000, 3050) == [1200, 1250, 3000, 3050]


def test_scans_close_together_without_a_pause_before_them_stay() -> None:
    """Nothing held them up."""
    assert after_steady(1000, 1002, 1050) == [1000, 1002, 1050]


def test_a_second_laser_measures_when_it_likes() -> None:
    """Scans by another mount do not come together with those of the first."""
    other = replace(scan(1201), T_base_laser=Transform(np.array([-0.3, 0.0, 0.0])))
    scans = [*map(scan, STEADY), scan(1200), other]
    assert given_out(Batches("scans"), scans) == scans


def test_scans_that_do_not_overlap_in_time_stay() -> None:
    """A fast laser of which few scans come: two may be as close as its sweep is long."""
    assert after_steady(1200, 1211, 1250, sweep=11.0) == [1200, 1211, 1250]


def test_the_last_scan_of_a_batch_waits_until_time_has_passed() -> None:
    """Something else of a later time shows that no more comes with it; so does the next scan."""
    batches = Batches("scans")
    given_out(batches, map(scan, STEADY))
    held = scan(1200)
    assert batches.push(held) == []
    assert batches.pass_time(1205 * MS) == []
    assert batches.pass_time(1213 * MS) == [held]


def test_a_clock_of_coarse_steps_gives_a_batch_one_time() -> None:
    """Its scans are told from copies by their ranges."""
    one = scan(1200)
    two = replace(one, ranges=one.ranges + np.float32(0.01))
    steady = [scan(t) for t in STEADY]
    assert times(given_out(Batches("scans"), [*steady, one, two]))[-2:] == [1150, 1200]
    assert times(given_out(Batches("scans"), [*steady, one, replace(one)]))[-2:] == [1200, 1200]


def test_a_copy_keeps_its_stamp() -> None:
    """A driver that has no new scan sends the last one again: nothing held that up."""
    steady, one = [scan(t) for t in STEADY], scan(1200)
    again = replace(one, stamp_ns=1205 * MS)
    assert given_out(Batches("scans"), [*steady, one, again])[-2:] == [one, again]


def test_what_came_together_is_told() -> None:
    """While it is so and a moment after."""
    batches = Batches("scans")
    given_out(batches, map(scan, (*STEADY, 1199, 1200)))
    assert [each.code for each in batches.diagnostics(1300 * MS)] == ["came_together"]
    assert not batches.diagnostics(9000 * MS)


def test_a_delay_that_hardly_matters_is_not_told() -> None:
    """Inertial data of an interface that hands on some samples at a time."""
    batches, imu = Batches[Imu]("inertial data"), Imu(0, np.zeros(3), np.ones(3))
    for k in range(40):
        batches.push(replace(imu, stamp_ns=5 * k * MS))
    assert batches.push(replace(imu, stamp_ns=204 * MS)) == []
    assert batches.push(Imu(205 * MS, np.zeros(3), np.full(3, 2.0))) == []
    assert [each.stamp_ns for each in batches.flush()] == [200 * MS, 205 * MS]
    assert not batches.diagnostics(205 * MS)


def test_a_link_that_sends_in_batches_from_the_start() -> None:
    """After some scans the mean rate is known."""
    stamps = [200 * k + 0.1 * i for k in range(1, 25) for i in range(4)]
    out = np.array(times(given_out(Batches("scans"), map(scan, stamps))))
    assert np.allclose(np.diff(out[60:]), 50.0, atol=1.0)


@given(st.lists(st.integers(-(10**10), 10**10) | st.integers(0, 10**6), max_size=80))
def test_whatever_the_stamps_no_scan_is_lost_or_out_of_order(steps: Sequence[int]) -> None:
    """Scans come out as they came in, none later than the latest stamp, and nothing is held without a bound."""
    batches, stamps = Batches("scans"), np.cumsum([0, *([50 * MS] * 12), *steps]).tolist()
    scans = [replace(scan(0), stamp_ns=stamp, ranges=np.full(3, k, np.float32)) for k, stamp in enumerate(stamps)]
    out = given_out(batches, scans)
    assert [each.ranges[0] for each in out] == list(range(len(scans)))
    assert max(each.stamp_ns for each in out) <= max(stamps)


def test_so_many_are_held_and_no_more() -> None:
    """Of stamps that hardly count time."""
    batches = Batches("scans")
    given_out(batches, map(scan, STEADY))
    out = [each for k in range(3 * MOST) for each in batches.push(scan(2000 + 1e-3 * k))]
    assert len(out) >= 2 * MOST
