"""Beams on an object that moves: where nothing but matches observes the motion, they may drag a match along.

Somebody who walks ahead of a robot in a corridor is hit by more beams than all that tells how far the robot has
come. A match that follows the person is far from the prediction, but so is one of a robot that brakes. What tells
them apart is the rest of the scan: it fits better at the true pose.
"""

import numpy as np

from slam_core.config import MatcherConfig
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.matcher import coarse_to_fine, residuals
from slam_core.measurements import Float32s
from slam_core.results import MatchResult, PlanarGaussian

LEVEL, FREE = 1, 0.6  # a residual there above this: free space, no wall within a cell
MOST = 0.3  # of the beams may end in free space at the prediction; where more do, the prediction is wrong
NEARER = 0.5  # of the distance between match and prediction
BETTER = 0.95  # of the cost of eq. (7) of the other beams
# Of them on known cells, and of the share before: an unknown cell costs less than free space.
MOSTLY, KNOWN = 0.6, 0.9


def match_without(
    pyramid: Pyramid, points: Float32s, match: MatchResult, prior: PlanarGaussian, config: MatcherConfig
) -> MatchResult | None:
    """The match without the beams that end in free space at the prediction; None if the others fit no better so.

    points: (n, 2) endpoints in the stabilised frame as the prediction places them, metres. match: of all beams.
    """
    pyramid.cover(points, prior.mean)
    dynamic = residuals(pyramid.levels[min(LEVEL, len(pyramid.levels) - 1)], points, prior.mean) > FREE
    share = float(np.mean(dynamic))
    if not 0.0 < share <= MOST or len(match.residuals) != len(points):
        return None
    static = coarse_to_fine(pyramid, points[~dynamic], prior.mean, config, prior=prior)
    if prior.distance_to(static.pose) > NEARER * prior.distance_to(match.pose):
        return None
    if static.fit.known < max(MOSTLY, KNOWN * match.fit.known):
        return None
    if np.square(static.residuals).sum() > BETTER * np.square(match.residuals[~dynamic]).sum():
        return None
    return static._replace(residuals=residuals(pyramid.levels[0], points, static.pose))
