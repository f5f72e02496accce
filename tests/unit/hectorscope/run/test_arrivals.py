"""Faults of the stamps: late data, scans that stop, clocks that are set."""

from collections.abc import Iterable

import numpy as np

from hectorscope.run.arrivals import Arrival, Arrivals
from slam_core.measurements import Height, Imu, LaserScan, Measurement

S = 1_000_000_000
STOPPED, CLOCK_SET = Arrival("scans_stopped"), Arrival("laser_clock_set")


def imu(t: float) -> Imu:
    return Imu(round(t * S), np.zeros(3), np.zeros(3))


def scan(t: float) -> LaserScan:
    """It ends 20 ms after it began."""
    return LaserScan(round(t * S), np.ones(21, np.float32), 0.0, 0.1, time_increment=1e-3)


def faults(arriving: Iterable[Measurement]) -> tuple[Arrival, ...]:
    """The faults after the last measurement."""
    arrivals = Arrivals()
    for measurement in arriving:
        arrivals.add(measurement)
    return arrivals.faults


def steady(begin: float, end: float) -> list[Measurement]:
    """Inertial data at 100 Hz and scans at 10 Hz that arrive when their sweep ends."""
    times = np.arange(round(begin * 100), round(end * 100)) / 100
    return [item for t in times for item in ([imu(t), scan(t - 0.02)] if round(t * 100) % 10 == 0 else [imu(t)])]


def test_data_in_time_has_no_fault() -> None:
    """A steady flow has no fault, nor has an empty one."""
    assert faults([]) == faults(steady(0, 3)) == ()


def test_three_late_measurements_in_a_row_are_a_fault() -> None:
    """Two heights that are 0.2 s late are jitter; three are a fault, for some seconds after the last."""
    late: list[Measurement] = [Height(round((2.8 + k / 1000) * S), 0.0) for k in range(3)]
    assert faults([*steady(0, 3), *late[:2]]) == ()
    assert faults([*steady(0, 3), *late]) == (Arrival("late", "heights"),)
    assert faults([*steady(0, 3), *late, *steady(3, 9)]) == ()


def test_scans_that_stop_are_a_fault_before_they_come_back() -> None:
    """While only inertial data comes, and for some seconds once scans come again."""
    gap: list[Measurement] = [imu(t / 100) for t in range(300, 450)]
    assert faults([*steady(0, 3), *gap]) == (STOPPED,)
    assert faults([*steady(0, 3), *gap, *steady(4.5, 6)]) == (STOPPED,)
    assert faults([*steady(0, 3), *gap, *steady(4.5, 12)]) == ()


def test_a_clock_that_is_set_is_not_a_pause() -> None:
    """An hour ahead or back: the laser's clock was set, and nothing counts as late because of that."""
    assert faults([*steady(5000, 5003), *steady(8603, 8605)]) == (CLOCK_SET,)
    assert faults([*steady(5000, 5003), *steady(1403, 1405)]) == (CLOCK_SET,)


def test_one_stamp_from_the_future_makes_nothing_late() -> None:
    """What follows is measured against the clock of the others again."""
    assert faults([*steady(5000, 5003), imu(9999.0), *steady(5003, 5006)]) == ()
