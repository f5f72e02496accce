"""Beams on an object that moves: where nothing but matches observes the motion, they may drag a match along.

Somebody who walks ahead of a robot in a corridor is hit by more beams than all that tells how far the robot has
come. A match that follows the person is far from the prediction, but so is one of a robot that brakes. What tells
them apart is the rest of the scan: it fits better at the true pose.
"""

import numpy as np
from numpy.typing import NDArray

from slam_core.config import MatcherConfig
from slam_core.localization.tracking import MOSTLY
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.matcher import coarse_to_fine, residuals
from slam_core.measurements import Float32s, Int64s
from slam_core.results import MatchResult, PlanarGaussian

# A residual above FREE there: free space, no wall within a cell. `Pyramid.unexpected` asks for 0.15 m to what is
# occupied, and whoever has walked 0.2 m is nearer than that to the cells of the scan before.
LEVEL, FREE = 1, 0.6
GAP, EXTENT = 0.3, 1.5  # metres between endpoints on one object, and from one end of it to the other, at most
OBJECTS = 2  # that move at once
NEARER = 0.5  # of the distance between match and prediction
BETTER = 0.95  # of the cost of eq. (7) of the other beams
KNOWN = 0.9  # of the share of them on known cells before: an unknown cell costs less than free space


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
            return other._replace(residuals=residuals(pyramid.levels[0], points, other.pose))
    return None


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
        and other.fit.known >= max(MOSTLY, KNOWN * match.fit.known)
        and float(np.square(other.residuals).sum()) <= BETTER * float(np.square(before).sum())
    )
