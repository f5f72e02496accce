"""Deskew refinement: without inertial data a match gives a better motion of the sweep than the prediction."""

import numpy as np

from slam_core.config import SlamConfig
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.matcher import coarse_to_fine
from slam_core.measurements import LaserScan
from slam_core.navigation.planar_motion import PlanarMotion
from slam_core.results import MatchResult, PlanarGaussian
from slam_core.scan.stabilise import StabilisedScan, stabilise

# Metres, metres, radians: a motion that moves the ends of the sweep by less is no other motion.
SAME_SHIFT = np.array([0.002, 0.002, 0.001])


def refine(
    scan: LaserScan,
    stabilised: StabilisedScan,
    match: MatchResult,
    prior: PlanarGaussian | None,
    pyramid: Pyramid,
    motion: PlanarMotion,
    config: SlamConfig,
) -> tuple[StabilisedScan, MatchResult]:
    """Place the beams by the motion fused with their match and match again, as long as eq. (7) becomes smaller.

    motion: the estimate before the match; it is left as it is. prior: as in `coarse_to_fine`.
    Returns the scan and match to go on with, at first those given.
    """
    half_sweep = 0.5e-9 * (scan.end_ns - scan.stamp_ns) if config.scan.deskew else 0.0
    twist = motion.twist
    for _ in range(config.motion.deskew_refinements):
        seen = fused(motion, match, config)
        if (np.abs(seen.twist - twist) * half_sweep < SAME_SHIFT).all():
            break
        twist = seen.twist
        again = placed_by(seen, scan, match, prior, pyramid, config)
        if again is None or cost(again[1]) >= cost(match):
            break
        stabilised, match = again
    return stabilised, match


def fused(motion: PlanarMotion, match: MatchResult, config: SlamConfig) -> PlanarMotion:
    """The motion that a match shows: a copy of the estimate before it, fused with it."""
    seen = motion.copy()
    seen.fuse(match.gaussian, config.fusion)
    return seen


def placed_by(
    motion: PlanarMotion,
    scan: LaserScan,
    match: MatchResult,
    prior: PlanarGaussian | None,
    pyramid: Pyramid,
    config: SlamConfig,
) -> tuple[StabilisedScan, MatchResult] | None:
    """The beams as a motion places them, matched from an earlier match; None if no beam is left."""
    placed = stabilise(scan, motion.poses, config.scan)
    if not len(placed.points):
        return None
    return placed, coarse_to_fine(pyramid, placed.points, match.pose, config.matcher, prior=prior)


def cost(match: MatchResult) -> float:
    """Eq. (7), the mean over the beams: sweeps may differ in how many they keep."""
    return float(np.mean(np.square(match.residuals)))
