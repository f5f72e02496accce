"""Whether inertial samples are a spike, which only the next ones tell; samples and memory as in `.imu_check`."""

import numpy as np
from numba import njit

from slam_core.kernels.imu_check import TIMES, is_leap, is_possible, learn, step_of
from slam_core.measurements import Float64s

PASSED, WAITS, WERE_SPIKE = range(3)
LONGEST, MOST_WAITING = 0.045, 100  # seconds and samples of a spike


@njit(cache=True, error_model="numpy")
def spike(rate: Float64s, force: Float64s, dt: float, waiting: int, memory: Float64s) -> int:
    """Whether a sample, (3,) and (3,), may be of a spike and WAITS for the next ones, or has PASSED.

    Those that wait pass with it, unless it tells that they WERE_SPIKE. dt: seconds since the last that passed, 0
    if that tells nothing of this one. waiting: how many wait. memory: (4, 6), the last that passed, the last of
    all, and two rows `usual`.
    """
    passed, last, sample = memory[0], memory[1], np.empty(6)
    sample[:3], sample[3:] = rate, force
    possible, leaps, as_before = is_possible(sample), False, True
    if possible:  # else `check` drops it
        for group in range(2):
            step, usual = step_of(sample, passed, group), memory[2 + group]
            leaps |= is_leap(step, usual, group, dt)
            as_before &= step <= TIMES * usual[0]
            learn(step_of(sample, last, group), usual)
        last[:] = sample
    compared = possible and dt > 0.0
    if compared and leaps and (not waiting or (dt < LONGEST and waiting < MOST_WAITING)):
        return WAITS
    passed[:] = last
    # A base that is hit does not move as before at once.
    return WERE_SPIKE if waiting and compared and as_before else PASSED
