"""The cost of eq. (7) at many poses."""

from numba import njit

from slam_core.kernels.gauss_newton import normal_equations


@njit(cache=True, nogil=True, error_model="numpy")
def costs_at(level, beams, poses, residuals, workspace, costs):
    """`costs` (k,) takes (7) at poses (k, 3); other threads of Python run meanwhile.

    The rest as of `normal_equations`, whose sums for H and b cost little beside the fetching of the cells.
    """
    for k in range(len(poses)):
        costs[k] = normal_equations(level, beams, poses[k], residuals, workspace)[9]
