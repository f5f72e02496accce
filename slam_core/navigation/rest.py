"""Whether a base rests, by what its laser sees: inertial data at rest and at a constant velocity are alike."""

import numpy as np

from slam_core.measurements import Float64s, LaserScan

# At rest three quarters of the ranges differ by less than so many metres, or standard deviations of their noise.
FARTHEST, SIGMAS = 0.05, 4.0
MEDIAN_SIGMAS = 0.6745 * 6.0**0.5  # the median size of r[i-1] - 2 r[i] + r[i+1], in deviations of r
FEWEST = 20  # beams


def shows_motion(first: LaserScan, scan: LaserScan) -> bool:
    """Whether the base has moved since the first of two scans, by more than their noise hides.

    Only scans with the same beams and mount tell: a servo may have turned the laser.
    """
    if len(first.ranges) != len(scan.ranges) or not np.array_equal(_beams(first), _beams(scan)):
        return False
    seen = np.isfinite(first.ranges) & np.isfinite(scan.ranges)
    before, now = first.ranges[seen].astype(np.float64), scan.ranges[seen].astype(np.float64)
    if len(now) < FEWEST:
        return False
    noise = float(np.median(np.abs(np.diff(now, 2)))) / MEDIAN_SIGMAS
    return bool(np.quantile(np.abs(now - before), 0.75) > max(FARTHEST, SIGMAS * noise))


def _beams(scan: LaserScan) -> Float64s:
    """(9,) the angles of its beams, and the mount."""
    mount = scan.T_base_laser
    return np.array([scan.angle_min, scan.angle_increment, *mount.translation, *mount.rotation])
