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
    low, high = max(config.range_min, scan.range_min), min(config.range_max, scan.range_end)
    kept = (ranges >= low) & (ranges < high)
    beams = ranges[kept, None] * np.column_stack([np.cos(angles[kept]), np.sin(angles[kept]), 0.0 * angles[kept]])
    mount = scan.T_base_laser
    in_base = geometry.rotate(mount.rotation, beams) + mount.translation
    tilt = geometry.split_heading(attitude)[1]  # the attitude without its heading
    points, laser = geometry.rotate(tilt, in_base), geometry.rotate(tilt, mount.translation)
    heights = points[:, 2] - laser[2]
    band = (heights >= config.z_min) & (heights <= config.z_max)
    return points[band, :2], laser[:2]
