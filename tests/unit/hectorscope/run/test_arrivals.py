"""What arrives late, stops, or comes by another clock is told by the stamps alone."""

from collections.abc import Iterable

import numpy as np

from hectorscope.run.arrivals import SET, STOPPED, Arrivals
from slam_core.measurements import Height, Imu, LaserScan, Measurement

S = 1_000_000_000


def imu(t: float) -> Imu:
    return Imu(round(t * S), np.zeros(3), np.zeros(3))


def scan(t: float) -> LaserScan:
    """It ends 20 ms after it began."""
    return LaserScan(round(t * S), np.ones(21, np.float32), 0.0, 0.1, time_increment=1e-3)


def told(arriving: Iterable[Measurement]) -> tuple[str, ...]:
    """The warnings in the end."""
    arrivals = Arrivals()
    for measurement in arriving:
        arrivals.take(measurement)
    return arrivals.warnings


def steady(begin: float, end: float) -> list[Measurement]:
    """Inertial data at 100 Hz and scans at 10 Hz that arrive when their sweep ends."""
    times = np.arange(round(begin * 100), round(end * 100)) / 100
    return [item for t in times for item in ([imu(t), scan(t - 0.02)] if round(t * 100) % 10 == 0 else [imu(t)])]


def test_what_comes_in_time_is_no_news() -> None:
    """Nothing is said of a steady flow, nor before anything came."""
    assert told([]) == told(steady(0, 3)) == ()


def test_a_single_late_one_is_jitter_and_a_row_of_them_is_not() -> None:
    """Two heights late by 0.2 s say nothing, three do; for some seconds after the last."""
    late: list[Measurement] = [Height(round((2.8 + k / 1000) * S), 0.0) for k in range(3)]
    assert told([*steady(0, 3), *late[:2]]) == ()
    (warning,) = told([*steady(0, 3), *late])
    assert warning.startswith("heights come over 0.15 s after data of the same time")
    assert told([*steady(0, 3), *late, *steady(3, 9)]) == ()


def test_scans_that_stop_are_missed_before_they_come_back() -> None:
    """While only inertial data comes, and for some seconds once scans come again."""
    gap: list[Measurement] = [imu(t / 100) for t in range(300, 450)]
    assert told([*steady(0, 3), *gap]) == (STOPPED,)
    assert told([*steady(0, 3), *gap, *steady(4.5, 6)]) == (STOPPED,)
    assert told([*steady(0, 3), *gap, *steady(4.5, 12)]) == ()


def test_a_clock_that_is_set_is_no_pause() -> None:
    """An hour ahead or back: the laser's clock was set, and nothing counts as late because of that."""
    assert told([*steady(5000, 5003), *steady(8603, 8605)]) == (SET,)
    assert told([*steady(5000, 5003), *steady(1403, 1405)]) == (SET,)


def test_one_stamp_from_the_future_makes_nothing_late() -> None:
    """What follows is measured against the clock of the others again."""
    assert told([*steady(5000, 5003), imu(9999.0), *steady(5003, 5006)]) == ()
