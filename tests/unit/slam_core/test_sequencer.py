"""Scans wait for the inertial data of their sweep, and for nothing else."""

import numpy as np
import pytest

from slam_core.measurements import Height, Imu, LaserScan
from slam_core.sequencer import MOST_WAITING, Sequencer

MS = 1_000_000


def imu(t):
    """An inertial sample at t milliseconds."""
    return Imu(round(t * MS), np.zeros(3), np.full(3, 1e-3 * t))


def scan(t, sweep=20):
    """A scan of 21 beams that begins at t milliseconds."""
    return LaserScan(t * MS, np.full(21, 1.0 + 1e-4 * t, np.float32), 0.0, 0.1, time_increment=sweep / 20 * 1e-3)


def test_a_scan_waits_until_its_sweep_is_covered():
    """It comes right behind the first inertial sample at or after its last ray."""
    s, first = Sequencer(), scan(5)
    assert len(s.push(imu(0))) == 1
    assert s.push(first) == []
    assert len(s.push(imu(10))) == 1
    assert len(s.push(imu(20))) == 1
    sample = imu(30)
    assert s.push(sample) == [sample, first]


def test_a_covered_scan_passes_at_once():
    """A scan that arrives after the inertial data of its sweep does not wait."""
    s, late = Sequencer(), scan(5)
    s.push(imu(40))
    assert s.push(late) == [late]


def test_the_order_of_arrival_between_channels_does_not_matter():
    """Whether the scan or the sample of the same time arrives first, the pipeline sees the same order."""
    first, sample = scan(5), imu(30)
    a, b = Sequencer(), Sequencer()
    begin = imu(0)
    a.push(begin), b.push(begin)
    ordered_a = a.push(first) + a.push(sample)
    ordered_b = b.push(sample) + b.push(first)
    assert ordered_a == ordered_b == [sample, first]


def test_without_inertial_data_scans_wait_half_a_second_once():
    """A laser-only recording loses nothing: the first scans are held, then all pass at once."""
    s = Sequencer()
    scans = [scan(100 * k) for k in range(12)]
    out = [s.push(x) for x in scans]
    assert out[0] == []
    released = [x for batch in out for x in batch]
    assert released == scans[: len(released)]
    assert out[-1] == [scans[-1]]


def test_scans_go_on_when_the_inertial_data_stops():
    """Half a second after the last sample the scans pass without it, and wait again when it is back."""
    s = Sequencer()
    s.push(imu(0))
    out = [x for k in range(20) for x in s.push(scan(100 * k))]
    assert len(out) == 20
    s.push(imu(2000))
    assert s.push(scan(2100)) == []


def test_everything_else_passes():
    """Heights and the like are never held."""
    s, height = Sequencer(), Height(5, 1.0)
    assert s.push(height) == [height]


def test_flush_gives_what_waits():
    """At the end of a recording no scan is lost."""
    s, last = Sequencer(), scan(5)
    s.push(imu(0))
    s.push(last)
    assert s.flush() == [last]
    assert s.flush() == []


def test_scans_whose_stamps_do_not_count_time_wait_no_longer() -> None:
    """Of one constant stamp no later one tells that no inertial data comes."""
    sequencer = Sequencer()
    passed = [each for _ in range(2 * MOST_WAITING) for each in sequencer.push(scan(1.0))]
    assert len(passed) == MOST_WAITING


def test_a_scan_after_a_pause_waits_for_what_may_come_with_it() -> None:
    """Inertial data of a moment later shows that nothing does; at the end of a recording it waits no longer."""
    s = Sequencer()
    for t in range(0, 1200, 10):
        s.push(imu(t))
        if t % 50 == 0 and t < 1000:
            s.push(scan(t, sweep=0))
    late = scan(1199, sweep=0)
    assert s.push(late) == []
    sample, after = imu(1205), imu(1215)
    assert s.push(sample) == []
    assert s.push(after) == [sample, late, after]
    sample, late = imu(1500), scan(1502, sweep=0)
    assert s.push(sample) + s.push(late) == []
    assert s.flush() == [sample, late]


def test_inertial_data_that_came_together_gets_its_own_times() -> None:
    """By these it covers a scan that waits."""
    s = Sequencer()
    for t in range(0, 500, 10):
        s.push(imu(t))
    first = scan(495)
    assert s.push(first) == []
    assert [s.push(imu(528 + 0.1 * k)) for k in range(4)] == [[]] * 4
    out = s.push(imu(540))
    assert [each.stamp_ns / MS for each in out] == pytest.approx([499.575, 509.15, 518.725, 495, 528.3, 540])


def test_scans_that_came_together_get_their_own_times() -> None:
    """In the order in which they came, the last one at its stamp; that is told."""
    s = Sequencer()
    for t in range(0, 1000, 50):
        s.push(scan(t, sweep=0))
    s.push(scan(1199, sweep=0))
    s.push(scan(1200, sweep=0))
    assert [each.stamp_ns for each in s.push(imu(1300))[:-1]] == [1150 * MS, 1200 * MS]
    assert [each.code for each in s.diagnostics(1300 * MS)] == ["came_together"]


def test_what_comes_while_inertial_data_is_held_stays_behind_it() -> None:
    """A gap in the data changes nothing in the order: the filter judges leaps of the time by it."""
    s = Sequencer()
    for t in range(0, 500, 10):
        s.push(imu(t))
    first, second, height, later = imu(3000), imu(3010), Height(3001 * MS, 1.0), Height(3020 * MS, 1.0)
    assert s.push(first) + s.push(height) == []
    assert s.push(second) == [first, height, second]
    assert s.push(imu(9000)) == []
    assert [type(each) for each in s.push(later)] == [Imu, Height]


def test_what_comes_while_a_scan_is_held_stays_behind_it() -> None:
    """Wheels of a robot without inertial data move it no further than they had when the scan came."""
    s = Sequencer()
    for t in range(0, 1000, 50):
        s.push(scan(t, sweep=0))
    held, height, next_one = scan(1200, sweep=0), Height(1200 * MS, 1.0), scan(1250, sweep=0)
    assert s.push(held) + s.push(height) == []
    assert s.push(next_one) == [held, height, next_one]


def test_inertial_data_that_stops_at_a_wrong_time_holds_nothing_up() -> None:
    """Nothing that comes is later than its last sample, and none of it is held for ever."""
    s = Sequencer()
    for t in range(0, 500, 10):
        s.push(imu(t))
    s.push(imu(10**7))
    passed = [each for k in range(3 * MOST_WAITING) for each in s.push(Height((500 + k) * MS, 1.0))]
    assert len(passed) == 1 + 3 * MOST_WAITING
