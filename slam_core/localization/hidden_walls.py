"""Scans in which something near the laser hides walls: people around the robot, a hand, a sheet of paper.

Their beams end in what the map knows as free space, and few cross walls. Where the pose is wrong, many do.
"""

import numpy as np
from numpy.typing import NDArray

from slam_core.config import MatcherConfig
from slam_core.localization.confirmation import is_vague
from slam_core.localization.dynamic_beams import of_all
from slam_core.localization.map_view import crossings, looked_at
from slam_core.localization.tracking import NEAR, exceeds_basin, is_good, mahalanobis_distance
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.matcher import coarse_to_fine
from slam_core.measurements import Float64s
from slam_core.results import MatchResult, PlanarGaussian, Rejection
from slam_core.scan.stabilise import StabilisedScan

MOST = 0.6  # of the beams of a scan: one that hides so many walls shows too little of the map
SOME = 0.1  # from so many on, the others are matched without them
LEAST = 0.25  # of the beams: fewer on known cells, or fewer others to match, tell too little
CROSSING = 0.1  # of the beams: if more cross walls, the pose is wrong
BEAMS = 60  # of a scan that are followed
TRUSTED_NS = 10_000_000_000  # for which a scan counts as covered where the prediction is vague


def covered(
    pyramid: Pyramid, scan: StabilisedScan, prior: PlanarGaussian, sure: Float64s, lapse_ns: int
) -> Rejection | None:
    """Why a match tells nothing: most walls are hidden where the scan is predicted; None if they are not.

    On the way out of the map its endpoints on known cells tell.

    sure: (3,) the last pose that was sure. With a vague prediction they may be hidden there, too; with a vague
    heading there alone. lapse_ns: since the last scan that was not covered.
    """
    vague = is_vague(prior)
    if vague and lapse_ns >= TRUSTED_NS:
        return None
    found = None if exceeds_basin(prior) else hidden(pyramid, scan, prior.mean, MOST, of_known=True)
    if found is None and vague:
        found = hidden(pyramid, scan, sure, MOST)
    return _rejection(found, MOST)


def match_visible(
    pyramid: Pyramid, scan: StabilisedScan, prior: PlanarGaussian, usual: float, config: MatcherConfig
) -> MatchResult | None:
    """The match near an inertial prediction without the beams that end before walls.

    None if there are few of those, or the others do not fit. usual: the mean inlier ratio.
    """
    before = None if is_vague(prior) else hidden(pyramid, scan, prior.mean, SOME)
    if before is None or np.count_nonzero(~before) < LEAST * len(before):
        return None
    match = coarse_to_fine(pyramid, scan.points[~before], prior.mean, config, prior=prior)
    if not is_good(match.fit, usual) or mahalanobis_distance(match, prior) > NEAR:
        return None
    return of_all(match, pyramid, scan.points, ~before)


def misled(pyramid: Pyramid, scan: StabilisedScan, match: MatchResult, prior: PlanarGaussian) -> Rejection | None:
    """Why a match far from an inertial prediction is not believed: walls are hidden there; None if it is."""
    if is_vague(prior) or mahalanobis_distance(match, prior) <= NEAR:
        return None
    return _rejection(hidden(pyramid, scan, prior.mean, SOME), SOME)


def _rejection(found: NDArray[np.bool_] | None, limit: float) -> Rejection | None:
    return None if found is None else Rejection("hidden", float(np.mean(found)), limit)


def hidden(
    pyramid: Pyramid, scan: StabilisedScan, pose: Float64s, least: float, *, of_known: bool = False
) -> NDArray[np.bool_] | None:
    """(n,) which beams of a scan at a pose (3,) end before the walls of the map.

    None if these are a smaller share than `least`, of all or of those on known cells, or if many cross walls.
    """
    known = looked_at(pyramid, scan, pose)[0].known if of_known else 1.0
    pyramid.cover(scan.points, pose)
    found = pyramid.unexpected(scan.points, pose)
    if known < LEAST or np.mean(found) < least * known:
        return None
    followed, crossed = crossings(pyramid, scan, pose, BEAMS)
    return found if crossed <= CROSSING * followed else None
