"""Beams on an object that moves: they may drag a match along, most of all where nothing else observes the motion.

Somebody who walks ahead of a robot in a corridor is hit by more beams than all that tells how far the robot has
come. A match that follows the person is far from the prediction, but so is one of a robot that brakes. What tells
them apart is the rest of the scan: it fits better at the true pose. People who set off with the robot hold it back
little by little, so that no match is far from the prediction: each scan is matched without its foreground, too.

Inertial data and wheels predict the motion well. With them a scan is matched without its foreground only where its
match is far from the prediction or fits badly: somebody may stand right before the laser, or walk along.
"""

import math

import numpy as np
from numpy.typing import NDArray

from slam_core.config import MatcherConfig
from slam_core.kernels import surfaces
from slam_core.kernels.planar import sigmas_apart
from slam_core.localization.tracking import MOSTLY
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.matcher import coarse_to_fine, residuals
from slam_core.measurements import Float32s, Float64s, Int64s
from slam_core.results import FEW, MatchResult, PlanarGaussian, Rejection
from slam_core.scan.stabilise import StabilisedScan

# A residual above FREE there: free space, no wall within a cell. `Pyramid.unexpected` asks for 0.15 m to what is
# occupied, and whoever has walked 0.2 m is nearer than that to the cells of the scan before.
LEVEL, FREE = 1, 0.6
GAP, EXTENT = 0.3, 1.5  # metres between endpoints on one object, and from one end of it to the other, at most
OBJECTS = 2  # that move at once
NEARER = 0.5  # of the distance between match and prediction
BETTER = 0.95  # of the cost of eq. (7) of the other beams
KNOWN = 0.9  # of the share of them on known cells before: an unknown cell costs less than free space
FEWEST = 3  # beams of an object in the foreground
BESIDE = 1.5  # metres: who is half out of the view is no further
CLEARLY = 0.9  # of the cost of the background at the match of all beams, and less by
SIGMAS = 2.0  # standard deviations of that difference
MANY = 0.4  # of the endpoints: so many on objects, and few beams on the rest, fix no pose
EXACT = np.zeros((3, 3))  # covariance of a pose that is compared as it is


def without_dynamic(
    pyramid: Pyramid,
    predicted: StabilisedScan,
    aligned: tuple[StabilisedScan, MatchResult],
    prior: PlanarGaussian,
    config: MatcherConfig,
    *,
    is_unusual: bool,
) -> tuple[StabilisedScan, MatchResult]:
    """A scan and its match without what may move, if the rest of the scan fits better so; else as they are.

    predicted: the scan as the prediction places its beams. aligned: as the match of all beams does, and this.
    is_unusual: the match is far from the prediction.
    """
    scan, match = aligned
    static = match_without(pyramid, predicted.points, match, prior, config) if is_unusual else None
    if static is not None:
        return predicted, static
    return scan, match_background(pyramid, scan.points, match, prior, config) or match


def match_background(
    pyramid: Pyramid,
    points: Float32s,
    match: MatchResult,
    prior: PlanarGaussian,
    config: MatcherConfig,
    *,
    measured: bool = False,
) -> MatchResult | None:
    """The match without every object in the foreground; None if the background fits not clearly better so.

    measured: other sensors make the prediction; None if it and the background together are explained no better.
    The residuals of the result are as of `match_without`.
    """
    static = ~foreground(points)
    if static.all() or 2 * np.count_nonzero(static) < len(points):
        return None
    other = coarse_to_fine(pyramid, points[static], prior.mean, config, prior=prior)
    before = match.residuals[static]
    if measured:
        is_taken = is_better_with_prediction(other, match, before, prior, config)
    else:
        is_taken = is_clearly_better(other, match, before)
    return of_all(other, pyramid, points, static) if is_taken else None


def background_cost(scan: StabilisedScan, match: MatchResult) -> float:
    """Eq. (7) of the beams that end on no object in the foreground, the mean."""
    squares = np.square(match.residuals)[~foreground(scan.points)]
    return float(np.mean(squares)) if len(squares) else math.inf


def foreground(points: Float32s, *, sees_past: bool = False) -> NDArray[np.bool_]:
    """(n,) which endpoints (n, 2) are on a compact object that stands before what is seen beside it.

    What a wall that is seen along shows between two beams is no object: one of its neighbours is nearer.
    sees_past: where nothing returns beside an object, what is there is further off. For a laser alone that leaves
    too few landmarks.
    """
    found: NDArray[np.bool_] = surfaces.foreground(points, GAP, EXTENT, FEWEST, BESIDE, sees_past)
    return found


def mostly_objects(points: Float32s, beams: int) -> Rejection | None:
    """Why a match that fits badly tells nothing: many beams end on objects that may move, and few on the rest.

    points: (n, 2) endpoints, metres. beams: of the laser; some return nothing.
    """
    before = foreground(points, sees_past=True)
    if np.mean(before) <= MANY or np.count_nonzero(~before) >= FEW * beams:
        return None
    return Rejection("objects", float(np.mean(before)), MANY)


