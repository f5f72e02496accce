"""How long the sweep of a laser takes, by how well its scans fit, where the messages give no time_increment."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hectorscope.ros.repairs import with_sweep
from slam_core.config import SlamConfig
from slam_core.measurements import LaserScan
from slam_core.slam import HectorSlam

MOST_SCANS = 500
FEWEST_SCANS = 50
COARSE, FINE = (-1.0, -0.5, 0.5, 1.0), 0.25  # shares of the time that a circle takes
CLEAR = 0.9  # of the residual of scans that are taken at once


@dataclass(frozen=True, slots=True)
class SweepTime:
    """The duration of a sweep, seconds, under which the scans fit best; negative: the last beam is the first.

    residual, at_once: mean residuals of the matches under it, and of scans that are taken at once.
    """

    seconds: float
    residual: float
    at_once: float

    @property
    def is_clear(self) -> bool:
        """Whether the scans fit so much better that it is no chance."""
        return self.residual < CLEAR * self.at_once


def estimate(scans: Sequence[LaserScan], period_s: float) -> SweepTime | None:
    """By matching the scans alone; None where they are few or have their times.

    period_s: from one scan of the laser to its next, which a full circle takes at most.
    """
    scans = scans[:MOST_SCANS]
    if len(scans) < FEWEST_SCANS or any(scan.time_increment for scan in scans):
        return None
    circle = min(abs(scans[0].angle_increment) * len(scans[0].ranges) / (2.0 * np.pi), 1.0)
    longest_s = circle * period_s
    at_once = residual(scans, 0.0)
    found = {share: residual(scans, share * longest_s) for share in COARSE} | {0.0: at_once}
    best = min(found, key=lambda share: found[share])
    found |= {
        share: residual(scans, share * longest_s) for share in (best - FINE, best + FINE) if abs(share) <= 1.0
    }
    best = min(found, key=lambda share: found[share])
    return SweepTime(float(best * longest_s), found[best], at_once)


def residual(scans: Sequence[LaserScan], sweep_s: float) -> float:
    """Mean residual of the matches of scans as if their sweeps took so long."""
    slam = HectorSlam(SlamConfig())
    results = [slam.step(with_sweep(scan, sweep_s)) for scan in scans]
    return float(np.mean([each.match.mean_residual for each in results if each and each.match] or [np.inf]))
