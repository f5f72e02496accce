"""Sections IV-B and IV-C in one call: select the beams, match from the coarsest level to the finest, covariance.

One scan takes tens of microseconds, of which every call from Python would take several.
"""

import math

import numpy as np
from numba import njit

from slam_core.kernels import INNER
from slam_core.kernels.back_faces import as_unknown, cost_in_front, count_behind
from slam_core.kernels.correlative import count_hits
from slam_core.kernels.gauss_newton import (
    gauss_newton,
    joint_cost,
    normal_equations,
    prior_cost,
    without,
    workspace,
)
from slam_core.kernels.linear import assign, fill
from slam_core.kernels.memory import alias_scope
from slam_core.kernels.planar import inverse3, whole_turns
from slam_core.kernels.structures import (
    Beams,
    Level,
    Levels,
    Limits,
    MatchOutput,
    MatchProblem,
    MatchSettings,
    Prior,
)
from slam_core.kernels.surfaces import tangents, weakest_direction
from slam_core.kernels.surfels import settle

get, _ = alias_scope(0)
_, put = alias_scope(1)
_, put_too = alias_scope(2)
_workspace = njit(inline="always")(workspace)

# At least this many of the beams, evenly spaced, show how well the shape of the scan observes its position, and
# whether it sees walls from behind.
SURVEYED = 180
# A coarser level only starts the next: it ends when its step is shorter than this part of its cells.
NEAR = 0.05
# Standard deviations of an unobservable direction: metres, metres, radians.
LARGEST_SIGMA = (10.0, 10.0, math.pi)


