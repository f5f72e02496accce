"""What the sensors say: frozen values with int64 nanoseconds and SI units, in REP-103 axes.

Everything a source yields is one of these. Arrays are read by the core, never written.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Float32s = NDArray[np.float32]
Float64s = NDArray[np.float64]


def _identity_quaternion() -> Float64s:
    return np.array([1.0, 0.0, 0.0, 0.0])


@dataclass(frozen=True, slots=True, eq=False)
class Transform:
    """T_parent_child: p_parent = R(rotation) p_child + translation.

    translation: (3,) metres. rotation: (4,) unit quaternion w, x, y, z.
    """

    translation: Float64s = field(default_factory=lambda: np.zeros(3))
    rotation: Float64s = field(default_factory=_identity_quaternion)


@dataclass(frozen=True, slots=True, eq=False)
class LaserScan:
    """One sweep of a planar laser: ray i at angle_min + i angle_increment, at stamp_ns + i time_increment.

    ranges: (n,) metres after REP-117 (+inf no return, -inf too close, NaN discard).
    T_base_laser: the laser's mount at the time of the sweep (a servo may move it between sweeps).
    """

    stamp_ns: int
    ranges: Float32s
    angle_min: float
    angle_increment: float
    time_increment: float = 0.0
    range_min: float = 0.0
    range_max: float = float("inf")
    T_base_laser: Transform = field(default_factory=Transform)

    @property
    def end_ns(self) -> int:
        """Time of the last ray."""
        return self.stamp_ns + max(0, round((len(self.ranges) - 1) * self.time_increment * 1e9))

    @property
    def mid_ns(self) -> int:
        """Middle of the sweep: the instant that the matched pose belongs to."""
        return (self.stamp_ns + self.end_ns) // 2


@dataclass(frozen=True, slots=True, eq=False)
class Imu:
    """Inertial input u = (omega, a) in the base frame: (3,) rad/s and (3,) m/s^2 (+g on z at rest)."""

    stamp_ns: int
    angular_velocity: Float64s
    linear_acceleration: Float64s


@dataclass(frozen=True, slots=True, eq=False)
class Attitude:
    """Orientation of the base that somebody else estimated: (4,) w, x, y, z; its yaw is not used."""

    stamp_ns: int
    rotation: Float64s


@dataclass(frozen=True, slots=True, eq=False)
class Odometry:
    """Velocity of the base by its wheels, in the base frame: (2,) m/s forward and left, rad/s about z."""

    stamp_ns: int
    velocity: Float64s
    yaw_rate: float


@dataclass(frozen=True, slots=True)
class Height:
    """Height of the base over the starting point, metres (barometer or range sensor)."""

    stamp_ns: int
    height: float


@dataclass(frozen=True, slots=True, eq=False)
class TruthPose:
    """Where the base really was, by a simulator or a motion capture; shown and scored, never used."""

    stamp_ns: int
    T_map_base: Transform


Measurement = LaserScan | Imu | Attitude | Odometry | Height
