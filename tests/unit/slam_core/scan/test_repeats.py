"""Scans that a driver sends again."""

from dataclasses import replace

import numpy as np
import pytest

from slam_core.measurements import LaserScan
from slam_core.scan.repeats import AWAY, BELIEVED_NS, STANDS, Repeats

DT_NS = 50_000_000
FIRST = LaserScan(DT_NS, np.array([1.0, np.inf, np.nan, 2.0], np.float32), 0.0, 0.1)


def repeats(speed: float, count: int, *, measured: bool = True) -> list[bool]:
    """Whether each of so many copies of a scan counts as one, while the robot is predicted to move (m/s)."""
    found = Repeats()
    assert not found.takes(FIRST, np.zeros(3), measured=measured)
    times = DT_NS * np.arange(1, count + 1)
    return [
        found.takes(
            replace(FIRST, stamp_ns=FIRST.stamp_ns + int(t), ranges=FIRST.ranges.copy()),
            np.array([speed * t * 1e-9, 0.0, 0.0]),
            measured=measured,
        )
        for t in times
    ]


def test_a_moving_robot_sees_no_scan_twice() -> None:
    """Every copy is one, as long as they come. NaN equals NaN there."""
    assert all(repeats(0.5, 100))


def test_a_robot_at_rest_may_see_the_same_again() -> None:
    """So it is in a simulation without noise."""
    assert not any(repeats(0.9 * STANDS, int(AWAY / STANDS * 1e9 / DT_NS)))


def test_a_robot_that_stopped_elsewhere_sees_no_scan_twice() -> None:
    """A copy that came while it still moved would draw it back to where the scan was measured."""
    found, slowly = Repeats(), np.array([0.9 * STANDS * DT_NS * 1e-9, 0.0, 0.0])
    found.takes(FIRST, np.zeros(3), measured=True)
    found.located(np.zeros(3))
    taken = [found.takes(_copy(k), k * slowly, measured=True) for k in range(1, 100)]
    assert not any(taken[: int(0.9 * AWAY / slowly[0])])
    assert all(taken[int(1.2 * AWAY / slowly[0]) :])


def test_copies_at_rest_do_not_move_the_place_of_the_scan() -> None:
    """Each is a measurement of the same place: errors of the prediction do not add up."""
    found, error = Repeats(), np.array([0.5 * STANDS * DT_NS * 1e-9, 0.0, 0.0])
    found.takes(FIRST, np.zeros(3), measured=True)
    for k in range(1, 1000):
        found.located(np.zeros(3))
        assert not found.takes(_copy(k), error, measured=True)


def test_a_mean_speed_is_believed_for_a_second() -> None:
    """Where nothing measures the motion, the robot has stopped then."""
    found = repeats(0.5, 40, measured=False)
    believed = BELIEVED_NS // DT_NS
    assert all(found[: believed - 1])
    assert not any(found[believed:])


def _copy(k: int) -> LaserScan:
    """The scan again, so many periods later."""
    return replace(FIRST, stamp_ns=FIRST.stamp_ns + k * DT_NS, ranges=FIRST.ranges.copy())


@pytest.mark.parametrize("turn", [0.1, -0.1])
def test_a_turn_is_a_motion(turn: float) -> None:
    """Also across the end of the circle."""
    found = Repeats()
    found.takes(FIRST, np.array([0.0, 0.0, np.pi]), measured=True)
    found.located(np.array([0.0, 0.0, np.pi]))
    again = replace(FIRST, stamp_ns=2 * DT_NS)
    assert found.takes(again, np.array([0.0, 0.0, turn - np.pi]), measured=True)
    assert found.takes(replace(again, stamp_ns=3 * DT_NS), np.array([0.0, 0.0, turn - np.pi]), measured=True)


def test_one_other_beam_makes_it_another_scan() -> None:
    """So does another number of beams. The clock set back is no motion."""
    found = Repeats()
    found.takes(FIRST, np.zeros(3), measured=True)
    moved = np.array([1.0, 0.0, 0.0])
    other = replace(FIRST, stamp_ns=2 * DT_NS, ranges=FIRST.ranges + np.float32([0, 0, 0, 0.001]))
    assert not found.takes(other, moved, measured=True)
    assert not found.takes(replace(other, ranges=other.ranges[:-1]), 2 * moved, measured=True)
    assert not found.takes(replace(other, stamp_ns=0, ranges=other.ranges[:-1]), 3 * moved, measured=True)
