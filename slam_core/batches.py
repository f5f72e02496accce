"""Measurements that came together, as something held them up, stamped on arrival: put back to their times."""

import math
from collections import deque
from dataclasses import replace
from typing import Generic, TypeVar

import numpy as np

from slam_core.diagnostics import Diagnostic, Recent
from slam_core.measurements import Float32s, Float64s, Imu, LaserScan

INTERVALS = 40  # between measurements, whose mean is the period of the sensor
FEWEST = 10  # of them, before anything is judged
LONGEST_NS = 1_000_000_000  # a pause counts as this much
# In periods: a measurement is late after a longer interval than LATE, and came with the one before within SOON.
LATE, SOON = 1.5, 0.25
SWEEP = 0.8  # of its sweep: a laser does not begin the next one within it
MOST = 1000  # measurements of a batch
WRONG_NS = 500_000_000  # by which what is held is ahead of the rest
TOLD_NS = 20_000_000  # what was put back by less is not worth a word

Sensed = TypeVar("Sensed", bound=LaserScan | Imu)
Array = Float32s | Float64s


class Batches(Generic[Sensed]):
    """Holds measurements of one sensor that come late until it is known which of them came together.

    A sensor measures at a steady rate. The last measurement of a batch was made at its stamp, and each of those
    before it one period before the next, but after what was made before the batch. source: for the diagnostic.
    """

    def __init__(self, source: str) -> None:
        self._source = source
        self._held: list[Sensed] = []
        self._before_ns: int | None = None
        self._intervals: deque[int] = deque(maxlen=INTERVALS)
        self._spanned_ns = 0  # their sum
        self._late_ns = math.inf  # from there on a measurement is late
        self._recent: Recent[Diagnostic] = Recent()

    def passes(self, one: Sensed) -> bool:
        """Take a measurement whose time is known at once, where none is held. Whether it is one."""
        if self._held or one.stamp_ns > self._late_ns:
            return False
        self._settle(one.stamp_ns)
        return True

    def push(self, one: Sensed) -> list[Sensed]:
        """The measurements whose times are known now that one more has arrived, in order."""
        if self._held and len(self._held) < MOST and self._came_with(self._held[-1], one):
            self._held.append(one)
            return []
        before = self.flush()
        if one.stamp_ns > self._late_ns:
            self._held.append(one)
            return before
        self._settle(one.stamp_ns)
        return [*before, one]

    def pass_time(self, time_ns: int) -> list[Sensed]:
        """The measurements whose times are known now that something else of this time has arrived.

        What is much earlier shows that the clock of those held is wrong: nothing would ever be later.
        """
        if not self._held:
            return []
        after_ns = time_ns - self._held[-1].stamp_ns
        return [] if -WRONG_NS < after_ns <= SOON * self._period_ns else self.flush()

    def flush(self) -> list[Sensed]:
        """What is held, at its times."""
        held, self._held = self._held, []
        if len(held) > 1:
            held = self._put_back(held)
        for one in held:
            self._settle(one.stamp_ns)
        return held

    def diagnostics(self, time_ns: int) -> tuple[Diagnostic, ...]:
        """Whether measurements came together at a time, or a moment before."""
        return self._recent.at(time_ns)

    def _settle(self, stamp_ns: int) -> None:
        """A measurement was made at this time: what the period is known by."""
        intervals = self._intervals
        if self._before_ns is not None:
            if len(intervals) == INTERVALS:
                self._spanned_ns -= intervals[0]
            interval_ns = stamp_ns - self._before_ns
            if not 0 <= interval_ns <= LONGEST_NS:
                interval_ns = 0 if interval_ns < 0 else LONGEST_NS
            intervals.append(interval_ns)
            self._spanned_ns += interval_ns
        self._before_ns = stamp_ns
        if len(intervals) >= FEWEST:
            self._late_ns = stamp_ns + LATE * (self._spanned_ns // len(intervals))

    def _put_back(self, batch: list[Sensed]) -> list[Sensed]:
        last_ns, n = max(one.stamp_ns for one in batch), len(batch)
        period_ns = self._period_ns
        if self._before_ns is not None:
            period_ns = min(period_ns, (last_ns - self._before_ns) // n)
        if batch[0].stamp_ns - last_ns + (n - 1) * period_ns > TOLD_NS:
            self._recent.add([Diagnostic("came_together", self._source)], last_ns)
        return [replace(one, stamp_ns=last_ns - (n - 1 - i) * period_ns) for i, one in enumerate(batch)]

    @property
    def _period_ns(self) -> int:
        return self._spanned_ns // max(1, len(self._intervals))

    def _came_with(self, one: Sensed, other: Sensed) -> bool:
        """Whether one sensor cannot have made both when their stamps say."""
        soon_ns = SOON * self._period_ns
        if isinstance(one, LaserScan) and one.end_ns > one.stamp_ns:
            soon_ns = min(soon_ns, SWEEP * (one.end_ns - one.stamp_ns))
        apart_ns = abs(other.stamp_ns - one.stamp_ns)
        if apart_ns >= soon_ns or not _one_laser(one, other):
            return False
        return not _alike(_values(one), _values(other))  # a driver sends a copy when it likes


def _one_laser(one: Sensed, other: Sensed) -> bool:
    """A second laser measures when it likes."""
    if not (isinstance(one, LaserScan) and isinstance(other, LaserScan)):
        return True
    return one.T_base_laser.is_same(other.T_base_laser)


def _values(one: Sensed) -> tuple[Array, ...]:
    return (one.ranges,) if isinstance(one, LaserScan) else (one.angular_velocity, one.linear_acceleration)


def _alike(some: tuple[Array, ...], others: tuple[Array, ...]) -> bool:
    return all(a is b or np.array_equal(a, b, equal_nan=True) for a, b in zip(some, others, strict=True))
