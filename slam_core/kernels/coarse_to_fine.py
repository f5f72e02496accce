"""Sections IV-B and IV-C in one call: choose the beams, climb from the coarsest level to the finest, say how sure.

One scan takes tens of microseconds, of which every call from Python would take several.
"""

import math

import numpy as np
from numba import njit

from slam_core.kernels.correlative import count_hits
from slam_core.kernels.gauss_newton import against, gauss_newton, joint_cost, normal_equations, notes, without
from slam_core.kernels.intrinsics import lane
from slam_core.kernels.linear import fill
from slam_core.kernels.planar import inverse3, whole_turns
from slam_core.kernels.surfaces import tangents, weakest_direction
from slam_core.kernels.surfels import settle

get, _ = lane(0)
_, put = lane(1)
_, put_too = lane(2)
_notes = njit(inline="always")(notes)

# Of the beams, evenly, this many at least show how well the shape of the scan fixes its position.
SURVEYED = 180
# A coarser level only starts the next: it ends when its step is shorter than this part of its cells.
NEAR = 0.05
# A direction that the scan says nothing about is this uncertain at most: metres, metres, radians.
LARGEST_SIGMA = (10.0, 10.0, math.pi)


@njit(cache=True, error_model="numpy")
def climb(
    cells,
    corner,
    resolution,
    surfels,
    points,
    start,
    mean,
    covariance,
    weight,
    iterations_coarse,
    iterations_fine,
    converged_step,
    max_yaw_step,
    coarse_beams,
    prior_restart_sigmas,
    sigma,
    surfel_weight,
    weak_observability_threshold,
    degeneracy_threshold,
    found,
    taken,
    residuals,
    trace,
):
    """Match the points: whether the finest level converged, and of the coarsest what `count_hits` counts.

    cells: a tuple over the levels, finest first, whose cells are `resolution` metres, then twice that.
    corner: (2,) and surfels: of the finest, which count `surfel_weight`.
    points: (n, 2) and residuals: (n,) as in a MatchResult. mean, covariance: prediction that joins with `weight`.
    coarse_beams: fewest that a coarser level takes, 0 for all. prior_restart_sigmas: that many sigmas off a
    prediction the finest level is climbed from there as well, and the pose of the lower
    cost, (7) with the prior, stays; 0 for never.
    found: (8, 3) takes the pose, the direction that the scan leaves open, if any, with the share of beams that fix
    it, the Hessian (13) and the covariance (15). taken: (levels,) takes the steps of each level.
    trace: (levels, k, 3) takes the first k iterates of each level.
    """
    pose, blind = found[0], found[1, :2]
    pose[:] = start
    xs, ys = np.empty(len(points), np.float32), np.empty(len(points), np.float32)
    _part(points.reshape(-1), xs, ys)
    along_x, along_y = np.zeros_like(xs), np.zeros_like(xs)
    beams = (xs, ys, along_x, along_y)
    found[1] = survey(xs, ys, start[2])
    weak = np.zeros(2)
    if found[1, 2] < weak_observability_threshold:
        weak[:] = blind
        tangents(xs, ys, along_x, along_y)
    if found[1, 2] >= degeneracy_threshold:
        blind[:] = 0.0
    noted, matched = _notes(), np.empty(6)
    prior = _prior(mean, covariance, weight * sigma * sigma, start[2])
    last, n = len(cells) - 1, len(xs)
    mixed_x, mixed_y, mixed_along_x, mixed_along_y = _by_turns(xs, last), _by_turns(ys, last), along_x, along_y
    if found[1, 2] < weak_observability_threshold:
        mixed_along_x, mixed_along_y = _by_turns(along_x, last), _by_turns(along_y, last)
    for i in range(last, 0, -1):
        cell, (begin, end) = resolution * (1 << i), _turn(i, n, coarse_beams)
        close = max(converged_step, NEAR * cell) if converged_step else 0.0
        lighter = prior.copy()
        lighter[:3] *= (end - begin) / max(n, 1)
        taken[i], _ = gauss_newton(
            cells[i],
            corner >> i,
            1.0 / cell,
            mixed_x[begin:end],
            mixed_y[begin:end],
            mixed_along_x[begin:end],
            mixed_along_y[begin:end],
            pose,
            lighter,
            blind,
            iterations_coarse,
            close,
            max_yaw_step,
            residuals,
            trace[i],
            *noted,
            matched,
        )
    finest = (cells[0], corner, 1.0 / resolution, *beams)
    limits = (blind, iterations_fine, converged_step, max_yaw_step)
    taken[0], converged = gauss_newton(*finest, pose, prior, *limits, residuals, trace[0], *noted, matched)
    if 0.0 < (prior_restart_sigmas * sigma) ** 2 < against(prior, pose):
        rival, its_matched, its_trace = prior[3].copy(), np.empty_like(matched), np.empty_like(trace[0])
        its_steps, its_end = gauss_newton(
            *finest, rival, prior, *limits, residuals, its_trace, *noted, its_matched
        )
        cost = joint_cost(*finest, pose, prior, residuals, *noted)
        if joint_cost(*finest, rival, prior, residuals, *noted) < cost:
            pose[:], matched[:], trace[0][:] = rival, its_matched, its_trace
            taken[0], converged = its_steps, its_end
    if surfel_weight > 0.0:
        half = n - n // 2
        halves = ((mixed_x[:half], mixed_y[:half]), (mixed_x[half:], mixed_y[half:]))
        settle(surfels, corner, 1.0 / resolution, halves, pose, matched, surfel_weight, weak)
    fill(found[2:5], hessian(cells[0], corner, 1.0 / resolution, beams, pose, residuals, noted))
    fill(found[5:], hessian_covariance(found[2:5], sigma, blind))
    pose[2] -= whole_turns(pose[2])
    known, hits = count_hits(cells[last], corner >> last, 1.0 / (resolution * (1 << last)), points, pose)
    return converged, known, hits


