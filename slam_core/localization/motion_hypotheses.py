"""Other motions that a scan may have been taken in, where nothing but matches observes the motion.

A robot that begins or ends a turn between two slow scans is not where the model of constant velocity predicts it,
and its sweep is distorted otherwise than assumed. Each hypothesis is the prediction given that the heading, or the
way along it, is so much off: it places the beams and starts a match.
"""

import math
from collections.abc import Iterator

import numpy as np

from slam_core.config import SlamConfig
from slam_core.localization.deskew_refinement import cost, refine
from slam_core.localization.tracking import mahalanobis_distance
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.matcher import coarse_to_fine
from slam_core.measurements import LaserScan
from slam_core.navigation.planar_motion import PlanarMotion
from slam_core.results import MatchResult, PlanarGaussian
from slam_core.scan.stabilise import StabilisedScan, stabilise

TURN, WAY = 0.2, 0.2  # radians, metres between hypotheses: the matcher converges over half of that
MOST_TURNS, MOST_WAYS = 7, 2  # to each side
SIGMAS = 3.0  # of the prediction that hypotheses cover
BETTER = 0.9  # of the cost of the match so far
KNOWN = 0.8  # of the endpoints on known cells so far: an unknown cell costs less than free space
FAR = 0.001  # added to the mean cost of a beam for a match one sigma from the prediction


def best_match(
    scan: LaserScan,
    match: MatchResult,
    prior: PlanarGaussian,
    pyramid: Pyramid,
    motion: PlanarMotion,
    config: SlamConfig,
) -> tuple[StabilisedScan, MatchResult] | None:
    """The match of the hypothesis with the lowest cost of eq. (7); None if none is clearly better than `match`.

    motion: the estimate before the match, predicted to the scan; it is left as it is.
    """
    best, lowest = None, BETTER * _judged(match, prior)
    for seen in hypotheses(motion):
        placed = stabilise(scan, seen.poses, config.scan)
        if not len(placed.points):
            continue
        found = coarse_to_fine(pyramid, placed.points, seen.planar.mean, config.matcher, prior=prior)
        candidate = refine(scan, placed, found, prior, pyramid, motion, config)
        judged = _judged(candidate[1], prior)
        if judged < lowest and candidate[1].fit.known >= KNOWN * match.fit.known:
            best, lowest = candidate, judged
    return best


def hypotheses(motion: PlanarMotion) -> Iterator[PlanarMotion]:
    """Estimates whose heading, or place along it, differs from that of `motion`, as far as it may."""
    covariance, psi = motion.planar.covariance, motion.planar.mean[2]
    ahead = np.array([math.cos(psi), math.sin(psi), 0.0])
    for direction, step, most in ((np.array([0.0, 0.0, 1.0]), TURN, MOST_TURNS), (ahead, WAY, MOST_WAYS)):
        reach = SIGMAS * math.sqrt(float(direction @ covariance @ direction))
        for k in range(1, min(most, math.ceil(reach / step - 0.25)) + 1):
            yield motion.given(direction, -k * step)
            yield motion.given(direction, k * step)


def _judged(match: MatchResult, prior: PlanarGaussian) -> float:
    return cost(match) + FAR * min(mahalanobis_distance(match, prior), 10.0) ** 2