@njit(cache=True, error_model="numpy")
def match_coarse_to_fine(cells, corner, resolution, surfels, points, start, prior, settings, output):
    """Match the points. Returns whether the finest level converged, and `count_hits` of the coarsest level.

    cells: as of `Levels`, whose cells are `resolution` metres, then twice that; output tells how many there are.
    corner: (2,) and surfels: of the finest. points: (n, 2) as in a MatchResult. start: (3,) pose.
    prior, settings, output: the fields of `Prior`, `MatchSettings`, `MatchOutput`.
    """
    prior, settings, output = Prior(*prior), MatchSettings(*settings), MatchOutput(*output)
    found, residuals, trace = output.found, output.residuals, output.trace
    pose, unobservable = found[0], found[1, :2]
    assign(pose, start)
    xs, ys = np.empty(len(points), np.float32), np.empty(len(points), np.float32)
    _part(points.reshape(-1), xs, ys)
    beams = Beams(xs, ys)
    step = max(1, len(xs) // SURVEYED)
    few = Beams(xs[::step].copy(), ys[::step].copy())
    assign(found[1], survey(few, start[2]))
    if found[1, 2] >= settings.degeneracy_threshold:
        unobservable[0] = unobservable[1] = 0.0
    work, matched = _workspace(), np.empty(6)
    term = _prior_term(prior, settings.sigma, start[2])
    levels, last = Levels(cells, corner, resolution), len(output.taken) - 1
    finest, walls = level_of(levels, 0), Level(surfels, corner, 1.0 / resolution)
    problem = MatchProblem(levels, start, term, unobservable, settings, work)
    converged = _descend(problem, beams, pose, output, matched)
    least = settings.back_face_share * len(few.xs) if settings.surfel_weight > 0.0 else math.inf
    behind = np.empty(len(xs), np.bool_)
    sees_behind = least < len(few.xs) and count_behind(walls, few, pose, behind) > least
    if sees_behind:
        converged = _match_in_front(problem, walls, beams, pose, output, matched, behind, converged)
    if 0.0 < (settings.prior_restart_sigmas * settings.sigma) ** 2 < prior_cost(term, pose):
        other, its_matched, its_trace = term[3].copy(), np.empty_like(matched), np.empty_like(trace[0])
        limits = Limits(settings.iterations_fine, settings.converged_step)
        its_steps, its_end = gauss_newton(
            finest, beams, other, term, unobservable, limits, residuals, its_trace, work, its_matched
        )
        cost = _cost(problem, walls, beams, pose, residuals, behind, sees_behind)
        if _cost(problem, walls, beams, other, residuals, behind, sees_behind) < cost:
            assign(pose, other)
            assign(matched, its_matched)
            fill(trace[0], its_trace)
            output.taken[0], converged = its_steps, its_end
    if settings.surfel_weight > 0.0:
        halves = ((xs[::2].copy(), ys[::2].copy()), (xs[1::2].copy(), ys[1::2].copy()))
        settle(walls, halves, pose, matched, settings.surfel_weight, unobservable)
    fill(found[2:5], hessian(finest, beams, pose, residuals, work))
    fill(found[5:], hessian_covariance(found[2:5], settings.sigma, unobservable))
    pose[2] -= whole_turns(pose[2])
    known, hits = count_hits(cells[last], corner >> last, 1.0 / (resolution * (1 << last)), points, pose)
    if sees_behind:
        count_behind(walls, beams, pose, behind)
        as_unknown(residuals, behind)
    return converged, known, hits


@njit(cache=True, error_model="numpy")
def _descend(problem, beams, pose, output, matched):
    """Match the beams from the coarsest level to the finest, `pose` (3,) in place. Whether the last converged."""
    levels, settings, converged = problem.levels, problem.settings, False
    for i in range(len(output.taken) - 1, -1, -1):
        step = settings.converged_step
        if i and step:
            step = max(step, NEAR * levels.resolution * (1 << i))
        limits = Limits(settings.iterations_coarse if i else settings.iterations_fine, step)
        output.taken[i], converged = gauss_newton(
            level_of(levels, i), beams, pose, problem.term, problem.unobservable, limits, output.residuals,
            output.trace[i], problem.workspace, matched,
        )  # fmt: skip
    return converged


@njit(cache=True, error_model="numpy")
def _match_in_front(problem, walls, beams, pose, output, matched, behind, converged):
    """Match again without the ends on walls seen from behind; `pose` (3,) is then the one that costs less.

    walls: a `Level` of surfels. behind: (n,) workspace. converged: whether `pose` is that of a match that did.
    """
    residuals = output.residuals
    cost = _cost(problem, walls, beams, pose, residuals, behind, True)
    kept, other, its_matched = Beams(beams.xs[~behind], beams.ys[~behind]), problem.start.copy(), matched.copy()
    its = MatchOutput(output.found, output.taken.copy(), residuals, output.trace.copy())
    its_end = _descend(problem, kept, other, its, its_matched)
    if not _cost(problem, walls, beams, other, residuals, behind, True) < cost:
        return converged
    assign(pose, other)
    assign(matched, its_matched)
    for i in range(len(output.taken)):
        output.taken[i] = its.taken[i]
        fill(output.trace[i], its.trace[i])
    return its_end


@njit(cache=True, error_model="numpy")
def _cost(problem, walls, beams, pose, residuals, behind, sees_behind):
    """Of a pose by eq. (7) and the prior.

    sees_behind: which ends are `behind` (n,) is found, and these cost as on unknown cells.
    """
    finest, term, work = level_of(problem.levels, 0), problem.term, problem.workspace
    if not sees_behind:
        return joint_cost(finest, beams, pose, term, residuals, work)
    count_behind(walls, beams, pose, behind)
    return cost_in_front(finest, beams, pose, term, residuals, behind, work)


@njit(inline="always")
def level_of(levels, i):
    """One of them, 0 the finest."""
    return Level(levels.cells[i], levels.corner >> i, 1.0 / (levels.resolution * (1 << i)))


@njit(**INNER)
def _part(points, xs, ys):
    """The coordinates of points (2n,), each into an array of its own."""
    for k in range(len(xs)):
        put(xs, k, get(points, 2 * k))
        put_too(ys, k, get(points, 2 * k + 1))


@njit(cache=True, error_model="numpy")
def survey(beams, psi):
    """The direction in the map that the shape of the scan observes worst, and the share of beams that fix it."""
    xs, ys = beams
    along_x, along_y = np.empty_like(xs), np.empty_like(xs)
    tangents(xs, ys, along_x, along_y)
    share, x, y = weakest_direction(xs, ys, along_x, along_y)
    return np.array([math.cos(psi) * x - math.sin(psi) * y, math.sin(psi) * x + math.cos(psi) * y, share])


@njit(cache=True, error_model="numpy")
def hessian(level, beams, pose, residuals, work):
    """H of eq. (13) at a pose as a matrix, and the residuals."""
    h00, h01, h02, h11, h12, h22, _, _, _, _ = normal_equations(level, beams, pose, residuals, work)
    return _symmetric(h00, h01, h02, h11, h12, h22)


@njit(inline="always")
def _symmetric(a00, a01, a02, a11, a12, a22):
    """(3, 3)."""
    out = np.empty((3, 3))
    out[0, 0], out[1, 1], out[2, 2] = a00, a11, a22
    out[0, 1] = out[1, 0] = a01
    out[0, 2] = out[2, 0] = a02
    out[1, 2] = out[2, 1] = a12
    return out


@njit(cache=True, error_model="numpy")
def hessian_covariance(matrix, sigma, unobservable):
    """R = sigma^2 H^-1, eq. (15), with LARGEST_SIGMA along `unobservable` and where H is (nearly) singular."""
    h00, h01, h02, h11, h12, h22, _, _, _ = without(
        unobservable,
        matrix[0, 0],
        matrix[0, 1],
        matrix[0, 2],
        matrix[1, 1],
        matrix[1, 2],
        matrix[2, 2],
        0.0,
        0.0,
        0.0,
    )
    information = _symmetric(h00, h01, h02, h11, h12, h22)
    for j in range(3):
        for i in range(3):
            information[i, j] /= sigma**2
        information[j, j] += LARGEST_SIGMA[j] ** -2.0
    covariance = inverse3(information)
    for i in range(2):
        for j in range(2):
            covariance[i, j] += LARGEST_SIGMA[0] ** 2.0 * unobservable[i] * unobservable[j]
    return covariance


@njit(**INNER)
def _prior_term(prior, sigma, heading):
    """(4, 3): information in units of the cost, whose scale is sigma^2 by eq. (15); the mean near `heading`."""
    term, mean, scale = np.zeros((4, 3)), prior.mean, prior.weight * sigma * sigma
    if scale > 0.0:
        information = inverse3(prior.covariance)
        for j in range(3):
            term[3, j] = mean[j]
            for i in range(3):
                term[i, j] = scale * information[i, j]
        term[3, 2] -= whole_turns(mean[2] - heading)
    return term
