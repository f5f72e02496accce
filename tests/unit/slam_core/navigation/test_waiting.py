"""Measurements that wait for the scan before them."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from slam_core.measurements import Odometry
from slam_core.navigation.planar_motion import SET_BACK_NS
from slam_core.navigation.waiting import LONGEST_NS, Waiting


def wheels(stamp_ns: int) -> Odometry:
    """At a time."""
    return Odometry(stamp_ns, np.zeros(2), 0.0)


def stamps(released: list) -> list[int]:
    """Of measurements."""
    return [each.stamp_ns for each in released]


def test_a_scan_takes_what_was_measured_until_then():
    """In the order of the stamps; the rest waits on."""
    waiting = Waiting()
    for stamp_ns in (10, 30, 20, 40):
        assert not waiting.push(wheels(stamp_ns))
    assert stamps(waiting.until(30)) == [10, 20, 30]
    assert stamps(waiting.until(35)) == []
    assert stamps(waiting.flush()) == [40]


def test_nothing_waits_for_long():
    """If no scan comes it is taken after two seconds."""
    waiting = Waiting()
    assert not waiting.push(wheels(0))
    assert not waiting.push(wheels(LONGEST_NS - 1))
    assert stamps(waiting.push(wheels(LONGEST_NS))) == [0]


def test_a_clock_that_is_set_back_ends_the_wait():
    """What came by the old clock comes first."""
    waiting = Waiting()
    waiting.push(wheels(10 * SET_BACK_NS))
    assert not waiting.push(wheels(9 * SET_BACK_NS))
    assert stamps(waiting.push(wheels(0))) == [9 * SET_BACK_NS, 10 * SET_BACK_NS]
    assert stamps(waiting.flush()) == [0]


@given(st.lists(st.integers(0, 2**62), max_size=50), st.integers(0, 2**62))
def test_nothing_is_lost_or_kept_for_good(times, until):
    """Whatever the stamps are, each measurement comes out once, and no more wait than came in two seconds."""
    waiting, released = Waiting(), []
    for time_ns in times:
        released += waiting.push(wheels(time_ns))
    released += waiting.until(until)
    left = waiting.flush()
    assert sorted(stamps(released + left)) == sorted(times)
    assert not left or max(stamps(left)) - min(stamps(left)) < LONGEST_NS
