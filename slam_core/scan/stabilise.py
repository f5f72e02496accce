"""Section IV: from a sweep to endpoints in the stabilised frame, through mount, attitude and motion."""

import math
from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from slam_core import geometry
from slam_core.config import ScanConfig
from slam_core.kernels.endpoints import end_of_range, place_beams
from slam_core.measurements import FARTHEST_LASER, Float32s, Float64s, Int64s, LaserScan, Transform

# Attitude and position of the base in the map, (k, 7) or wider, at instants (k,) that are nanoseconds after one.
Motion = Callable[[int, Int64s], Float64s]
# The motion is taken as linear between instants this far apart.
KNOT_NS = 10_000_000
STANDING = np.zeros(3, np.int64)
NO_END = np.empty((0, 2), np.float32)
NO_POSE = np.empty((0, 7))


class StabilisedScan(NamedTuple):
    """A scan turned level: points (n, 2) and heights (n,) over the laser; cleared (m, 2) ends of empty beams.

    laser: (2,) where the beams start. All in the stabilised frame at the middle of the sweep, metres.
    poses: of the base during the sweep, as `place_beams` takes them. facing: the eighth of the circle that the
    laser looks to on its base, which tells the lasers of a robot apart.
    """

    points: Float32s
    heights: Float32s
    cleared: Float32s
    laser: Float64s
    poses: Float64s = NO_POSE
    facing: int = 0


def stabilise(scan: LaserScan, motion: Motion, config: ScanConfig) -> StabilisedScan:
    """Endpoints of `scan` in the stabilised frame at scan.mid_ns; the motion is asked for instants of the sweep.

    Beams out of range, without a value (REP-117) or out of the z band are left out, and all of a laser whose
    mount is not plausible. With config.stabilise off the
    attitude is ignored, with config.deskew off the motion during the sweep is.
    """
    n = len(scan.ranges) if _is_mounted(scan.T_base_laser) else 0
    points, heights, laser = np.empty((n, 2), np.float32), np.empty(n, np.float32), np.empty(2)
    free = np.empty((n, 2), np.float32) if config.clear_range > 0.0 else NO_END
    poses = motion(*_instants(scan, config))
    ranges = np.ascontiguousarray(scan.ranges[:n], np.float32)
    kept, cleared = place_beams(
        ranges,
        directions(scan.angle_min, scan.angle_increment, n),
        poses,
        _mount(scan.T_base_laser),
        config.stabilise,
        (
            max(config.range_min, scan.range_min),
            min(config.range_max, end_of_range(ranges, scan.range_max)),
            scan.range_max,
            config.clear_range,
            config.z_min,
            config.z_max,
        ),
        (points, heights, free, laser),
    )
    return StabilisedScan(points[:kept], heights[:kept], free[:cleared], laser, poses, _facing(scan.T_base_laser))


@lru_cache(maxsize=8)
def directions(angle_min: float, angle_increment: float, n: int) -> tuple[Float64s, Float64s]:
    """Cosines and sines (n,) of the beams."""
    angles = angle_min + angle_increment * np.arange(n)
    return np.cos(angles), np.sin(angles)


def _instants(scan: LaserScan, config: ScanConfig) -> tuple[int, Int64s]:
    """Two at least in equal steps from the begin of the sweep to its end, and the middle of it; as of `Motion`."""
    sweep_ns = scan.end_ns - scan.stamp_ns
    if not config.deskew or sweep_ns <= 0:
        return scan.stamp_ns + sweep_ns // 2, STANDING
    return scan.stamp_ns, _steps(sweep_ns)


@lru_cache(maxsize=8)
def _steps(sweep_ns: int) -> Int64s:
    steps = 1 + sweep_ns // KNOT_NS
    return np.array([*[sweep_ns * i // steps for i in range(steps + 1)], sweep_ns // 2])


@lru_cache(maxsize=8)
def _is_mounted(T_base_laser: Transform) -> bool:
    """Whether the mount is plausible: the lattice has no cells for endpoints too far away."""
    return bool(np.abs(T_base_laser.translation).max() <= FARTHEST_LASER)


@lru_cache(maxsize=8)
def _facing(T_base_laser: Transform) -> int:
    eighths = geometry.heading(T_base_laser.rotation) / (0.25 * math.pi)
    return round(eighths) % 8 if math.isfinite(eighths) else 0


@lru_cache(maxsize=8)
def _mount(T_base_laser: Transform) -> Float64s:
    return geometry.matrix(T_base_laser)
