"""What a prediction by wheels weighs against the scan.

Beams beside each other err together: a scan of a few hundred of them knows less than eq. (15) claims. Where
somebody walks along with the robot, or the map ends, its match drifts off by decimetres a scan, each time by many
standard deviations of the prediction. So a prediction by wheels weighs more. Unless the wheels slip: then known
walls fit clearly worse.
"""

from dataclasses import replace

import numpy as np

from slam_core import geometry
from slam_core.config import SlamConfig
from slam_core.localization.dynamic_beams import fit_clearly_better, foreground
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.matcher import residuals
from slam_core.measurements import Float32s
from slam_core.results import MatchResult, PlanarGaussian

REACH, TURN = 0.4, 0.4  # metres, radians: further off, a scan's own match is no slip of wheels between two scans
UNKNOWN = 0.01  # a residual so near to 0.5 is that of an unknown cell, which tells nothing
MOST = 0.5  # of the beams have to end on known cells, and on no object that may move
SIGMAS = 3.0  # standard deviations by which these beams fit better


def weighed(config: SlamConfig) -> SlamConfig:
    """Settings of a match whose prediction is by wheels."""
    weight = config.matcher.wheels_weight
    return replace(config, matcher=replace(config.matcher, prior_weight=weight)) if weight > 0.0 else config


def slipped(
    pyramid: Pyramid, points: Float32s, match: MatchResult, alone: MatchResult, prior: PlanarGaussian
) -> bool:
    """Whether a scan contradicts its prediction by wheels.

    points: (n, 2) endpoints as the prediction places them, metres. match: with the weight of wheels; alone: with
    that of other predictions. It is the better one if known walls in the background fit clearly better there.
    """
    turn = abs(geometry.wrap(alone.pose[2] - prior.mean[2]))
    if prior.distance_to(alone.pose) > REACH or turn > TURN:
        return False
    before, after = (residuals(pyramid.levels[0], points, each.pose) for each in (match, alone))
    known = (np.abs(before - 0.5) > UNKNOWN) & (np.abs(after - 0.5) > UNKNOWN)
    used = known & ~foreground(points, sees_past=True)
    if np.count_nonzero(used) < MOST * len(points):
        return False
    return fit_clearly_better(before[used], after[used], SIGMAS)
