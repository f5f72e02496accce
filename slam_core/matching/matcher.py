"""Section IV-B: align a scan with the map by Gauss-Newton, coarse to fine, with its covariance."""

import math
from collections.abc import Sequence

import numpy as np

from slam_core.config import MatcherConfig
from slam_core.kernels import coarse_to_fine as kernels
from slam_core.kernels import gauss_newton
from slam_core.kernels.structures import MOST_LEVELS, Beams, Level
from slam_core.mapping.grid import GridLevel
from slam_core.mapping.pyramid import Pyramid
from slam_core.measurements import Float32s, Float64s
from slam_core.results import NOWHERE, Fit, MatchResult, PlanarGaussian

# The sampled covariance looks this far along each axis of the Hessian's ellipsoid, in sigmas.
SAMPLED_SIGMAS = np.array([0.5, 1.0, 1.5, 2.0, 2.5, 3.0])

NO_TRACE = np.empty((0, 4))
NO_COVARIANCE = np.eye(3)  # of a prior that does not count


def coarse_to_fine(
    pyramid: Pyramid,
    points: Float32s,
    start: Float64s,
    config: MatcherConfig,
    *,
    prior: PlanarGaussian | None = None,
    trace: bool = False,
) -> MatchResult:
    """xi* of eq. (7) from a start estimate: each level's result starts the next finer one (section IV-C).

    points: (n, 2) endpoints in the stabilised frame, metres. start: (3,) pose. trace: keep every iterate.
    prior: a predicted pose that joins the cost of (7) as (xi - prior)^T P^-1 (xi - prior), weighted by
    config.prior_weight; R is that of the scan alone. Where next to no beams fix some direction of the position,
    the pose keeps its start estimate in it (config.degeneracy_threshold). A match far from the prediction is
    compared with one that starts there (config.prior_restart_sigmas). One with endpoints on walls seen from behind
    is compared with one without these (config.back_face_share). At last the endpoints are matched with the surfels
    (config.surfel_weight).
    """
    pyramid.cover(points, start)
    levels = pyramid.levels
    residuals = np.empty(len(points), np.float32)
    kept = max(config.iterations_coarse, config.iterations_fine) if trace else 0
    steps = np.empty((len(levels), kept, 3))
    found, taken = np.empty((8, 3)), np.empty(len(levels), np.int64)
    finest, weight, cells = levels[0], config.prior_weight, [level.cells for level in levels]
    converged, known, hits = kernels.match_coarse_to_fine(
        (*cells, *cells[-1:] * (MOST_LEVELS - len(cells))),
        finest.corner,
        finest.resolution,
        finest.surfels,
        points,
        start,
        (start, NO_COVARIANCE, 0.0) if prior is None else (prior.mean, prior.covariance, weight),
        _settings(config),
        (found, taken, residuals, steps),
    )
    pose, unobservable, hessian, covariance = found[0], found[1, :2], found[2:5], found[5:]
    if config.covariance == "sampled":
        covariance = sampled_covariance(levels[0], points, pose, config.sigma, unobservable)
    iterations = tuple(taken.tolist())
    iterates = _in_order(steps, iterations) if trace else NO_TRACE
    return MatchResult(
        pose, covariance, hessian, residuals, iterations, converged, iterates, unobservable, found.item(1, 2),
        Fit.counted(len(points), known, hits),
    )  # fmt: skip


def _settings(config: MatcherConfig) -> tuple[float, ...]:
    """The fields of `kernels.structures.MatchSettings`."""
    return (
        config.iterations_coarse,
        config.iterations_fine,
        config.converged_step,
        config.prior_restart_sigmas,
        config.sigma,
        config.surfel_weight,
        config.back_face_share,
        config.degeneracy_threshold,
    )


def _in_order(steps: Float64s, taken: Sequence[int]) -> Float64s:
    """(k, 4) level and pose after each step, coarse to fine, from the poses of each level."""
    levels = reversed(range(len(taken)))
    return np.concatenate([np.insert(steps[i, : taken[i]], 0, float(i), axis=1) for i in levels])


def level_of(level: GridLevel) -> Level:
    """A level as the kernels take it."""
    return Level(level.cells, level.corner, 1.0 / level.resolution)


def beams_of(points: Float32s) -> Beams:
    """Endpoints (n, 2) as the kernels take them."""
    xs, ys = np.ascontiguousarray(np.asarray(points, np.float32).T)
    return Beams(xs, ys)


def normal_equations(level: GridLevel, beams: Beams, pose: Float64s) -> tuple[Float64s, Float64s, float]:
    """H (3, 3) of eq. (13), right side (3,) of eq. (12) and cost of eq. (7) at `pose`; metres, radians."""
    residuals = np.empty_like(beams.xs)
    h00, h01, h02, h11, h12, h22, b0, b1, b2, cost = gauss_newton.normal_equations(
        level_of(level), beams, pose, residuals, gauss_newton.workspace()
    )
    hessian = np.array([[h00, h01, h02], [h01, h11, h12], [h02, h12, h22]])
    return hessian, np.array([b0, b1, b2]), float(cost)


def residuals(level: GridLevel, points: Float32s, pose: Float64s) -> Float32s:
    """(n,) 1 - M(S_i(xi)) of endpoints (n, 2) in the stabilised frame, metres, at `pose` (3,) in the map."""
    beams = beams_of(points)
    found = np.empty_like(beams.xs)
    gauss_newton.normal_equations(level_of(level), beams, pose, found, gauss_newton.workspace())
    return found


def hessian_covariance(hessian: Float64s, sigma: float, unobservable: Float64s = NOWHERE) -> Float64s:
    """R = sigma^2 H^-1, eq. (15), by LARGEST_SIGMA along `unobservable` (2,) and where H is (nearly) singular."""
    covariance: Float64s = kernels.hessian_covariance(hessian, sigma, unobservable)
    return covariance


def sampled_covariance(
    level: GridLevel, points: Float32s, pose: Float64s, sigma: float, unobservable: Float64s = NOWHERE
) -> Float64s:
    """The sampled alternative of section IV-B: poses near the match, weighted by how well they fit.

    Samples lie on the axes of the Hessian's ellipsoid, as sigma points do; each weighs exp(-dE / (2 sigma^2)) with
    dE its extra cost. A quadratic cost gives eq. (15) back; a flatter one gives more; an unobservable direction
    stays as it is. (3, 3), metres and radians.
    """
    beams = beams_of(points)
    hessian, _, best = normal_equations(level, beams, pose)
    variances, axes = np.linalg.eigh(hessian_covariance(hessian, sigma, unobservable))
    open_axes = np.abs(unobservable @ axes[:2]) > 0.5
    expected = np.exp(-0.5 * SAMPLED_SIGMAS**2)
    wanted = np.sum(expected * SAMPLED_SIGMAS**2) / (1.0 + 2.0 * np.sum(expected)) * 2.0
    scales = np.empty(3)
    for j in range(3):
        offsets = np.concatenate([-SAMPLED_SIGMAS, SAMPLED_SIGMAS])
        poses = pose + offsets[:, None] * math.sqrt(variances[j]) * axes[:, j]
        extra = np.array([normal_equations(level, beams, p)[2] for p in poses]) - best
        weights = np.exp(-np.maximum(extra, 0.0) / (2.0 * sigma**2))
        scales[j] = np.sum(weights * offsets**2) / (1.0 + np.sum(weights)) / wanted
    scales[open_axes] = 1.0
    covariance: Float64s = (axes * (variances * scales)) @ axes.T
    return covariance