@njit(cache=True, error_model="numpy")
def _part(points, xs, ys):
    """The coordinates of points (2n,), each into an array of its own."""
    for k in range(len(xs)):
        put(xs, k, get(points, 2 * k))
        put_too(ys, k, get(points, 2 * k + 1))


@njit(cache=True, error_model="numpy")
def _by_turns(values, levels):
    """A copy with every other value moved behind the rest, and of that rest again, once a coarser level."""
    mixed, rest = values.copy(), len(values)
    for _ in range(max(levels, 1)):
        half = rest - rest // 2
        _deal(mixed[:rest].copy(), mixed[:half], mixed[half:rest])
        rest = half
    return mixed


@njit(cache=True, error_model="numpy")
def _deal(values, first, second):
    """Values to two receivers by turns."""
    for k in range(len(second)):
        put(first, k, get(values, 2 * k))
        put_too(second, k, get(values, 2 * k + 1))
    if len(first) > len(second):
        first[-1] = values[-1]


@njit(cache=True, error_model="numpy")
def _turn(i, n, fewest):
    """From where to where level i takes n beams `_by_turns`: half of those left, if they are `fewest` or more."""
    begin, end = 0, n
    for _ in range(i if fewest else 0):
        end = begin if begin else n
        begin = end - end // 2
        if end - begin < fewest:
            return 0, end
    return begin, end


@njit(cache=True, error_model="numpy")
def survey(xs, ys, psi):
    """The direction in the map that the scan's shape fixes worst, and the share of beams that fix it."""
    step = max(1, len(xs) // SURVEYED)
    xs, ys = xs[::step].copy(), ys[::step].copy()
    along_x, along_y = np.empty_like(xs), np.empty_like(xs)
    tangents(xs, ys, along_x, along_y)
    share, x, y = weakest_direction(xs, ys, along_x, along_y)
    return np.array([math.cos(psi) * x - math.sin(psi) * y, math.sin(psi) * x + math.cos(psi) * y, share])


@njit(cache=True, error_model="numpy")
def hessian(cells, corner, inverse, beams, pose, residuals, noted):
    """H of eq. (13) at a pose as a matrix, and the residuals."""
    xs, ys, along_x, along_y = beams
    h00, h01, h02, h11, h12, h22, _, _, _, _ = normal_equations(
        cells, corner, inverse, xs, ys, along_x, along_y, pose[0], pose[1], pose[2], residuals, *noted
    )
    return _symmetric(h00, h01, h02, h11, h12, h22)


@njit(inline="always")
def _symmetric(a00, a01, a02, a11, a12, a22):
    """(3, 3); compiled code makes it of a flat list much faster than of nested ones."""
    return np.array([a00, a01, a02, a01, a11, a12, a02, a12, a22]).reshape(3, 3)


@njit(cache=True, error_model="numpy")
def hessian_covariance(matrix, sigma, blind):
    """R = sigma^2 H^-1, eq. (15), by LARGEST_SIGMA along `blind` and where H is (nearly) singular."""
    h00, h01, h02, h11, h12, h22, _, _, _ = without(
        blind, matrix[0, 0], matrix[0, 1], matrix[0, 2], matrix[1, 1], matrix[1, 2], matrix[2, 2], 0.0, 0.0, 0.0
    )
    information = _symmetric(h00, h01, h02, h11, h12, h22) / sigma**2
    for j in range(3):
        information[j, j] += LARGEST_SIGMA[j] ** -2.0
    covariance = inverse3(information)
    for i in range(2):
        for j in range(2):
            covariance[i, j] += LARGEST_SIGMA[0] ** 2.0 * blind[i] * blind[j]
    return covariance


@njit(cache=True, error_model="numpy")
def _prior(mean, covariance, scale, heading):
    """(4, 3): information in units of the cost, whose scale is sigma^2 by eq. (15); the mean near `heading`."""
    term = np.zeros((4, 3))
    if scale > 0.0:
        information = inverse3(covariance)
        for j in range(3):
            term[3, j] = mean[j]
            for i in range(3):
                term[i, j] = scale * information[i, j]
        term[3, 2] -= whole_turns(mean[2] - heading)
    return term
