"""Section IV: from ranges to endpoints in the stabilised frame."""

import numpy as np

from slam_core import geometry
from slam_core.config import ScanConfig
from slam_core.measurements import Float64s, LaserScan


def stabilise(scan: LaserScan, attitude: Float64s, config: ScanConfig) -> tuple[Float64s, Float64s]:
    """Endpoints (n, 2) and the laser (2,) in the stabilised frame, metres.

    attitude: (4,) quaternion of the base in the map. The stabilised frame has its origin and heading and is
    level. Beams out of range or out of the band of heights around the laser are left out.
    """
    angles = scan.angle_min + scan.angle_increment * np.arange(len(scan.ranges))
    ranges = np.asarray(scan.ranges, float)
    low, high = max(config.range_min, scan.range_min), min(config.range_max, _end_of_range(ranges, scan.range_max))
    kept = (ranges >= low) & (ranges < high)
    beams = ranges[kept, None] * np.column_stack([np.cos(angles[kept]), np.sin(angles[kept]), 0.0 * angles[kept]])
    mount = scan.T_base_laser
    in_base = geometry.rotate(mount.rotation, beams) + mount.translation
    tilt = geometry.split_heading(attitude)[1]  # the attitude without its heading
    points, laser = geometry.rotate(tilt, in_base), geometry.rotate(tilt, mount.translation)
    heights = points[:, 2] - laser[2]
    band = (heights >= config.z_min) & (heights <= config.z_max)
    return points[band, :2], laser[:2]


def _end_of_range(ranges: Float64s, range_max: float) -> float:
    """Where endpoints end: before ranges that are the end of the laser's range with noise, as nothing returned."""
    ended = (ranges >= range_max) & (ranges <= range_max + 0.1)
    near = (ranges >= range_max - 0.1) & (ranges < range_max)
    noisy = 50 * ended.sum() >= len(ranges) and 4 * near.sum() >= ended.sum() and not np.isposinf(ranges).any()
    return range_max - 0.1 if noisy else range_max
