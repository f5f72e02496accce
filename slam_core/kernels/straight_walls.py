"""Ranges smoothed along the straight wall on which their neighbours lie; noise and bands as in `.range_noise`.

On a straight wall at distance d and bearing w the inverse range of a beam at angle a is cos(a - w) / d: linear in
the cosine and the sine of a.
"""

import math

import numpy as np
from numba import njit

from slam_core.kernels import INNER
from slam_core.kernels.range_noise import band
from slam_core.measurements import Float32s, Float64s

MOST = 0.05  # of a range: what scatters by more is structure
FEW = 10  # one beam in so many with much noise does no harm
LONGEST, WIDEST = 32, 1.5  # beams to each side, and metres from the first to the last of all: a wall has doors
# Beams lie on one wall if they are off it by no more than noise: the mean square of that, in parts of the noise,
# and the gain by a second wall that begins at a quarter, the middle or three quarters (chi-square of 2).
STRAIGHT, CORNER = 1.4, 9.0
FAR_OFF = 3.0  # standard deviations from that wall: it is another one


@njit(cache=True, error_model="numpy")
def smooth(
    ranges: Float32s,
    directions: tuple[Float64s, Float64s],
    limits: tuple[float, float],
    noise: Float64s,
    least: float,
    wanted: float,
) -> Float32s:
    """Ranges (n,), each with more noise than `least` as the wall has it that its neighbours lie on.

    directions: cosines and sines (n,) of the beams. wanted: the noise in metres that is to be left. So many beams
    are used as make it that small, or as many as lie on a straight wall; if not even five do, a range stays as it
    is. A scan with few such ranges stays as it is, too.
    """
    low, high = limits
    out, sigmas, valid, noisy = ranges.copy(), np.zeros(len(ranges)), 0, 0
    for i in range(len(ranges)):
        if low <= ranges[i] < high:
            sigma = noise[band(ranges[i])]
            sigmas[i] = sigma if sigma <= MOST * ranges[i] else 0.0
            valid += 1
            noisy += sigmas[i] > least
    if noisy * FEW < valid:
        return out
    sums = _sums(ranges, directions, limits, sigmas)
    for i in range(len(ranges)):
        half, found = min(LONGEST, math.ceil(0.5 * (sigmas[i] / wanted) ** 2)) if sigmas[i] > least else 0, 0.0
        while half >= 2 and found == 0.0:
            found = _on_wall(i, half, sums, ranges, directions, sigmas[i])
            half //= 2
        if found > 0.0:
            out[i] = found
    return out


@njit(**INNER)
def _sums(ranges, directions, limits, sigmas):
    """(n + 1, 7) sums over all beams before one: of what `_line` needs, weighted, and how many are valid."""
    (cosines, sines), (low, high), n = directions, limits, len(ranges)
    sums = np.zeros((n + 1, 7))
    for i in range(n):
        row, r = sums[i + 1], float(ranges[i])
        row[:] = sums[i]
        if low <= r < high:
            x, y, u = cosines[i], sines[i], 1.0 / r
            weight = (r * r / max(sigmas[i], 1e-3)) ** 2  # of an inverse range
            row[0] += weight * x * x
            row[1] += weight * x * y
            row[2] += weight * y * y
            row[3] += weight * x * u
            row[4] += weight * y * u
            row[5] += weight * u * u
            row[6] += 1.0
    return sums


@njit(**INNER)
def _on_wall(i, half, sums, ranges, directions, sigma):
    """The range at which beam i meets the wall that it lies on with 2 half others; 0 if they lie on none.

    Those on both sides, or if these lie on no wall, on one side. sigma: the noise of the range of beam i.
    """
    (cosines, sines), r = directions, float(ranges[i])
    for begin in (i - half, i - 2 * half, i):
        end = begin + 2 * half + 1
        if begin < 0 or end >= len(sums):
            continue
        a, b = float(ranges[begin]), float(ranges[end - 1])
        width = math.hypot(a * cosines[begin] - b * cosines[end - 1], a * sines[begin] - b * sines[end - 1])
        cost, x, y, count = _line(sums, begin, end)
        u = x * cosines[i] + y * sines[i]
        most = STRAIGHT * (1.0 + 2.0 / math.sqrt(count)) * (count - 2.0)
        straight = width <= WIDEST and count > half + 1 and cost <= most
        if straight and u > 0.0 and abs(1.0 / u - r) < FAR_OFF * sigma:
            for quarter in range(1, 4):
                middle = begin + (2 * half + 1) * quarter // 4
                if 2 <= middle - begin <= 2 * half - 1:
                    straight &= cost - _line(sums, begin, middle)[0] - _line(sums, middle, end)[0] <= CORNER
            if straight:
                return 1.0 / u
    return 0.0


@njit(**INNER)
def _line(sums, begin, end):
    """The straight wall that fits beams from `begin` to before `end` best.

    What squares it leaves; its bearing's cosine and sine over its distance; how many beams there are.
    """
    xx, xy, yy = sums[end, 0] - sums[begin, 0], sums[end, 1] - sums[begin, 1], sums[end, 2] - sums[begin, 2]
    xu, yu, uu = sums[end, 3] - sums[begin, 3], sums[end, 4] - sums[begin, 4], sums[end, 5] - sums[begin, 5]
    count, det = sums[end, 6] - sums[begin, 6], xx * yy - xy * xy
    if not det > 1e-12 * xx * yy:
        return 0.0, 0.0, 0.0, count
    x, y = (xu * yy - yu * xy) / det, (yu * xx - xu * xy) / det
    return uu - x * xu - y * yu, x, y, count
