"""When the beams of a scan were measured: in what time a sweep is made, and which beam comes first.

A scan whose beams are taken to be measured at other times than they were is bent while the robot turns. So each
scan is matched with the map as if its sweep had taken other durations. A map made of bent scans suits such
scans, but not as well as a map of straight ones suits these: the map of the duration that suits best is made as
well.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

import numpy as np

from hectorscope.ros.repairs import with_sweep
from slam_core import geometry
from slam_core.config import MatcherConfig, ScanConfig, SlamConfig
from slam_core.matching.matcher import coarse_to_fine
from slam_core.measurements import Float64s, Int64s, LaserScan
from slam_core.results import StepResult
from slam_core.scan.stabilise import stabilise
from slam_core.slam import HectorSlam

SLOW_NS = 40_000_000  # a shorter sweep is bent less than by motions that a laser alone does not observe
TURNED = 0.03  # radians in the longest sweep: a smaller turn bends a scan too little
LONGEST_S = 1.5  # between the scans before and after one, from which its motion is taken
SHARES = (0.0, 0.25, -0.25, 0.5, -0.5, 0.75, -0.75, 1.0, -1.0)  # of the longest sweep, if no message tells it
FEWEST, BLOCK = 20, 5  # scans that tell anything; the residuals of neighbours are alike, those of blocks hardly
SURE = 3.5  # standard errors
CLEAR = 0.8  # of the other mean residual: a far smaller difference may be sure, and matters little
# Times the mean residual of its own duration: so badly another suits a map of straight scans, the other order or
# the next duration. Else the map of that is looked at, too.
PREFERRED, PREFERRED_SHARE = 1.4, 1.1
LEAST = 1e-9  # a mean residual above 0


@dataclass(frozen=True, slots=True)
class BeamTimes:
    """The duration of a sweep that suits best: seconds; negative: the last beam is the first; 0: all at once.

    stated_s: by the messages; 0 if they time no beams. residual: mean residual of scans while the robot turns, in
    the map of scans of this duration. other: the same as stated, or if that suits best by the next best duration.
    score: the difference in standard errors.
    """

    sweep_s: float
    stated_s: float
    residual: float
    other: float
    score: float

    @property
    def is_sure(self) -> bool:
        """Whether the scans fit so much better that it is no chance."""
        return self.score > SURE and self.residual < CLEAR * self.other

    @property
    def are_wrong(self) -> bool:
        """Whether the beams are surely measured at other times than stated."""
        return self.is_sure and self.sweep_s != self.stated_s


def durations(scans: Sequence[LaserScan]) -> tuple[float, ...]:
    """What a sweep may take, seconds, the stated duration first; none if they differ too little.

    Both orders of the beams if the messages time them, else shares of the time in which the laser turns so far: in
    the time from one scan to the next it makes a full circle at most. scans: some in a row.
    """
    first, stamps_ns = scans[0], [scan.stamp_ns for scan in scans]
    stated_s = 1e-9 * float(np.median([scan.end_ns - scan.stamp_ns for scan in scans]))
    circle = min(abs(first.angle_increment) * len(first.ranges) / (2.0 * np.pi), 1.0)
    longest_s = stated_s if first.time_increment else 1e-9 * circle * float(np.median(np.diff(stamps_ns)))
    if not longest_s * 1e9 >= SLOW_NS:
        return ()
    return (stated_s, -stated_s) if first.time_increment else tuple(share * longest_s for share in SHARES)


class TimedMap:
    """Takes scans as if their sweeps took a duration, and finds how well others suit its map.

    sweep_s: of `durations`, of which the first is the stated one. headings: nanoseconds and radians, NaN where the
    pose was not sure.
    """

    def __init__(self, sweep_s: float, durations: Sequence[float]) -> None:
        self.headings: list[tuple[int, float]] = []
        self._sweep_s, self._durations = sweep_s, durations
        self._slam = HectorSlam(SlamConfig())
        self._last: list[tuple[LaserScan, StepResult | None]] = []
        self._residuals: list[tuple[float, ...]] = []

    @property
    def residuals(self) -> Float64s:
        """(n, len(durations)) mean residuals of the scans while the robot turned."""
        return np.array(self._residuals).reshape(-1, len(self._durations))

    def take(self, scans: Sequence[LaserScan]) -> "TimedMap":
        """All scans so far; those that came since the last time are matched. Returns itself."""
        for scan in scans[len(self.headings) :]:
            timed = scan if self._sweep_s == self._durations[0] else with_sweep(scan, self._sweep_s)
            result = self._slam.step(timed)
            sure = result if result and result.verdict.undoubted else None
            self.headings.append((timed.mid_ns, float(sure.planar[2]) if sure else np.nan))
            self._last = [*self._last[-2:], (scan, sure)]
            residuals = tuple(self._as_swept())
            if residuals and np.isfinite(residuals).all():
                self._residuals.append(residuals)
        return self

    def _as_swept(self) -> Iterator[float]:
        """Mean residuals of the last scan but one by each duration, where the robot turned fast enough."""
        if len(self._last) < 3:
            return
        (_, before), (scan, at), (_, after) = self._last
        if before is None or at is None or after is None:
            return
        lapse_s = (after.stamp_ns - before.stamp_ns) * 1e-9
        if not 0.0 < lapse_s < LONGEST_S:
            return
        velocity = geometry.compose(geometry.inverse(before.planar), after.planar) / lapse_s
        if abs(velocity[2]) * max(self._durations) < TURNED:
            return
        turned = geometry.wrap(at.planar[2] - before.planar[2])
        c, s = np.cos(turned), np.sin(turned)
        velocity[:2] = c * velocity[0] + s * velocity[1], c * velocity[1] - s * velocity[0]
        motion = partial(_carried, at.stamp_ns, velocity)
        for sweep_s in self._durations:
            points = stabilise(centred(scan, at.stamp_ns, sweep_s), motion, ScanConfig()).points
            yield coarse_to_fine(self._slam.map, points, at.planar, MatcherConfig()).mean_residual


def centred(scan: LaserScan, middle_ns: int, sweep_s: float) -> LaserScan:
    """The scan with a sweep of so many seconds around a time."""
    return with_sweep(replace(scan, stamp_ns=middle_ns - round(0.5e9 * abs(sweep_s))), sweep_s)


def _carried(middle_ns: int, velocity: Float64s, from_ns: int, since_ns: Int64s) -> Float64s:
    """A `Motion` in the plane at a steady velocity (3,), m/s and rad/s, from the origin at a time."""
    seconds = (from_ns - middle_ns + since_ns) * 1e-9
    half, nothing = 0.5 * velocity[2] * seconds, np.zeros(len(seconds))
    attitude = (np.cos(half), nothing, nothing, np.sin(half))
    return np.column_stack([*attitude, velocity[0] * seconds, velocity[1] * seconds, nothing])


class _Suited(NamedTuple):
    """How well durations suit a map: residuals (n, m) as of `TimedMap`. own: that with which the map was made."""

    residuals: Float64s
    own: int

    @property
    def means(self) -> Float64s:
        """(m,) times the mean residual of its own."""
        means = self.residuals.mean(axis=0)
        return np.asarray(means / max(means[self.own], LEAST))

    @property
    def other(self) -> int:
        """The duration that suits best beside its own."""
        return int(np.where(np.arange(len(self.means)) == self.own, np.inf, self.means).argmin())

    def times(self, durations: Sequence[float]) -> BeamTimes:
        """Its own duration as the best one."""
        other = self.other if self.own == 0 else 0
        n = len(self.residuals) // BLOCK * BLOCK
        mine, theirs = self.residuals[:n, self.own], self.residuals[:n, other]
        differences = (theirs - mine).reshape(-1, BLOCK).mean(axis=1)
        error = float(differences.std(ddof=1)) / len(differences) ** 0.5
        score = float(differences.mean()) / error if error > 0.0 else 0.0
        return BeamTimes(durations[self.own], durations[0], float(mine.mean()), float(theirs.mean()), score)


def best_times(
    maps: dict[float, TimedMap], scans: Sequence[LaserScan], durations: Sequence[float]
) -> BeamTimes | None:
    """The duration whose scans suit its own map best, against the others; None while too few scans show it.

    maps: those made so far, by duration; those that may be needed again are left in it.
    """
    enough = PREFERRED if durations[0] else PREFERRED_SHARE
    found: dict[int, _Suited] = {}
    own = 0
    while own not in found:
        if durations[own] not in maps:
            maps[durations[own]] = TimedMap(durations[own], durations)
        made = maps[durations[own]].take(scans)
        if len(made.residuals) < FEWEST:
            return None
        suited = found[own] = _Suited(made.residuals, own)
        if suited.means[suited.other] < enough:
            own = suited.other
    best = max(found.values(), key=lambda each: each.means[each.other])
    for each in set(maps) - {durations[0], durations[best.own]}:
        del maps[each]
    return best.times(durations)
