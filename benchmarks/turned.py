"""A simulated drive as a robot would have recorded it whose base looks another way."""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import lru_cache

import numpy as np

from hectorscope.inputs import Item
from slam_core import geometry
from slam_core.measurements import Height, Imu, LaserScan, Transform, TruthPose


def angle_of(seed: int) -> float:
    """Another one for each seed, between 0 and a right angle, radians."""
    return float(np.random.default_rng([seed, 9]).uniform(0.0, np.pi / 2.0))


def turned(items: Iterable[Item], angle: float) -> Iterator[Item]:
    """Scans, inertial data, heights and true poses of a base turned by an angle about its z axis, radians.

    A map begins along the base: its cells lie at that angle to what they were along before.
    """
    forth, back = (Transform(np.zeros(3), geometry.yaw_quaternion(way)) for way in (angle, -angle))

    @lru_cache(maxsize=8)  # a mount is one object for many scans
    def mounted(T_base_laser: Transform) -> Transform:
        return geometry.chain(back, T_base_laser)

    for item in items:
        match item:
            case LaserScan():
                yield replace(item, T_base_laser=mounted(item.T_base_laser))
            case Imu():
                both = item.angular_velocity, item.linear_acceleration
                yield Imu(item.stamp_ns, *(geometry.rotate(back.rotation, v) for v in both))
            case TruthPose():
                T_map_base = geometry.chain(geometry.chain(back, item.T_map_base), forth)
                yield TruthPose(item.stamp_ns, T_map_base)
            case Height():
                yield item
            case _:
                raise TypeError(f"a {type(item).__name__} cannot be turned")