def match_without(
    pyramid: Pyramid,
    points: Float32s,
    match: MatchResult,
    prior: PlanarGaussian,
    config: MatcherConfig,
) -> MatchResult | None:
    """The match without the objects in free space, by the prediction; None if the other beams fit no better so.

    points: (n, 2) endpoints in the stabilised frame as the prediction places them, metres. match: of all beams.
    The residuals of the result are those of eq. (7) alone, also on walls seen from behind.
    """
    if len(match.residuals) != len(points):  # placed by another motion, a sweep may keep other beams
        return None
    pyramid.cover(points, prior.mean)
    level = pyramid.levels[min(LEVEL, len(pyramid.levels) - 1)]
    found = objects(points, residuals(level, points, prior.mean) > FREE)
    for k in range(1, min(len(found), OBJECTS) + 1):
        static = np.ones(len(points), np.bool_)
        static[np.concatenate(found[:k])] = False
        other = coarse_to_fine(pyramid, points[static], prior.mean, config, prior=prior)
        if is_better(other, match, match.residuals[static], prior):
            return of_all(other, pyramid, points, static)
    return None


def of_all(match: MatchResult, pyramid: Pyramid, points: Float32s, static: NDArray[np.bool_]) -> MatchResult:
    """A match of some endpoints, with the residuals of all of them (n, 2).

    static: (n,) which were matched.
    """
    return match._replace(
        residuals=residuals(pyramid.levels[0], points, match.pose), left_out=np.flatnonzero(~static)
    )


def objects(points: Float32s, free: NDArray[np.bool_]) -> list[Int64s]:
    """The beams of each compact object in free space; first that with most of its endpoints there.

    points: (n, 2) in order, free: (n,) which lie in free space. What has moved by less than its size still covers
    a part of its image in the map: all of it is the object. On a wall only what lies in free space may be one.
    """
    found = list[Int64s]()
    for surface in _surfaces(points, np.arange(len(points))):
        found += [surface] if _is_compact(points[surface]) else _surfaces(points, surface[free[surface]])
    loose = [part for part in found if free[part].any() and _is_compact(points[part])]
    return sorted(loose, key=lambda part: int(np.count_nonzero(free[part])), reverse=True)


def _surfaces(points: Float32s, beams: Int64s) -> list[Int64s]:
    """Beams (k,) of points (n, 2), apart where one ends far from the one before."""
    steps = np.hypot(*np.diff(points[beams], axis=0).T)
    return np.split(beams, np.flatnonzero(steps > GAP) + 1) if len(beams) else []


def _is_compact(points: Float32s) -> bool:
    return bool(np.hypot(*np.ptp(points, axis=0)) < EXTENT)


def is_better(other: MatchResult, match: MatchResult, before: Float32s, prior: PlanarGaussian) -> bool:
    """Whether a match without some beams is the better one. before: residuals of its beams at the match of all."""
    return (
        prior.distance_to(other.pose) <= NEARER * prior.distance_to(match.pose)
        and _is_as_known(other, match)
        and float(np.square(other.residuals).sum()) <= BETTER * float(np.square(before).sum())
    )


def _is_as_known(other: MatchResult, match: MatchResult) -> bool:
    return other.fit.known >= max(MOSTLY, KNOWN * match.fit.known)


def is_clearly_better(other: MatchResult, match: MatchResult, before: Float32s) -> bool:
    """The same wherever the prediction is; the gain of the beams together has to stand out of their gains."""
    return _is_as_known(other, match) and fit_clearly_better(before, other.residuals, SIGMAS)


def fit_clearly_better(before: Float32s, after: Float32s, sigmas: float) -> bool:
    """Whether beams fit better by CLEARLY, and by `sigmas` standard deviations. Their residuals: (n,) each."""
    costs, others = (np.square(each.astype(np.float64)) for each in (before, after))
    gains = costs - others
    is_less = float(others.sum()) <= CLEARLY * float(costs.sum())
    return is_less and float(gains.sum()) >= sigmas * float(np.linalg.norm(gains))


def is_better_with_prediction(
    other: MatchResult, match: MatchResult, before: Float32s, prior: PlanarGaussian, config: MatcherConfig
) -> bool:
    """Whether the beams together with the prediction are explained better: eq. (7) and the prior."""
    cost = _joint_cost(before, match.pose, prior, config)
    return _is_as_known(other, match) and _joint_cost(other.residuals, other.pose, prior, config) < cost


def _joint_cost(residuals: Float32s, pose: Float64s, prior: PlanarGaussian, config: MatcherConfig) -> float:
    """Of residuals (n,) and of a pose (3,): what the match minimises, as `MatcherConfig.prior_weight` says."""
    distance = float(sigmas_apart(pose, EXACT, prior.mean, prior.covariance))
    return float(np.square(residuals).sum()) + config.prior_weight * (config.sigma * distance) ** 2
