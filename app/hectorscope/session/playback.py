"""When the next scan is due: recording time paced by a monotonic clock."""

import math
import time
from collections import deque
from collections.abc import Callable

Clock = Callable[[], float]

# A machine that cannot keep up falls behind by no more than this: the lag is forgiven, not caught up in a rush.
FORGIVEN_S = 0.25
WINDOW_S = 2.0
ON_OFFER = (0.1, 0.25, 0.5, 1.0, 2.0, 5.0, 10.0, math.inf)  # times real time


def nearest_speed(speed: float) -> float:
    """Of those on offer."""
    if math.isinf(speed):
        return speed
    return min(ON_OFFER[:-1], key=lambda offered: abs(math.log(offered / max(speed, 1e-3))))


def changed_speed(speed: float, notches: int) -> float:
    """So many notches faster among those on offer, or slower; the first and the last are the ends."""
    at = ON_OFFER.index(nearest_speed(speed)) + notches
    return ON_OFFER[min(max(at, 0), len(ON_OFFER) - 1)]


class Pacer:
    """How long to wait for a scan at the present speed. clock: seconds, monotonic."""

    def __init__(self, speed: float = 1.0, clock: Clock = time.monotonic) -> None:
        self._clock = clock
        self._speed = speed
        self._anchor: tuple[float, int] | None = None  # a wall time and the recording time that belongs to it

    @property
    def speed(self) -> float:
        """Times real time; inf does not wait at all."""
        return self._speed

    @speed.setter
    def speed(self, speed: float) -> None:
        if self._anchor is not None:
            self._anchor = (self._clock(), self._now_ns()) if math.isfinite(self._speed) else None
        self._speed = speed

    def _now_ns(self) -> int:
        assert self._anchor is not None
        wall, recorded_ns = self._anchor
        return recorded_ns + round((self._clock() - wall) * self._speed * 1e9)

    def rest(self) -> None:
        """Let the clock stand: the next scan asked for is due at once, and time runs on from it."""
        self._anchor = None

    def delay(self, stamp_ns: int) -> float:
        """Seconds until the scan of this time is due; 0 when it is."""
        if math.isinf(self._speed):
            self._anchor = None
            return 0.0
        if self._anchor is None:
            self._anchor = (self._clock(), stamp_ns)
        ahead = (stamp_ns - self._now_ns()) / 1e9 / self._speed
        if ahead < -FORGIVEN_S:
            self._anchor = (self._clock(), stamp_ns)
        return max(0.0, ahead)


class RateMeter:
    """How fast scans go by, over the last seconds of wall time."""

    def __init__(self, clock: Clock = time.monotonic) -> None:
        self._clock = clock
        self._seen: deque[tuple[float, int]] = deque()

    def reset(self) -> None:
        """Forget: what follows does not belong to what came before."""
        self._seen.clear()

    def count(self, stamp_ns: int) -> None:
        """A scan of this time was processed now."""
        self._seen.append((self._clock(), stamp_ns))
        self._forget()

    def _forget(self) -> None:
        oldest = self._clock() - WINDOW_S
        while self._seen and self._seen[0][0] < oldest:
            self._seen.popleft()

    @property
    def realtime_factor(self) -> float:
        """Recording seconds a second; 0 while nothing happens."""
        self._forget()
        if len(self._seen) < 2:
            return 0.0
        (wall, first_ns), (_, last_ns) = self._seen[0], self._seen[-1]
        return max(0.0, (last_ns - first_ns) / 1e9 / max(1e-9, self._clock() - wall))

    @property
    def scan_rate(self) -> float:
        """Scans in a second of the recording."""
        self._forget()
        if len(self._seen) < 2 or self._seen[-1][1] <= self._seen[0][1]:
            return 0.0
        return (len(self._seen) - 1) / ((self._seen[-1][1] - self._seen[0][1]) / 1e9)
