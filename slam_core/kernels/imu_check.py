"""A look at every inertial sample, compiled as there may be a thousand a second."""

import numpy as np
from numba import njit

from slam_core.measurements import Float64s

GOOD, BROKEN, CLIPPED, FROZEN = range(4)
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


@njit(cache=True, error_model="numpy")
def check(rate: Float64s, force: Float64s, memory: Float64s, gyro_range: float, sample: Float64s) -> int:
    """What a sample is. rate, force: (3,), which `sample` (7,) takes as those in `ImuBuffer`.

    memory: (4, 4), kept from one sample to the next: of each axis the last rate, how often it came, its largest
    size, and the last force; then how often this sample came, how many were told apart, and whether the sensor has
    no noise. gyro_range: rad/s, 0 if not known.
    """
    for i in range(3):
        sample[i], sample[3 + i] = rate[i], force[i]
        if not (abs(rate[i]) < FASTEST and abs(force[i]) < HARDEST):
            return BROKEN
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
    sample[6] = CLIPPED_NOISE**2 if clipped else 0.0
    if _sent_again(same, memory[3]) and turns:
        return FROZEN
    return CLIPPED if clipped else GOOD


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
