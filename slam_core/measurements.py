"""Measurements: frozen values with int64 nanoseconds and SI units, in REP-103 axes.

Everything a source yields is one of these. Arrays are read by the core, never written.
"""

import math
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Float32s = NDArray[np.float32]
Float64s = NDArray[np.float64]
Int64s = NDArray[np.int64]

# Nothing that a robot reports about its place or its speed is further out than this, in metres or m/s.
PLAUSIBLE = 1e7
# No robot carries its laser further from its base than this, in metres.
FARTHEST_LASER = 1e3
# A stamp this far ahead is accepted only when the next one confirms it.
LEAP_NS = 10_000_000_000


def _identity_quaternion() -> Float64s:
    return np.array([1.0, 0.0, 0.0, 0.0])


@dataclass(frozen=True, slots=True, eq=False)
class Transform:
    """T_parent_child: p_parent = R(rotation) p_child + translation.

    translation: (3,) metres. rotation: (4,) unit quaternion w, x, y, z.
    """

    translation: Float64s = field(default_factory=lambda: np.zeros(3))
    rotation: Float64s = field(default_factory=_identity_quaternion)

    def is_same(self, other: "Transform") -> bool:
        """Whether every number of both is the same."""
        both = (self.translation, other.translation), (self.rotation, other.rotation)
        return self is other or all(np.array_equal(mine, theirs) for mine, theirs in both)


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
        return self.stamp_ns + _sweep_ns(len(self.ranges), self.time_increment)

    @property
    def mid_ns(self) -> int:
        """Middle of the sweep: the instant that the matched pose belongs to."""
        return self.stamp_ns + _sweep_ns(len(self.ranges), self.time_increment) // 2


@lru_cache(maxsize=8)
def _sweep_ns(beams: int, time_increment: float) -> int:
    duration = (beams - 1) * time_increment * 1e9
    return max(0, round(duration)) if math.isfinite(duration) else 0


@dataclass(frozen=True, slots=True, eq=False)
class Imu:
    """Inertial input u = (omega, a) in the base frame: (3,) rad/s and (3,) m/s^2 (+g on z at rest)."""

    stamp_ns: int
    angular_velocity: Float64s
    linear_acceleration: Float64s


@dataclass(frozen=True, slots=True, eq=False)
class Attitude:
    """Orientation of the base by another estimator: (4,) w, x, y, z; its yaw is not used."""

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
class GroundDistance:
    """Distance to the ground along a beam fixed to the base: metres, origin (3,) and unit direction (3,)."""

    stamp_ns: int
    distance: float
    origin: Float64s
    direction: Float64s


@dataclass(frozen=True, slots=True, eq=False)
class MagneticField:
    """The magnetic field in the axes of the base: (3,) tesla, with the base's own magnetism taken out."""

    stamp_ns: int
    field: Float64s


@dataclass(frozen=True, slots=True, eq=False)
class GpsPosition:
    """A satellite fix in the tangent plane at the first one: (3,) metres east, north, up; (3, 3) covariance.

    antenna: (3,) where it sits on the base. covariance: None where the receiver reports none.
    """

    stamp_ns: int
    position: Float64s
    covariance: Float64s | None
    antenna: Float64s


@dataclass(frozen=True, slots=True, eq=False)
class GpsVelocity:
    """Velocity by satellites: (3,) m/s east, north, up; the antenna's, taken for the base's."""

    stamp_ns: int
    velocity: Float64s


@dataclass(frozen=True, slots=True, eq=False)
class TruthPose:
    """Where the base really was, by a simulator or a motion capture; shown and scored, never used."""

    stamp_ns: int
    T_map_base: Transform


Aid = Attitude | Odometry | Height | GroundDistance | MagneticField | GpsPosition | GpsVelocity
Measurement = LaserScan | Imu | Aid
