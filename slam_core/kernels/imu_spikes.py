"""Whether an inertial sample is a spike, which only the next one tells; samples and memory as in `.imu_check`."""

import numpy as np
from numba import njit

from slam_core.kernels.imu_check import is_leap, is_possible, learn, step_of
from slam_core.measurements import Float64s

PASSED, WAITS, FOLLOWED, WAS_SPIKE = 0, 1, 2, 4


@njit(cache=True, error_model="numpy")
def spike(rate: Float64s, force: Float64s, dt: float, memory: Float64s) -> int:
    """Whether a sample, (3,) and (3,), may be a spike and WAITS for the next one, or has PASSED.

    Added is what this one tells of the one that waited: FOLLOWED, or WAS_SPIKE. dt: seconds since the last
    that passed, 0 if that tells nothing of this one. memory: (5, 6), the last that passed, the one that waits,
    and the last of all; the leaps are whether the rates and the forces of the one that waits leap.
    """
    passed, waiting, last = memory[0], memory[1], memory[2]
    verdict, sample = PASSED, np.empty(6)
    sample[:3], sample[3:] = rate, force
    possible = is_possible(sample)  # else `check` drops it
    if memory[3, 2] > 0.0 or memory[4, 2] > 0.0:
        back = possible and dt > 0.0
        for group in range(2):
            nearer = step_of(sample, passed, group) < step_of(sample, waiting, group)
            back &= nearer or memory[3 + group, 2] == 0.0
        verdict = WAS_SPIKE if back else FOLLOWED
        if not back:
            passed[:] = waiting
    if not possible:
        memory[3:, 2] = 0.0
        return verdict
    waits = False
    for group in range(2):
        usual = memory[3 + group]
        leaps = dt > 0.0 and is_leap(step_of(sample, passed, group), usual, group, dt)
        learn(step_of(sample, last, group), usual)
        usual[2] = leaps
        waits |= leaps
    last[:] = sample
    if waits:
        waiting[:] = sample
        return verdict | WAITS
    passed[:] = sample
    return verdict
