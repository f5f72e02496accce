"""Section IV: from a sweep to endpoints in the stabilised frame, through mount, attitude and motion."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from slam_core import geometry
from slam_core.config import ScanConfig
from slam_core.kernels.planar import knots
from slam_core.kernels.sweeping import place_beams
from slam_core.measurements import Float32s, Float64s, LaserScan, Transform

# Positions (k, 3) and attitudes (k, 4) of the base in the map at so many instants in nanoseconds.
Motion = Callable[[Sequence[int]], tuple[Float64s, Float64s]]
# The motion is taken as linear between instants this far apart.
KNOT_NS = 10_000_000


@dataclass(frozen=True, slots=True, eq=False)
class StabilisedScan:
    """A scan turned level: points (n, 2) and heights (n,) over the laser; cleared (m, 2) ends of empty beams.

    laser: (2,) where the beams start. All in the stabilised frame at the middle of the sweep, metres.
    """

    points: Float32s
    heights: Float32s
    cleared: Float32s
    laser: Float64s


def stabilise(scan: LaserScan, motion: Motion, config: ScanConfig) -> StabilisedScan:
    """Endpoints of `scan` in the stabilised frame at scan.mid_ns; the motion is asked for instants of the sweep.

    Beams out of range, without a value (REP-117) or out of the z band are left out. With config.stabilise off the
    attitude is ignored, with config.deskew off the motion during the sweep is.
    """
    n = len(scan.ranges)
    way = _knots(scan, motion, config)
    z_laser = 0.5 * (way[0, 2, 3] + way[-1, 2, 3])
    cosines, sines = _directions(scan.angle_min, scan.angle_increment, n)
    points, zs, free = (np.empty(shape, np.float32) for shape in ((n, 2), n, (n, 2)))
    kept, cleared = place_beams(
        np.ascontiguousarray(scan.ranges, np.float32), cosines, sines, way, max(n - 1, 1) / (len(way) - 1),
        max(config.range_min, scan.range_min), min(config.range_max, _end(scan.range_max)), scan.range_max,
        config.clear_range, z_laser + config.z_min, z_laser + config.z_max, points, zs, free,
    )  # fmt: skip
    laser = 0.5 * (way[0, :2, 3] + way[-1, :2, 3])
    return StabilisedScan(points[:kept], zs[:kept] - np.float32(z_laser), free[:cleared], laser)


def _end(range_max: float) -> float:
    return range_max if range_max > 0.0 else float("inf")


@lru_cache(maxsize=8)
def _directions(angle_min: float, angle_increment: float, n: int) -> tuple[Float64s, Float64s]:
    angles = angle_min + angle_increment * np.arange(n)
    return np.cos(angles), np.sin(angles)


def _knots(scan: LaserScan, motion: Motion, config: ScanConfig) -> Float64s:
    """(k, 3, 4) transforms from the laser to the stabilised frame at mid-sweep, in k - 1 equal steps of time."""
    stamp_ns, end_ns = scan.stamp_ns, scan.end_ns
    sweep_ns = end_ns - stamp_ns
    times = [(stamp_ns + end_ns) // 2]
    if config.deskew and sweep_ns > 0:
        k = 2 + sweep_ns // KNOT_NS
        times += [stamp_ns + sweep_ns * i // (k - 1) for i in range(k)]
    else:
        times *= 3
    placed: Float64s = knots(*motion(times), _mount(scan.T_base_laser), config.stabilise)
    return placed


@lru_cache(maxsize=8)
def _mount(T_base_laser: Transform) -> Float64s:
    return geometry.matrix(T_base_laser)
