"""A look at every inertial sample, compiled as there may be a thousand a second.

A sample is (6,) rates in rad/s and forces in m/s², in `ImuBuffer` (8,) with its noise. A memory is kept from one
to the next. Its last two rows, `usual`, are those of rates and of forces: the mean step from sample to sample, how
many there were, and a leap.
"""

import math

import numpy as np
from numba import njit

from slam_core.kernels import INNER
from slam_core.measurements import Float64s

GOOD, BROKEN, CLIPPED, FROZEN, SHAKEN = range(5)
# No robot turns (rad/s) or accelerates (m/s²) like this: such a sample is broken.
FASTEST, HARDEST = 200.0, 2000.0
# A rate on one and the same value, the largest so far and above this, in so many samples: the end of the range.
LEAST_RANGE = 1.5  # rad/s
REPEATS = 3
# While a gyro is clipped the true rate is beyond its reading by an unknown amount.
CLIPPED_NOISE = 1.0  # rad/s/√Hz
# So many samples in a row that are the same, of a sensor whose noise told so many apart before: its driver sends
# the last one again. A simulation without noise sends the same at rest from the start.
SAME, TOLD_APART = 20, 200
# A leap is a step by more than this in rates (rad/s) or forces (m/s²) within so long (s), or by as much a second
# if it takes longer; and by so many times the mean step, which is that of about the last so many.
LEAP, WITHIN = (1.0, 10.0), 0.01
TIMES, MEAN_OF = 8.0, 100.0
# After a leap rates may be off by half of it, as far as the mean of two samples, and forces by all of it, as those
# of a base that is hit are clipped; for about so long (s). A share of the least leap is forgotten.
OFF, SHAKEN_TIME, FORGOTTEN = (0.5, 1.0), 0.02, 0.1


@njit(cache=True, error_model="numpy")
def check(
    rate: Float64s, force: Float64s, dt: float, gyro_range: float, hit: float, memory: Float64s, sample: Float64s
) -> int:
    """What a sample is. rate, force: (3,), which `sample` (8,) takes as those in `ImuBuffer`.

    dt: seconds since the last one. gyro_range: rad/s, 0 if not known. hit: rad/s by which the base may have
    turned besides since the last one. memory: (6, 4), of each axis the last rate, how often it came, its largest
    size, and the last force; then how often this sample came, how many were told apart, and whether the sensor has
    no noise; the leaps are those that are not yet forgotten.
    """
    sample[:3], sample[3:6] = rate, force
    if not is_possible(sample):
        return BROKEN
    shaken = _is_shaken(sample, memory, dt, hit)
    clipped, same, turns = False, True, False
    for i in range(3):
        same &= rate[i] == memory[i, 0] and force[i] == memory[i, 3]
        turns |= rate[i] != 0.0  # a gyro may send nothing else at rest
        memory[i, 3] = force[i]
        last, size = memory[i, 0], abs(rate[i])
        memory[i, 1] = memory[i, 1] + 1.0 if rate[i] == last else 1.0
        memory[i, 2] = max(memory[i, 2], size)
        memory[i, 0] = rate[i]
        stuck = memory[i, 1] >= REPEATS and size >= max(LEAST_RANGE, memory[i, 2])
        clipped |= stuck or (gyro_range > 0.0 and size >= 0.999 * gyro_range)
    if _sent_again(same, memory[3]) and turns:
        return FROZEN
    if clipped:
        sample[6] = max(sample[6], CLIPPED_NOISE**2)
        return CLIPPED
    return SHAKEN if shaken else GOOD


@njit(inline="always")
def _sent_again(same, seen):
    """Whether a sample, `same` as the one before or not, is one of many alike. seen: (4,), as in `check`."""
    seen[0] = seen[0] + 1.0 if same else 1.0
    seen[1] += not same
    if seen[0] < SAME:
        return False
    if seen[1] < TOLD_APART:
        seen[2] = 1.0
    return seen[2] == 0.0


@njit(**INNER)
def _is_shaken(sample: Float64s, memory: Float64s, dt: float, hit: float) -> bool:
    """Whether a sample leaps from the last one, or one did shortly before; it takes the noise of that.

    A base that is hit moves between two samples as neither shows, and its sensors ring or are clipped.
    """
    last, shaken = np.empty(6), False
    last[:3], last[3:] = memory[:3, 0], memory[:3, 3]
    for group in range(2):
        usual, least = memory[4 + group], FORGOTTEN * LEAP[group]
        step, leap = step_of(sample, last, group), usual[2]
        if leap > 0.0:
            leap *= math.exp(-dt / SHAKEN_TIME)
        if is_leap(step, usual, group, dt):
            leap = max(leap, step)
        if group == 0:
            leap = max(leap, hit)
        learn(step, usual)
        usual[2] = leap if leap > least else 0.0
        shaken |= leap > least
        sample[6 + group] = (OFF[group] * max(leap, least)) ** 2 * dt
    if not shaken:
        sample[6] = sample[7] = 0.0
    return shaken  # then no noise is 0, which tells that it is


@njit(**INNER)
def is_possible(sample: Float64s) -> bool:
    """Whether all values are numbers by which a robot can turn and accelerate."""
    possible = True
    for i in range(3):
        possible &= abs(sample[i]) < FASTEST and abs(sample[3 + i]) < HARDEST
    return possible


@njit(**INNER)
def step_of(sample: Float64s, other: Float64s, group: int) -> float:
    """The largest difference of two samples in rates, group 0, or in forces, group 1."""
    most = 0.0
    for i in range(3 * group, 3 * group + 3):
        most = max(most, abs(sample[i] - other[i]))
    return most


@njit(**INNER)
def is_leap(step: float, usual: Float64s, group: int, dt: float) -> bool:
    """Whether a step within `dt` seconds is a leap. usual: the row of the group."""
    count, mean = int(usual[1]), float(usual[0])
    return count > 0 and step > max(LEAP[group] * max(1.0, dt / WITHIN), TIMES * mean)


@njit(**INNER)
def learn(step: float, usual: Float64s) -> None:
    """Take a step into the mean; the first sample of all comes after none."""
    if usual[1] > 0.0:
        usual[0] += (step - usual[0]) / min(usual[1], MEAN_OF)
    usual[1] += 1.0


@njit(cache=True, error_model="numpy")
def moments(values: Float64s) -> Float64s:
    """(3, k) of every column of values (n, k): mean, variance, and half the mean square of the steps in it."""
    n, k = values.shape
    out = np.zeros((3, k))
    for i in range(n):
        for j in range(k):
            out[0, j] += values[i, j]
    for j in range(k):
        out[0, j] /= n
    for i in range(n):
        for j in range(k):
            off, step = values[i, j] - out[0, j], values[i, j] - values[max(i - 1, 0), j]
            out[1, j] += off * off
            out[2, j] += step * step
    for j in range(k):
        out[1, j] /= n
        out[2, j] = 0.5 * (out[2, j] / (n - 1))
    return out
