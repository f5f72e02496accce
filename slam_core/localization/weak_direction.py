"""A direction that few beams fix, along which matches scatter: it counts as unobservable until more beams fix it.

In a plain corridor the noise of the walls may outweigh the few beams that tell how far the robot has come. Matches
jump to and fro then, by more than a robot accelerates, and are drawn back to where the map was written last, while
eq. (15) claims millimetres. The mean speed before is the better estimate.
"""

from collections import deque
from collections.abc import Sequence

import numpy as np

from slam_core.config import SlamConfig
from slam_core.localization.few_beams import few_as_none
from slam_core.measurements import Float64s
from slam_core.results import NOWHERE, MatchResult

WINDOW_NS = 600_000_000  # of the changes of the step that are looked at, and
LEAST = 5  # so many of them at least: a slow scanner never has them
SCATTER = 2.0  # times the usual change, and
ACCELERATION = 4.0  # m/s^2: more than a robot keeps changing its speed by
MEMORY = 0.05  # weight of the newest change in the running mean
USUAL = 0.02  # metres, before there is one
# Of the poses that give the mean speed: those since few beams fix the direction, within these limits.
SHORTEST_NS, LONGEST_NS = 1_000_000_000, 1_500_000_000
STEADY = 0.25  # m/s: a speed that changed by more in that time is no speed to keep
KEPT = 256  # changes and poses: a fast scanner has fewer in that time

Position = tuple[int, Float64s]  # nanoseconds, and (2,) metres in the map


class WeakDirection:
    """Of the matches of a run in which nothing but matches observes the motion.

    held: whether the direction counts as unobservable. direction: (2,) in the map; a unit vector. speed: m/s along
    it, the mean one before it was held.
    """

    def __init__(self) -> None:
        self.held = False
        self.direction = NOWHERE
        self.speed = 0.0
        self._usual = USUAL
        self._changes = deque[tuple[int, float]](maxlen=KEPT)
        self._positions = deque[Position](maxlen=KEPT)
        self._few_since_ns = 0

    def configured(self, config: SlamConfig) -> SlamConfig:
        """Settings of the next match: while the direction is held, few beams count as none."""
        return few_as_none(config) if self.held else config

    def begins(self, match: MatchResult, time_ns: int, lapse_ns: int) -> bool:
        """Take in a match. Whether its direction is held from now on.

        lapse_ns: since the scan before. After a gap, or if a clock was set back, all begins anew.
        """
        if not 0 < lapse_ns < SHORTEST_NS:
            self._changes.clear()
            self._positions.clear()
            self.held = False
        direction = match.weakest_direction  # its sign stays that of the match before
        self.direction = direction if float(direction @ self.direction) >= 0.0 else -direction
        change = self._change(match.pose[:2], time_ns)
        if not match.is_badly_fixed:
            self._usual += MEMORY * (abs(change) - self._usual)
            self._changes.clear()
            self._few_since_ns, self.held = time_ns, False
        elif not (self.held or match.leaves_direction):
            self._changes.append((time_ns, change))
            while self._changes[0][0] <= time_ns - WINDOW_NS:
                self._changes.popleft()
            self.held = self._scatter(lapse_ns * 1e-9) and self._is_steady()
            if self.held:
                self.speed = self._mean_speed(time_ns)
            return self.held
        return False

    def release(self) -> None:
        """Something tells the way again: matches have to scatter anew."""
        self.held = False
        self._changes.clear()

    def moved(self, time_ns: int, pose: Float64s) -> None:
        """Take in the pose (3,) that a scan was given."""
        self._positions.append((time_ns, pose[:2].copy()))
        while self._positions[0][0] < time_ns - LONGEST_NS:
            self._positions.popleft()

    def _change(self, position: Float64s, time_ns: int) -> float:
        """By how much the step to a position (2,) differs from the one before, along the direction, metres.

        It tells of the matches alone; an innovation depends on what the filter makes of them as well.
        """
        if len(self._positions) < 2:
            return 0.0
        (earlier_ns, earlier), (last_ns, last) = self._positions[-2], self._positions[-1]
        expected = (last - earlier) * ((time_ns - last_ns) / max(last_ns - earlier_ns, 1))
        return float((position - last - expected) @ self.direction)

    def _mean_speed(self, time_ns: int) -> float:
        """Along the direction, m/s, before a time."""
        longest_ns = max(time_ns - self._few_since_ns, SHORTEST_NS)
        return self._speed([each for each in self._positions if time_ns - each[0] <= longest_ns])

    def _scatter(self, dt: float) -> bool:
        """Whether steps have changed much for a time. dt: seconds between two scans."""
        span_ns = self._changes[-1][0] - self._changes[0][0]
        if len(self._changes) < LEAST or span_ns < 0.8 * WINDOW_NS:
            return False
        typical = float(np.median([abs(change) for _, change in self._changes]))
        return typical > max(SCATTER * self._usual, ACCELERATION * dt**2)

    def _is_steady(self) -> bool:
        """Whether the speed of the last poses is that of those before: the robot does not accelerate."""
        positions = list(self._positions)
        half = len(positions) // 2
        return half > 1 and abs(self._speed(positions[half:]) - self._speed(positions[:half])) < STEADY

    def _speed(self, positions: Sequence[Position]) -> float:
        """Slope of the straight line through positions (two at least) over time, along the direction."""
        times_ns, places = zip(*positions, strict=True)
        times = (np.array(times_ns) - times_ns[-1]) * 1e-9
        times -= times.mean()
        return float(times @ (np.array(places) @ self.direction) / max(float(times @ times), 1e-12))
