"""The noise of a laser's ranges, as its scans show it.

On a straight wall at distance d and bearing w the inverse range of a beam at angle a is cos(a - w) / d. So it is
linear in the cosine and the sine of a, and its second difference over the beams is next to nothing.

A range is `valid` from a lower limit to below an upper one; the rest is not looked at. Noise is told apart by the
range, in BANDS half an octave wide, (BANDS,) standard deviations in metres; below 0 while it is not known.
"""

import math

import numpy as np
from numba import njit

from slam_core.kernels import INNER
from slam_core.measurements import Float32s, Float64s

BANDS, NEAREST = 16, 0.25  # metres: where the first band begins
FEWEST, ENOUGH = 30, 500  # beams that tell the noise of a band, and of them all
# A scan may hold what looks like noise, but nothing that looks like less: estimates fall faster than they rise,
# and settle at the noise over LOW.
FALL, RISE, LOW = 0.2, 0.02, 1.15
QUARTER = 0.3186  # standard deviations: below which a quarter of what is normally distributed is in size
# Noise grows from band to band by no more than that of a laser that measures by triangulation, as the square of
# the range; from what whole centimetres hide on (m).
STEEPEST, LEAST = 2.0, 0.002


@njit(**INNER)
def band(r: float) -> int:
    """Of a range, which is above 0."""
    return int(min(max(2.0 * math.log2(r / NEAREST), 0.0), BANDS - 1.0))


@njit(cache=True, error_model="numpy")
def learn_noise(
    ranges: Float32s, before: Float32s, limits: tuple[float, float], estimates: Float64s, noise: Float64s
) -> None:
    """Take a scan and the one before, (n,) and (n,), into the estimates (BANDS,), and these into the noise.

    The second differences in a scan show at least the noise, and so do those of what changed since the one before:
    things that are not straight, and a robot that turns, only add to them. The lesser one counts, by the beams in
    which it is least.
    """
    (low, high), n = limits, len(ranges)
    apart = 1 + n // ENOUGH
    counts, sizes = np.zeros(BANDS, np.int64), np.empty((2, BANDS, n // apart + 1))
    for i in range(1, n - 1, apart):
        valid = True
        for j in range(i - 1, i + 2):
            valid &= low <= ranges[j] < high and low <= before[j] < high
        if valid:
            r = float(ranges[i])
            now, then = _second_difference(ranges, i), _second_difference(before, i)
            k = band(r)
            sizes[0, k, counts[k]], sizes[1, k, counts[k]] = abs(now) * r * r, abs(now - then) * r * r
            counts[k] += 1
    for k in range(BANDS):
        if counts[k] < FEWEST:
            continue
        within, since = _deviation(sizes[0, k, : counts[k]]), _deviation(sizes[1, k, : counts[k]])
        found = min(within / math.sqrt(6.0), since / math.sqrt(12.0))
        share = 1.0 if estimates[k] < 0.0 else FALL if found < estimates[k] else RISE
        estimates[k] += share * (found - estimates[k])
    most = math.inf
    for k in range(BANDS):
        noise[k] = min(LOW * estimates[k], most) if estimates[k] >= 0.0 else -1.0
        most = STEEPEST * (max(noise[k], LEAST) if estimates[k] >= 0.0 else most)


@njit(**INNER)
def _deviation(sizes: Float64s) -> float:
    """The standard deviation of values by their sizes (n,); of a part that has more of it the least."""
    return float(np.sort(sizes)[len(sizes) // 4]) / QUARTER


@njit(**INNER)
def _second_difference(ranges: Float32s, i: int) -> float:
    """Of the inverse range at beam i."""
    return 1.0 / float(ranges[i - 1]) - 2.0 / float(ranges[i]) + 1.0 / float(ranges[i + 1])
