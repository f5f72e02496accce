"""Section IV-B: align the endpoints of a scan with the map by Gauss-Newton, eqs. (7)-(15)."""

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from slam_core.measurements import Float64s
from slam_core.reference.occupancy_grid import OccupancyGrid


class Iteration(NamedTuple):
    """One Gauss-Newton iteration, evaluated at `pose`.

    level: 0 is the finest. pose: (3,) x, y in metres and psi in radians. H: (3, 3) of (13) and b: (3,) the right
    side of (12), metres and radians. cost: of (7). step: (3,) that is added to the pose. residuals: (n,) 1 - M of
    every beam. gradients: (n, 2) of M at every endpoint, per metre.
    """

    level: int
    pose: Float64s
    H: Float64s
    b: Float64s
    cost: float
    step: Float64s
    residuals: Float64s
    gradients: Float64s


def transformed(points: Float64s, pose: Float64s) -> Float64s:
    """S_i(xi) of eq. (8): endpoints (n, 2) of the stabilised frame in the map."""
    x, y, psi = pose
    c, s = math.cos(psi), math.sin(psi)
    placed: Float64s = points @ np.array([[c, s], [-s, c]]) + np.array([x, y])
    return placed


def derivatives(points: Float64s, psi: float) -> Float64s:
    """dS_i / dxi of eq. (14): (n, 2, 3)."""
    c, s = math.cos(psi), math.sin(psi)
    J = np.zeros((len(points), 2, 3))
    J[:, 0, 0] = J[:, 1, 1] = 1.0
    J[:, 0, 2] = -s * points[:, 0] - c * points[:, 1]
    J[:, 1, 2] = c * points[:, 0] - s * points[:, 1]
    return J


def evaluate(grid: OccupancyGrid, points: Float64s, pose: Float64s, level: int = 0) -> Iteration:
    """One iteration at a pose (3,), with the step that eq. (12) gives; no step where H is singular."""
    M, gradients = grid.interpolate(transformed(points, pose))
    residuals = 1.0 - M
    cost = float(residuals @ residuals)  # (7), (9)
    rows = np.einsum("ni,nij->nj", gradients, derivatives(points, pose[2]))  # nabla M dS/dxi of (10)
    H = rows.T @ rows  # (13), summed over the beams
    b = rows.T @ residuals  # the bracket of (12)
    step = np.linalg.solve(H, b) if np.linalg.matrix_rank(H) == 3 else np.zeros(3)  # (12), the solution of (11)
    return Iteration(level, pose.copy(), H, b, cost, step, residuals, gradients)


def match(
    levels: Sequence[OccupancyGrid],
    points: Float64s,
    start: Float64s,
    iterations: tuple[int, int],
) -> Iterator[Iteration]:
    """Every iteration from the coarsest level to the finest, and last an evaluation at the matched pose.

    levels: finest first. points: (n, 2) in the stabilised frame. start: (3,). iterations: on each coarser level,
    and on the finest. The matched pose xi* is that of the last iteration, whose step is 0.
    """
    pose = np.array(start, float)
    for level in range(len(levels) - 1, -1, -1):
        for _ in range(iterations[0] if level else iterations[1]):
            found = evaluate(levels[level], points, pose, level)
            yield found
            pose = pose + found.step
    pose[2] = math.remainder(pose[2], 2.0 * math.pi)
    yield evaluate(levels[0], points, pose)._replace(step=np.zeros(3))


def hessian_covariance(H: Float64s, sigma: float) -> Float64s:
    """R = sigma^2 H^-1 of eq. (15), metres and radians."""
    R: Float64s = sigma**2 * np.asarray(np.linalg.inv(H), np.float64)
    return R


def sampled_covariance(grid: OccupancyGrid, points: Float64s, pose: Float64s, sigma: float) -> Float64s:
    """The alternative of section IV-B: samples of the cost around a matched pose, weighted by their likelihood.

    The samples lie on the axes of the ellipsoid of (15). A quadratic cost gives (15) back.
    """
    best = evaluate(grid, points, pose)
    variances, axes = np.linalg.eigh(hessian_covariance(best.H, sigma))
    offsets = np.concatenate([-OFFSETS, OFFSETS])
    expected = np.exp(-0.5 * offsets**2)
    scale = np.sum(expected * offsets**2) / (1.0 + np.sum(expected))
    ratios = np.empty(3)
    for j in range(3):
        poses = pose + offsets[:, None] * math.sqrt(variances[j]) * axes[:, j]
        extra = np.array([evaluate(grid, points, each).cost for each in poses]) - best.cost
        weights = np.exp(-np.maximum(extra, 0.0) / (2.0 * sigma**2))
        ratios[j] = np.sum(weights * offsets**2) / (1.0 + np.sum(weights)) / scale
    R: Float64s = (axes * (variances * ratios)) @ axes.T
    return R


OFFSETS = np.array([0.5, 1.0, 1.5, 2.0, 2.5, 3.0])  # sigmas
