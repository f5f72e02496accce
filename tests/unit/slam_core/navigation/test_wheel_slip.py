"""When wheel velocities are not those of the base."""

import numpy as np

from slam_core.config import MotionConfig
from slam_core.measurements import Odometry
from slam_core.navigation.planar_motion import WHEELS_SILENT_NS, PlanarMotion
from slam_core.navigation.wheel_slip import IN_A_ROW, LONGEST_NS, SHORTEST_NS, WheelSlip

STEP_NS = 50_000_000
FAST, AT_REST = np.array([0.8, 0.0]), np.zeros(2)


def used(speeds: list[float], estimate: float, step_ns: int = STEP_NS) -> list[bool]:
    """Which of the readings forward count, while the estimate stays the same; m/s."""
    slip, velocity = WheelSlip(), np.array([estimate, 0.0])
    readings = (Odometry(k * step_ns, np.array([speed, 0.0]), 0.0) for k, speed in enumerate(speeds))
    return [slip.rolls(reading, velocity) for reading in readings]


def test_wheels_that_brake_or_gather_speed_count():
    """By 5 m/s^2, and with noise of 0.1 m/s from one reading to the next."""
    assert all(used([0.0, 0.25, 0.5, 0.75, 0.5, 0.25, 0.0], estimate=0.0))
    assert all(used([0.8, 0.9, 0.75, 0.85], estimate=0.8))


def test_a_leap_at_a_low_rate_may_be_a_motion():
    """By 0.8 m/s within half a second."""
    assert all(used([0.8, 0.0], estimate=0.8, step_ns=500_000_000))


def test_wheels_that_stop_at_once_do_not_count_until_they_turn_again():
    """They are stuck while the base drives on."""
    assert used([0.8, 0.0, 0.0, 0.0, 0.8, 0.8], estimate=0.8) == [True, False, False, False, True, True]


def test_wheels_that_spin_at_once_do_not_count():
    """The base does not follow them."""
    assert used([0.0, 1.0, 1.0, 0.0], estimate=0.0) == [True, False, False, True]


def test_wheels_that_stopped_count_once_the_estimate_agrees():
    """The base was stopped by an obstacle, and matches show it."""
    slip = WheelSlip()
    assert slip.rolls(Odometry(0, FAST, 0.0), FAST)
    assert not slip.rolls(Odometry(STEP_NS, AT_REST, 0.0), FAST)
    assert slip.rolls(Odometry(2 * STEP_NS, AT_REST, 0.0), np.array([0.1, 0.0]))


def test_wheels_that_differ_for_long_count_again():
    """Where nothing else tells the motion, they do."""
    slip = WheelSlip()
    slip.rolls(Odometry(0, FAST, 0.0), FAST)
    assert not slip.rolls(Odometry(STEP_NS, AT_REST, 0.0), FAST)
    assert not slip.rolls(Odometry(LONGEST_NS, AT_REST, 0.0), FAST)
    assert slip.rolls(Odometry(STEP_NS + LONGEST_NS + 1, AT_REST, 0.0), FAST)


def test_wheels_that_scans_contradict_do_not_count_for_a_moment():
    """Readings that have stopped the estimate agree with it; scans need that moment to correct it."""
    slip = WheelSlip()
    assert slip.rolls(Odometry(0, AT_REST, 0.0), AT_REST)
    for _ in range(IN_A_ROW):
        slip.judge(STEP_NS, slips=True)
    assert not slip.rolls(Odometry(2 * STEP_NS, AT_REST, 0.0), AT_REST)
    assert not slip.rolls(Odometry(STEP_NS + SHORTEST_NS - 1, AT_REST, 0.0), AT_REST)
    assert not slip.rolls(Odometry(STEP_NS + SHORTEST_NS, AT_REST, 0.0), FAST)
    assert slip.rolls(Odometry(2 * STEP_NS + SHORTEST_NS, AT_REST, 0.0), AT_REST)


def test_less_than_several_scans_in_a_row_contradict_nothing():
    """They may be led astray themselves."""
    slip = WheelSlip()
    for slips in (*[True] * (IN_A_ROW - 1), False, True):
        slip.judge(STEP_NS, slips=slips)
    assert slip.rolls(Odometry(2 * STEP_NS, AT_REST, 0.0), FAST)


def test_a_clock_that_was_set_back_ends_the_doubt():
    """Times before the leap tell nothing of how long it has lasted."""
    slip = WheelSlip()
    slip.rolls(Odometry(10 * STEP_NS, FAST, 0.0), FAST)
    assert not slip.rolls(Odometry(11 * STEP_NS, AT_REST, 0.0), FAST)
    assert slip.rolls(Odometry(0, AT_REST, 0.0), FAST)


def test_the_motion_is_measured_while_wheels_count():
    """Stuck wheels change no velocity; half a second later the motion counts as not measured."""
    motion, config = PlanarMotion(), MotionConfig()
    assert not motion.driven
    for k in range(20):
        motion.add_odometry(Odometry(k * STEP_NS, FAST, 0.0), config)
    assert motion.driven
    assert motion.aided
    last, before = motion.stamp_ns, motion.twist
    assert last is not None
    motion.add_odometry(Odometry(last + STEP_NS, AT_REST, 0.0), config)
    np.testing.assert_array_equal(motion.twist, before)
    assert motion.driven
    motion.add_odometry(Odometry(last + WHEELS_SILENT_NS + 1, AT_REST, 0.0), config)
    assert not motion.driven
    assert not motion.aided


def test_a_scan_that_contradicts_the_wheels_leaves_them_out():
    """Their readings change no velocity then."""
    motion, config = PlanarMotion(), MotionConfig()
    assert motion.add_odometry(Odometry(0, FAST, 0.0), config)
    for _ in range(IN_A_ROW):
        motion.judge_wheels(STEP_NS, slips=True)
    before = motion.twist
    assert not motion.add_odometry(Odometry(2 * STEP_NS, FAST + 0.1, 0.0), config)
    np.testing.assert_array_equal(motion.twist, before)


def test_a_copy_of_the_motion_has_its_own_doubt():
    """A reading to the copy changes nothing in the original."""
    motion, config = PlanarMotion(), MotionConfig()
    for k in range(20):
        motion.add_odometry(Odometry(k * STEP_NS, FAST, 0.0), config)
    other = motion.copy()
    other.add_odometry(Odometry(20 * STEP_NS, AT_REST, 0.0), config)
    motion.add_odometry(Odometry(20 * STEP_NS, FAST, 0.0), config)
    motion.add_odometry(Odometry(31 * STEP_NS, FAST, 0.0), config)
    assert motion.driven
