"""Scans that something held up and that came together, stamped on arrival: put back to when they were measured."""

from collections import deque
from dataclasses import replace

import numpy as np

from slam_core.diagnostics import Diagnostic, Recent
from slam_core.measurements import LaserScan

INTERVALS = 40  # between scans, whose mean is the period of the laser
FEWEST = 10  # of them, before anything is judged
LONGEST_NS = 1_000_000_000  # a pause counts as this much
# In periods: a scan comes late after a longer interval than LATE, together with the one before within SOON.
LATE, SOON = 1.5, 0.25
SWEEP = 0.8  # of its sweep: a laser does not begin the next one within it
MOST = 1000  # scans of a batch


class Batches:
    """Holds scans that come late until it is known which of them came together.

    A laser measures at a steady rate. Of a batch the last scan was measured at its stamp, and each of those before
    it one period before the next, but after what was measured before the batch.
    """

    def __init__(self) -> None:
        self._held: list[LaserScan] = []
        self._before_ns: int | None = None
        self._intervals: deque[int] = deque(maxlen=INTERVALS)
        self._recent: Recent[Diagnostic] = Recent()

    def push(self, scan: LaserScan) -> list[LaserScan]:
        """The scans whose times are known now that one more has arrived, in order."""
        if self._held and len(self._held) < MOST and self._came_with(self._held[-1], scan):
            self._held.append(scan)
            return []
        settled = self.flush()
        self._held.append(scan)
        return settled if self._is_late(scan) else settled + self.flush()

    def pass_time(self, time_ns: int) -> list[LaserScan]:
        """The scans whose times are known now that something else of this time has arrived."""
        return self.flush() if self._held and time_ns - self._held[-1].stamp_ns > self._soon_ns else []

    def flush(self) -> list[LaserScan]:
        """What is held, at its times."""
        held, self._held = self._held, []
        if len(held) > 1:
            held = self._put_back(held)
            self._recent.add([Diagnostic("scans_together")], held[-1].stamp_ns)
        for scan in held:
            if self._before_ns is not None:
                self._intervals.append(min(max(0, scan.stamp_ns - self._before_ns), LONGEST_NS))
            self._before_ns = scan.stamp_ns
        return held

    def diagnostics(self, time_ns: int) -> tuple[Diagnostic, ...]:
        """Whether scans came together at a time, or a moment before."""
        return self._recent.at(time_ns)

    def _put_back(self, batch: list[LaserScan]) -> list[LaserScan]:
        last_ns, n = max(scan.stamp_ns for scan in batch), len(batch)
        period_ns = self._period_ns
        if self._before_ns is not None:
            period_ns = min(period_ns, (last_ns - self._before_ns) // n)
        return [replace(scan, stamp_ns=last_ns - (n - 1 - i) * period_ns) for i, scan in enumerate(batch)]

    @property
    def _period_ns(self) -> int:
        return sum(self._intervals) // len(self._intervals)

    @property
    def _soon_ns(self) -> float:
        return SOON * self._period_ns

    def _is_late(self, scan: LaserScan) -> bool:
        if self._before_ns is None or len(self._intervals) < FEWEST:
            return False
        return scan.stamp_ns - self._before_ns > LATE * self._period_ns

    def _came_with(self, one: LaserScan, other: LaserScan) -> bool:
        """Whether one laser cannot have measured both when their stamps say."""
        sweep_ns = one.end_ns - one.stamp_ns
        soon_ns = min(self._soon_ns, SWEEP * sweep_ns) if sweep_ns else self._soon_ns
        if not 0 < abs(other.stamp_ns - one.stamp_ns) < soon_ns:
            return False
        mounts = one.T_base_laser, other.T_base_laser  # a second laser measures when it likes
        return mounts[0] is mounts[1] or all(
            np.array_equal(getattr(mounts[0], part), getattr(mounts[1], part))
            for part in ("translation", "rotation")
        )
