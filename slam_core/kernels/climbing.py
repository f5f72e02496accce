"""Sections IV-B and IV-C in one call: choose the beams, climb from the coarsest level to the finest, say how sure.

One scan takes tens of microseconds, of which every call from Python would take several.
"""

import math

import numpy as np
from numba import njit

from slam_core.kernels.matching import gauss_newton, normal_equations
from slam_core.kernels.planar import inverse3
from slam_core.kernels.surfaces import tangents

# A direction that the scan says nothing about is this uncertain at most: metres, metres, radians.
LARGEST_SIGMA = (10.0, 10.0, math.pi)


@njit(cache=True, error_model="numpy")
def climb(
    cells,
    corners,
    resolution,
    points,
    start,
    mean,
    covariance,
    weight,
    iterations_coarse,
    iterations_fine,
    converged_step,
    max_yaw_step,
    sigma,
    weak_sigma,
    residuals,
    trace,
):
    """The match (7, 3): pose, Hessian (13), covariance (15); steps of each level; whether the finest converged.

    cells, corners: tuples over the levels, finest first, whose cells are `resolution` metres, then twice that.
    points: (n, 2) and residuals: (n,) as in a MatchResult. mean, covariance: prediction that joins with `weight`.
    trace: (levels, k, 3) takes the first k iterates of each level.
    """
    found = np.empty((7, 3))
    pose = found[0]
    pose[:] = start
    xs, ys = points[:, 0].copy(), points[:, 1].copy()
    along_x, along_y = np.zeros_like(xs), np.zeros_like(xs)
    beams = (xs, ys, along_x, along_y)
    at_start = hessian(cells[0], corners[0], 1.0 / resolution, beams, pose, residuals)
    if weakest_variance(hessian_covariance(at_start, sigma)) > weak_sigma * weak_sigma:
        tangents(xs, ys, along_x, along_y)
    prior = _prior(mean, covariance, weight * sigma * sigma, start[2])
    taken = np.zeros(len(cells), np.int64)
    converged = False
    for i in range(len(cells) - 1, -1, -1):
        allowed = iterations_coarse if i else iterations_fine
        taken[i], converged = gauss_newton(
            cells[i],
            corners[i],
            1.0 / (resolution * (1 << i)),
            *beams,
            pose,
            prior,
            allowed,
            converged_step,
            max_yaw_step,
            residuals,
            trace[i],
        )
    found[1:4] = hessian(cells[0], corners[0], 1.0 / resolution, beams, pose, residuals)
    found[4:] = hessian_covariance(found[1:4], sigma)
    return found, taken, converged


@njit(cache=True, error_model="numpy")
def hessian(cells, corner, inverse, beams, pose, residuals):
    """H of eq. (13) at a pose as a matrix, and the residuals."""
    xs, ys, along_x, along_y = beams
    h00, h01, h02, h11, h12, h22, _, _, _, _ = normal_equations(
        cells, corner, inverse, xs, ys, along_x, along_y, pose[0], pose[1], pose[2], residuals
    )
    return np.array([[h00, h01, h02], [h01, h11, h12], [h02, h12, h22]])


@njit(cache=True, error_model="numpy")
def hessian_covariance(matrix, sigma):
    """R = sigma^2 H^-1, eq. (15), bounded where H is (nearly) singular by LARGEST_SIGMA."""
    information = matrix / sigma**2
    for j in range(3):
        information[j, j] += LARGEST_SIGMA[j] ** -2.0
    return inverse3(information)


@njit(cache=True, error_model="numpy")
def weakest_variance(covariance):
    """Of the position along the direction that is determined worst: the larger eigenvalue."""
    xx, xy, yy = covariance[0, 0], covariance[0, 1], covariance[1, 1]
    return 0.5 * (xx + yy + math.hypot(xx - yy, 2.0 * xy))


@njit(cache=True, error_model="numpy")
def _prior(mean, covariance, scale, heading):
    """(4, 3): information in units of the cost, whose scale is sigma^2 by eq. (15); the mean near `heading`."""
    term = np.zeros((4, 3))
    if scale > 0.0:
        term[:3] = scale * inverse3(covariance)
        term[3] = mean
        term[3, 2] -= 2.0 * math.pi * np.floor((mean[2] - heading) / (2.0 * math.pi) + 0.5)
    return term
