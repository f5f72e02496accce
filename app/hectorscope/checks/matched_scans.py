"""The scans of a source matched without its other sensors: how the robot turned, and when beams were measured."""

import numpy as np

from hectorscope.checks.beam_times import BeamTimes, TimedMap, best_times, durations
from hectorscope.run.warmup import warm_up
from slam_core.measurements import Float64s, LaserScan

PERIOD_NS = 70_000_000  # more scans a second add nothing about turns
FIRST = 21  # scans of the laser, that tell its period


class MatchedScans:
    """Takes scans, and matches them when it is asked what they show."""

    def __init__(self) -> None:
        self.scans: list[LaserScan] = []
        self._first: list[LaserScan] = []
        self._durations: tuple[float, ...] = ()
        self._maps: dict[float, TimedMap] = {}

    def add(self, scan: LaserScan) -> None:
        """One more; some are left out."""
        if not self.scans or scan.stamp_ns - self.scans[-1].stamp_ns >= PERIOD_NS:
            self.scans.append(scan)
        if len(self._first) < FIRST:
            self._first.append(scan)
            if len(self._first) == FIRST:
                self._durations = durations(self._first)
                self._maps.clear()

    @property
    def show_times(self) -> bool:
        """Whether the scans show when their beams are measured, once the robot turns."""
        return bool(self._durations)

    def times(self) -> BeamTimes | None:
        """What the scans so far show of it."""
        if not self.show_times:
            return None
        warm_up()
        return best_times(self._maps, self.scans, self._durations)

    def headings(self, begin_ns: int, sweep_s: float | None = None) -> Float64s:
        """(n, 2) seconds after `begin_ns` and heading, unwrapped; NaN where the pose was lost.

        sweep_s: of the sweeps, if they are not as stated.
        """
        warm_up()
        choice = self._durations or (0.0,)
        sweep_s = choice[0] if sweep_s is None else sweep_s
        if sweep_s not in self._maps:
            self._maps[sweep_s] = TimedMap(sweep_s, choice)
        made = self._maps[sweep_s].take(self.scans)
        headings = np.array([((time_ns - begin_ns) * 1e-9, psi) for time_ns, psi in made.headings]).reshape(-1, 2)
        known = np.isfinite(headings[:, 1])
        headings[known, 1] = np.unwrap(headings[known, 1])
        return headings
