"""A match along whose weakest direction inertial data know better.

A few beams may say how far a robot has come along a corridor: those that end on a jamb, on somebody, on an opening
that the map does not hold yet. Eq. (15) claims millimetres for them, and one wrong match gives the filter a speed
that it keeps until the next.
"""

from dataclasses import replace

from slam_core.config import MatcherConfig, SlamConfig
from slam_core.kernels.coarse_to_fine import SURVEYED
from slam_core.kernels.confirmed import confirmed_share
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.matcher import beams_of, level_of
from slam_core.measurements import Float32s, Float64s
from slam_core.results import FEW, MatchResult, PlanarGaussian

CONTRADICTS = 3.0  # sigmas of match and prediction


def few_mislead(
    pyramid: Pyramid, points: Float32s, match: MatchResult, prior: PlanarGaussian, config: MatcherConfig
) -> bool:
    """Whether few beams fix a direction, and inertial data contradict or the map does not confirm them.

    points: (n, 2) endpoints in the stabilised frame, metres. prior: what inertial data predict. It is off where
    `degeneracy_threshold` is 0.
    """
    least = config.degeneracy_threshold
    if not match.is_badly_fixed or match.leaves_direction or least <= 0.0:
        return False
    direction = match.weakest_direction
    off = float(direction @ (match.pose - prior.mean)[:2])
    variance = float(direction @ (match.covariance + prior.covariance)[:2, :2] @ direction)
    return off * off > CONTRADICTS**2 * variance or confirmed(pyramid, points, match.pose) < least


def confirmed(pyramid: Pyramid, points: Float32s, pose: Float64s) -> float:
    """The share of the beams that fix the weakest direction of a scan, and do so in the map as well.

    points: (n, 2), of which SURVEYED or more are looked at. pose: (3,) of the scan in the map.
    """
    finest, step = pyramid.levels[0], max(1, len(points) // SURVEYED)
    return float(confirmed_share(level_of(finest), finest.surfels, beams_of(points[::step]), pose))


def few_as_none(config: SlamConfig) -> SlamConfig:
    """Settings of a match in which a direction that few beams fix is unobservable."""
    threshold = max(config.matcher.degeneracy_threshold, FEW)
    return replace(config, matcher=replace(config.matcher, degeneracy_threshold=threshold))
