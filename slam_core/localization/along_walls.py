"""How far a robot came along walls that look the same everywhere: to the place where most of the beams fit.

A jamb or the edge of a box stops few of a thousand beams. The shape of the scan counts them as next to none, and
in eq. (12) the noise of all others outweighs them. But beside the right place beams miss what was there, and
others end where nothing was: by the number of them the place is known to some centimetres, wherever it is within
reach.
"""

import math
from typing import NamedTuple

import numpy as np

from slam_core.kernels.coarse_to_fine import SURVEYED, survey
from slam_core.kernels.correlative import count_near_hits
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.matcher import beams_of
from slam_core.measurements import Float32s, Float64s
from slam_core.results import NOWHERE, MatchResult, PlanarGaussian

STEP = 0.05  # metres between the places that are compared
# As far off as so many sigmas of the prediction, but between these limits in metres.
SIGMAS, NEAREST, FARTHEST = 3.0, 0.3, 1.0
UNKNOWN = 0.2  # of a miss counts an end on an unknown cell: where it is right it will be a hit, mostly
# So many of the ends lie on known cells of the best places; else the weight of an unknown one decides.
KNOWN = 0.9
SAME = 1.0  # miss more or less is no difference between two places
# A place is better than another if this has so many times its misses, and so many more.
TIMES, ENOUGH = 1.5, 8.0
BESIDE = 0.3  # metres beside the best places on both sides, for these to be the only ones
LEAST_SIGMA = 0.08  # metres, of the middle of the best places; it has half of the cells behind it


class Along(NamedTuple):
    """offset: (2,) metres in the map from the match to the middle of the best places.

    sigma: of the middle, metres; infinite where the scan may lie further off as well. is_better: whether more
    beams fit there than at the match.
    """

    offset: Float64s
    sigma: float
    is_better: bool

    @property
    def is_observed(self) -> bool:
        """Whether the scan fits at these places alone."""
        return math.isfinite(self.sigma)


def best_along(pyramid: Pyramid, points: Float32s, match: MatchResult, prior: PlanarGaussian) -> Along | None:
    """The best places along a direction that few beams fix; None if there is none, or if these tell nothing.

    points: (n, 2) endpoints in the stabilised frame, metres. What counts is the beams that miss, and half the
    square of the way in sigmas of the prediction.
    """
    if not match.is_badly_fixed:
        return None
    direction = match.unobservable if match.leaves_direction else _worst(points, match.pose)
    sigma = math.sqrt(max(float(direction @ prior.covariance[:2, :2] @ direction), 1e-12))
    count = round((min(max(SIGMAS * sigma, NEAREST), FARTHEST) + BESIDE) / STEP)
    shifts, counts = np.arange(-count, count + 1) * STEP, np.empty((2 * count + 1, 2), np.int32)
    poses = np.tile(match.pose, (len(shifts), 1))
    poses[:, :2] += shifts[:, None] * direction
    finest = pyramid.levels[0]
    count_near_hits(finest.cells, finest.corner, 1.0 / finest.resolution, points, poses, counts)
    known, hits = counts.T
    unfit = known - hits + UNKNOWN * (len(points) - known)
    first, last = _best(unfit + 0.5 * np.square(shifts / sigma), count)
    if known[(first + last) // 2] < KNOWN * len(points):
        return None
    margin = round(BESIDE / STEP)
    beside = unfit[: max(first - margin, 0)], unfit[last + 1 + margin :]
    exceeded = TIMES * unfit[first : last + 1].min() + ENOUGH
    is_observed = all(len(side) and side.min() >= exceeded for side in beside)
    is_better = bool(unfit[count] >= TIMES * unfit[(first + last) // 2] + ENOUGH)
    if not (is_observed or is_better):
        return None
    spread = max(LEAST_SIGMA, 0.3 * STEP * (last - first)) if is_observed else math.inf
    return Along(0.5 * (shifts[first] + shifts[last]) * direction, spread, is_better)


def measured(match: MatchResult, along: Along) -> MatchResult:
    """A match that leaves a direction open, with what the best places along it tell."""
    open_way = match.unobservable
    if not (along.is_observed and open_way.any()):
        return match
    covariance = match.covariance.copy()
    variance = float(open_way @ covariance[:2, :2] @ open_way)
    covariance[:2, :2] += (along.sigma**2 - variance) * np.outer(open_way, open_way)
    return match._replace(unobservable=NOWHERE, covariance=covariance)


def _worst(points: Float32s, pose: Float64s) -> Float64s:
    """(2,) the direction in the map that the shape of a scan fixes worst."""
    direction: Float64s = survey(beams_of(points[:: max(1, len(points) // SURVEYED)]), pose[2])[:2]
    return direction


def _best(unfit: Float64s, middle: int) -> tuple[int, int]:
    """First and last of the places around the best one that are as good; of several best the one in the middle."""
    best = np.flatnonzero(unfit == unfit.min())
    first = last = int(best[np.argmin(np.abs(best - middle))])
    most = unfit[first] + SAME
    while first > 0 and unfit[first - 1] <= most:
        first -= 1
    while last < len(unfit) - 1 and unfit[last + 1] <= most:
        last += 1
    return first, last
