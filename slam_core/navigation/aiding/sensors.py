"""Section V: corrections by satellites, compass, rangefinder, an external attitude and standstill.

Errors of such sensors last: a receiver that is two metres off still is a moment later. A gate compares with the
error as it is; the update counts each measurement by the share that is new in it (`Lasting`).
"""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from slam_core import geometry
from slam_core.kernels.fusion import correct
from slam_core.kernels.linear import sandwich
from slam_core.kernels.navigation import ERRORS
from slam_core.measurements import Float64s
from slam_core.navigation.chi_square import bound
from slam_core.navigation.corrections import Correction, Update


class Lasting(Correction):
    """A measurement whose error lasts; share: what is independent of the one before, over 0 to 1."""

    __slots__ = ()
    share: float

    @property
    def usable(self) -> bool:
        """Finite, with a sensible noise: made so by whoever makes it."""
        return 0.0 < self.share <= 1.0

    def update(self, x: Float64s, P: Float64s) -> Update:
        """The gate with R, the update with R / share."""
        innovation, C, R = self.observe(x)
        limit = bound(self.gate, len(innovation))
        S = R + sandwich(C, P)
        nis = float(innovation @ np.linalg.solve(S, innovation))
        if not nis <= limit:
            return Update(x, P, innovation, S, nis, limit)
        better, reduced, wider = np.empty(len(x)), np.empty(P.shape), np.empty(R.shape)
        weighed = correct(x, P, innovation, C, R / self.share, math.inf, better, reduced, wider)
        return Update(better, reduced, innovation, S, nis if math.isfinite(weighed) else math.nan, limit)


@dataclass(frozen=True, slots=True, eq=False)
class Place(Lasting):
    """The antenna's place (3,) in the map by satellites, with its covariance (3, 3); antenna: (3,) on the base."""

    place: Float64s
    R: Float64s
    antenna: Float64s
    share: float
    gate: float
    source: ClassVar[str] = "gps"
    measures: ClassVar[tuple[int, ...]] = (3, 4, 5)

    def observe(self, x: Float64s) -> tuple[Float64s, Float64s, Float64s]:
        """C x = p + R a."""
        arm = geometry.rotate(x[:4], self.antenna)
        C = np.eye(3, ERRORS, 3)
        C[:, :3] = -_cross(arm)
        return self.place - x[4:7] - arm, C, self.R


@dataclass(frozen=True, slots=True, eq=False)
class Velocity(Lasting):
    """The velocity (3,) in the map by satellites, with its covariance (3, 3)."""

    velocity: Float64s
    R: Float64s
    share: float
    gate: float
    source: ClassVar[str] = "gps velocity"
    measures: ClassVar[tuple[int, ...]] = (6, 7, 8)

    def observe(self, x: Float64s) -> tuple[Float64s, Float64s, Float64s]:
        """C x = v."""
        return self.velocity - x[7:10], np.eye(3, ERRORS, 6), self.R


@dataclass(frozen=True, slots=True, eq=False)
class MagneticHeading(Lasting):
    """A magnetic field (3,) in the axes of the base, and where north lies in the map; variance in rad²."""

    field: Float64s
    north: float
    variance: float
    share: float
    gate: float
    source: ClassVar[str] = "compass"
    measures: ClassVar[tuple[int, ...]] = (2,)

    def observe(self, x: Float64s) -> tuple[Float64s, Float64s, Float64s]:
        """The direction of the field in the plane; a tilt that is wrong turns it too, by the field's dip."""
        bx, by, bz = geometry.rotate(x[:4], self.field).tolist()
        across = bx**2 + by**2
        C = np.zeros((1, ERRORS))
        C[0, :3] = -bz * bx / across, -bz * by / across, 1.0
        innovation = geometry.wrap(self.north - math.atan2(by, bx))
        return np.array([innovation]), C, np.array([[self.variance]])


@dataclass(frozen=True, slots=True, eq=False)
class Tilt(Lasting):
    """Up (3,) in the axes of the base, by an external estimate; sigma in radians."""

    up: Float64s
    sigma: float
    share: float
    gate: float
    source: ClassVar[str] = "attitude"
    measures: ClassVar[tuple[int, ...]] = (0, 1)

    def observe(self, x: Float64s) -> tuple[Float64s, Float64s, Float64s]:
        """What turns the measured up onto the map's z axis."""
        ux, uy, _ = geometry.rotate(x[:4], self.up).tolist()
        return np.array([uy, -ux]), np.eye(2, ERRORS), self.sigma**2 * np.eye(2)


@dataclass(frozen=True, slots=True, eq=False)
class GroundBeam(Lasting):
    """A distance along a beam of the base to level ground at a height of the map, metres."""

    distance: float
    origin: Float64s
    direction: Float64s
    level: float
    sigma: float
    share: float
    gate: float
    source: ClassVar[str] = "ground"
    measures: ClassVar[tuple[int, ...]] = ()  # a step of the ground is more likely than a wrong height

    def observe(self, x: Float64s) -> tuple[Float64s, Float64s, Float64s]:
        """The height that puts the end of the beam on the ground; linear in the errors of tilt and height."""
        arm = geometry.rotate(x[:4], self.origin + self.distance * self.direction)
        C = np.zeros((1, ERRORS))
        C[0, 0], C[0, 1], C[0, 5] = arm[1], -arm[0], 1.0
        return np.array([self.level - x[6] - arm[2]]), C, np.array([[self.sigma**2]])


class Resting(Correction):
    """What is known of a base that stands still."""

    __slots__ = ()

    @property
    def usable(self) -> bool:
        """Always: it is made of samples that were checked."""
        return True


@dataclass(frozen=True, slots=True, eq=False)
class Standstill(Resting):
    """No velocity, with the variance of that."""

    variance: float
    gate: float
    source: ClassVar[str] = "standstill"
    measures: ClassVar[tuple[int, ...]] = ()

    def observe(self, x: Float64s) -> tuple[Float64s, Float64s, Float64s]:
        """C x = v."""
        return -x[7:10], np.eye(3, ERRORS, 6), self.variance * np.eye(3)


@dataclass(frozen=True, slots=True, eq=False)
class ZeroRate(Resting):
    """The rate (3,) of a base that does not turn, and its variance: it is the bias of the gyros."""

    rate: Float64s
    variance: float
    gate: float
    source: ClassVar[str] = "zero rate"
    measures: ClassVar[tuple[int, ...]] = ()

    def observe(self, x: Float64s) -> tuple[Float64s, Float64s, Float64s]:
        """C x = the gyro bias."""
        return self.rate - x[10:13], np.eye(3, ERRORS, 9), self.variance * np.eye(3)


@dataclass(frozen=True, slots=True, eq=False)
class Gravity(Resting):
    """The specific force (3,) of a base that does not accelerate, and its variance: it points up."""

    force: Float64s
    variance: float
    gate: float
    source: ClassVar[str] = "gravity"
    measures: ClassVar[tuple[int, ...]] = (0, 1)

    def observe(self, x: Float64s) -> tuple[Float64s, Float64s, Float64s]:
        """What is left of the force in the plane, which tilt and the accelerometers' biases explain."""
        R = geometry.rotation_matrix(x[:4])
        force = R @ (self.force - x[13:16])
        C = np.zeros((2, ERRORS))
        C[0, 1], C[1, 0] = force[2], -force[2]
        C[:, 12:15] = -R[:2]
        return -force[:2], C, self.variance * np.eye(2)


def _cross(v: Float64s) -> Float64s:
    """The matrix (3, 3) that multiplies like a cross product with v from the left."""
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
