"""Other motions that a scan may have been taken in, where nothing but matches observes the motion.

A robot that begins or ends a turn between two slow scans is not where the model of constant velocity predicts it,
and its sweep is distorted otherwise than assumed. Each hypothesis is the prediction given that the heading, or the
way along it, is so much off: it places the beams and starts a match.
"""

import math
from collections.abc import Iterator

import numpy as np

from slam_core import geometry
from slam_core.config import SlamConfig
from slam_core.localization.deskew_refinement import cost, fused, placed_by, refine
from slam_core.localization.dynamic_beams import background_cost
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
STRAIGHT = 0.02  # radians: half a sweep that is bent by less may still be that of the match
FAR = 0.001  # added to the mean cost of a beam for a match one sigma from the prediction


def best_match(
    scan: LaserScan,
    aligned: tuple[StabilisedScan, MatchResult],
    prior: PlanarGaussian,
    pyramid: Pyramid,
    motion: PlanarMotion,
    config: SlamConfig,
) -> tuple[StabilisedScan, MatchResult] | None:
    """The match of the hypothesis with the lowest cost of eq. (7); None if none is clearly better than `aligned`.

    motion: the estimate before the match, predicted to the scan; it is left as it is. By a motion that follows
    somebody who walks the background fits worse: it is not taken.
    """
    match = aligned[1]
    best, lowest, background = None, BETTER * _judged(match, prior), background_cost(*aligned)
    for seen in hypotheses(motion):
        placed = stabilise(scan, seen.poses, config.scan)
        if not len(placed.points):
            continue
        found = coarse_to_fine(pyramid, placed.points, seen.planar.mean, config.matcher, prior=prior)
        candidate = refine(scan, placed, found, prior, pyramid, motion, config)
        if _judged(candidate[1], prior) < lowest and is_bent(candidate, prior, motion, scan, config):
            straight = placed_by(fused(motion, candidate[1], config), scan, candidate[1], prior, pyramid, config)
            if straight is None:
                continue
            candidate = straight
        judged = _judged(candidate[1], prior)
        is_known = candidate[1].fit.known >= KNOWN * match.fit.known
        if judged < lowest and is_known and background_cost(*candidate) <= background:
            best, lowest = candidate, judged
    return best


def is_bent(
    candidate: tuple[StabilisedScan, MatchResult],
    prior: PlanarGaussian,
    motion: PlanarMotion,
    scan: LaserScan,
    config: SlamConfig,
) -> bool:
    """Whether the beams were placed by a turn that their own match does not show.

    A base that turns otherwise than predicted all through a sweep has done so by half of it at its middle, at
    least. A sweep that is bent for no such reason may still fit better: noise wears off the near side of walls in
    the map, and the bend leads the endpoints behind them.
    """
    placed, match = candidate
    sweep = 1e-9 * (scan.end_ns - scan.stamp_ns) if config.scan.deskew else 0.0
    turned = geometry.heading(placed.poses[-2, :4]) - geometry.heading(placed.poses[0, :4])
    bend = geometry.wrap(turned - motion.twist[2] * sweep)
    return 0.5 * abs(bend) > abs(geometry.wrap(match.pose[2] - prior.mean[2])) + STRAIGHT


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
