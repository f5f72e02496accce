"""Section IV-B: align a scan with the map by Gauss-Newton, coarse to fine, and say how sure that is."""

import math

import numpy as np

from slam_core.config import MatcherConfig
from slam_core.geometry import wrap
from slam_core.grid import GridLevel
from slam_core.kernels import matching
from slam_core.kernels.planar import inverse3
from slam_core.measurements import Float32s, Float64s
from slam_core.pyramid import Pyramid
from slam_core.results import MatchResult, PlanarGaussian
from slam_core.surfaces import Beams

# A direction that the scan says nothing about is this uncertain at most: metres, metres, radians.
LARGEST_SIGMA = np.array([10.0, 10.0, math.pi])
SMALLEST_INFORMATION = np.diag(LARGEST_SIGMA**-2.0)
# The sampled covariance looks this far along each axis of the Hessian's ellipsoid, in sigmas.
SAMPLED_SIGMAS = np.array([0.5, 1.0, 1.5, 2.0, 2.5, 3.0])

NO_TRACE = np.empty((0, 4))


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
    config.prior_weight; R stays what the scan alone says.
    """
    beams = _choose_beams(pyramid.levels[0], points, start, config)
    pose = np.array(start, np.float64)
    held = _prior_term(prior, start, config)
    iterations: list[int] = []
    traces: list[Float64s] = [NO_TRACE]
    converged = False
    for i in reversed(range(len(pyramid.levels))):
        allowed = config.iterations_coarse if i else config.iterations_fine
        steps = np.empty((allowed if trace else 0, 3))
        taken, converged = _climb(pyramid.levels[i], beams, pose, held, allowed, config, steps)
        iterations.insert(0, taken)
        if trace:
            traces.append(np.column_stack([np.full(taken, float(i)), steps[:taken]]))
    finest = pyramid.levels[0]
    hessian, _, _ = normal_equations(finest, beams, pose)
    pose[2] = wrap(pose[2])
    if config.covariance == "sampled":
        covariance = sampled_covariance(finest, points, pose, config.sigma)
    else:
        covariance = hessian_covariance(hessian, config.sigma)
    return MatchResult(
        pose,
        covariance,
        hessian,
        residuals(finest, beams, pose),
        tuple(iterations),
        converged,
        np.concatenate(traces),
    )


def _choose_beams(level: GridLevel, points: Float32s, start: Float64s, config: MatcherConfig) -> Beams:
    """The paper's whole gradient where that fixes the position, else only what lies across the surfaces."""
    plain = Beams.plain(points)
    hessian, _, _ = normal_equations(level, plain, start)
    (xx, xy, _), (_, yy, _), _ = hessian_covariance(hessian, config.sigma).tolist()
    weakest = 0.5 * (xx + yy + math.hypot(xx - yy, 2.0 * xy))  # the larger eigenvalue
    return Beams.with_surfaces(points) if weakest > config.weak_sigma**2 else plain


def _climb(
    level: GridLevel,
    beams: Beams,
    pose: Float64s,
    held: Float64s,
    allowed: int,
    config: MatcherConfig,
    steps: Float64s,
) -> tuple[int, bool]:
    taken, converged = matching.gauss_newton(
        *_grid_arguments(level),
        *beams.arrays,
        pose,
        held,
        allowed,
        config.converged_step,
        config.max_yaw_step,
        steps,
    )
    return int(taken), bool(converged)


def _prior_term(prior: PlanarGaussian | None, start: Float64s, config: MatcherConfig) -> Float64s:
    """(4, 3): the prior's information in units of the cost, whose scale is sigma^2 by eq. (15), and its mean."""
    term = np.zeros((4, 3))
    if prior is not None and config.prior_weight > 0.0:
        term[:3] = config.prior_weight * config.sigma**2 * inverse3(prior.covariance)
        term[3] = prior.mean
        term[3, 2] = start[2] + wrap(prior.mean[2] - start[2])
    return term


def _grid_arguments(level: GridLevel) -> tuple[Float32s, int, int, int, int, float]:
    rows, columns = level.shape
    left, low = level.corner.tolist()
    return level.probability.reshape(-1), rows, columns, left, low, 1.0 / level.resolution


def normal_equations(level: GridLevel, beams: Beams, pose: Float64s) -> tuple[Float64s, Float64s, float]:
    """H (3, 3) of eq. (13), right side (3,) of eq. (12) and cost of eq. (7) at `pose`; metres, radians."""
    h00, h01, h02, h11, h12, h22, b0, b1, b2, cost = matching.normal_equations(
        *_grid_arguments(level), *beams.arrays, pose[0], pose[1], pose[2]
    )
    hessian = np.array([[h00, h01, h02], [h01, h11, h12], [h02, h12, h22]])
    return hessian, np.array([b0, b1, b2]), float(cost)


def residuals(level: GridLevel, beams: Beams, pose: Float64s) -> Float32s:
    """1 - M(S_i(xi)) of every endpoint, eq. (7)."""
    out = np.empty(len(beams.xs), np.float32)
    matching.residuals(*_grid_arguments(level), beams.xs, beams.ys, pose[0], pose[1], pose[2], out)
    return out


def hessian_covariance(hessian: Float64s, sigma: float) -> Float64s:
    """R = sigma^2 H^-1, eq. (15), bounded where H is (nearly) singular by LARGEST_SIGMA."""
    covariance: Float64s = inverse3(hessian / sigma**2 + SMALLEST_INFORMATION)
    return covariance


def sampled_covariance(level: GridLevel, points: Float32s, pose: Float64s, sigma: float) -> Float64s:
    """The sampled alternative of section IV-B: poses near the match, weighted by how well they fit.

    Samples lie on the axes of the Hessian's ellipsoid, as sigma points do; each weighs exp(-dE / (2 sigma^2)) with
    dE its extra cost. A quadratic cost gives eq. (15) back; a flatter one gives more. (3, 3), metres and radians.
    """
    beams = Beams.plain(points)
    hessian, _, best = normal_equations(level, beams, pose)
    variances, axes = np.linalg.eigh(hessian_covariance(hessian, sigma))
    expected = np.exp(-0.5 * SAMPLED_SIGMAS**2)
    wanted = np.sum(expected * SAMPLED_SIGMAS**2) / (1.0 + 2.0 * np.sum(expected)) * 2.0
    scales = np.empty(3)
    for j in range(3):
        offsets = np.concatenate([-SAMPLED_SIGMAS, SAMPLED_SIGMAS])
        poses = pose + offsets[:, None] * math.sqrt(variances[j]) * axes[:, j]
        extra = np.array([normal_equations(level, beams, p)[2] for p in poses]) - best
        weights = np.exp(-np.maximum(extra, 0.0) / (2.0 * sigma**2))
        scales[j] = np.sum(weights * offsets**2) / (1.0 + np.sum(weights)) / wanted
    covariance: Float64s = (axes * (variances * scales)) @ axes.T
    return covariance
