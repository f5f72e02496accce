"""Whether sensors measure one motion: gravity by the accelerometer, and the same turn by several sensors."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slam_core.measurements import Float64s

UP_WINDOW = 0.5  # s: the specific force averaged over this shows where up is
TURN_SPAN = 0.5  # s: turns are compared over spans of this length
TILT_SPAN = 0.2  # s: accelerations of the drive wash out longer changes of tilt
LAG_STEP = 0.01  # s
LAGS = 50  # steps that are tried to either side
LONGEST_LAG = LAGS * LAG_STEP
# Spans this many times further off than half of them are left out, again and again: there a match has jumped.
OUTLYING, ROUNDS = 5.0, 4


@dataclass(frozen=True, slots=True, eq=False)
class Gravity:
    """The specific force over a whole recording: its median norm, its mean direction (3,) and how steady that is.

    steadiness: length of the mean of the directions; 1 if they are all one.
    """

    norm: float
    up: Float64s
    steadiness: float


@dataclass(frozen=True, slots=True)
class Agreement:
    """How one account of a turn follows another, the reference.

    correlation: over the spans that agree, after the lag is taken out. ratio: there, its angles over those of the
    reference. lag: seconds by which the reference is stamped late; explained: the share of the disagreement over
    all spans that it explains.
    spans: how many, without overlap. moved: root mean square of the reference's change in a span, radians.
    """

    correlation: float
    ratio: float
    lag: float
    explained: float
    spans: int
    moved: float


def gravity(forces: Float64s) -> Gravity:
    """Of specific forces (n, 3) in any unit; a device that gives none shows zeros, from no direction."""
    norms = np.linalg.norm(forces, axis=1)
    mean = (forces / np.maximum(norms, 1e-9)[:, None]).mean(axis=0)
    steadiness = float(np.linalg.norm(mean))
    return Gravity(float(np.median(norms)), mean / max(steadiness, 1e-9), steadiness)


def yaw_rates(times: Float64s, rates: Float64s, forces: Float64s) -> Float64s:
    """(n,) rate of turn about the vertical that the forces show, whichever way up the device is mounted."""
    up = _box_mean(times, forces, UP_WINDOW)
    norms = np.maximum(np.linalg.norm(up, axis=1), 1e-9)
    turning: Float64s = np.sum(rates * up, axis=1) / norms
    return turning


def compare_turns(times: Float64s, yaw: Float64s, rate_times: Float64s, rates: Float64s) -> Agreement | None:
    """Rates (m,) of turn against headings (n,), unwrapped, NaN where unknown; None if too little is common."""
    angle = _integral(rate_times, rates[:, None])[:, 0]
    begin, end = _spans(times, yaw, rate_times[0] + LONGEST_LAG, rate_times[-1] - LONGEST_LAG)
    if len(begin) < 3:
        return None
    turned = yaw[end] - yaw[begin]

    def shifted(lag: float) -> Float64s:
        late: Float64s = np.interp(times[end] - lag, rate_times, angle)
        return late - np.interp(times[begin] - lag, rate_times, angle)

    lags = LAG_STEP * np.arange(-LAGS, LAGS + 1)
    measured = np.array([shifted(lag) for lag in lags])
    kept = np.ones(len(turned), np.bool_)
    for _ in range(ROUNDS):
        scores = [_correlation(turned[kept], late[kept]) for late in measured]
        best = int(np.argmax(np.abs(scores)))
        ratio = _ratio(turned[kept], measured[best, kept])
        off = measured[best] - math.copysign(ratio, scores[best]) * turned
        off = np.abs(off - np.median(off))
        kept = off <= OUTLYING * np.median(off)
    at_best, at_none = _correlation(turned, measured[best]), _correlation(turned, measured[LAGS])
    return Agreement(
        correlation=scores[best],
        ratio=ratio,
        lag=float(lags[best]),
        explained=1.0 - (1.0 - at_best**2) / max(1.0 - at_none**2, 1e-12),
        spans=int(len(turned) * min(1.0, float(np.median(np.diff(times))) / TURN_SPAN)),
        moved=float(np.sqrt(np.mean(turned**2))),
    )


def _spans(times: Float64s, yaw: Float64s, first: float, last: float) -> tuple[NDArray[np.int64], ...]:
    """Indices where the spans of turning begin and end: between `first` and `last`, with both headings known."""
    after = np.searchsorted(times, times + TURN_SPAN)
    begin = np.flatnonzero((times > first) & (times + TURN_SPAN < last) & (after < len(times)))
    known = np.isfinite(yaw[begin]) & np.isfinite(yaw[after[begin]])
    return begin[known], after[begin[known]]


def compare_tilts(times: Float64s, rates: Float64s, forces: Float64s) -> Agreement | None:
    """Rates (n, 3) against the way in which gravity moves through the device: n' = -omega x n."""
    if len(times) < 2:
        return None
    begin = np.arange(times[0] + TILT_SPAN, times[-1] - 2.0 * TILT_SPAN, TILT_SPAN)
    if len(begin) < 3:
        return None
    angle = _integral(times, rates)
    turn = _at(begin + TILT_SPAN, times, angle) - _at(begin, times, angle)
    up = _box_mean(times, forces, TILT_SPAN)
    up /= np.maximum(np.linalg.norm(up, axis=1, keepdims=True), 1e-9)
    first, last = _at(begin, times, up), _at(begin + TILT_SPAN, times, up)
    seen, measured = (last - first).ravel(), -np.cross(turn, 0.5 * (first + last)).ravel()
    score = _correlation(seen, measured)
    moved = float(np.sqrt(3.0 * np.mean(seen**2)))
    return Agreement(score, _ratio(seen, measured), 0.0, 0.0, len(begin), moved)


def _correlation(a: Float64s, b: Float64s) -> float:
    """Without the means: a bias of the gyroscope does not count."""
    a, b = a - a.mean(), b - b.mean()
    return float(np.sum(a * b) / max(np.sqrt(np.sum(a * a) * np.sum(b * b)), 1e-12))


def _ratio(a: Float64s, b: Float64s) -> float:
    """Of the spreads: a regression would shrink it by the noise in `a`."""
    return float(np.std(b) / max(float(np.std(a)), 1e-12))


def _integral(times: Float64s, values: Float64s) -> Float64s:
    """(n, k) from 0 on, by trapezoids."""
    steps = 0.5 * (values[1:] + values[:-1]) * np.diff(times)[:, None]
    return np.concatenate([np.zeros((1, values.shape[1])), np.cumsum(steps, axis=0)])


def _box_mean(times: Float64s, values: Float64s, window: float) -> Float64s:
    """(n, k) means over `window` seconds around each instant, shorter at the ends."""
    total = _integral(times, values)
    before, after = np.maximum(times - window / 2, times[0]), np.minimum(times + window / 2, times[-1])
    width = np.maximum(after - before, 1e-9)[:, None]
    mean: Float64s = (_at(after, times, total) - _at(before, times, total)) / width
    return mean


def _at(instants: Float64s, times: Float64s, values: Float64s) -> Float64s:
    return np.column_stack([np.interp(instants, times, column) for column in values.T])
