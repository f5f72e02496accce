"""Section V: what other sensors say about the inertial state: corrections of a belief (x, P).

x (19,) and P (15, 15) are laid out as in slam_core.kernels.navigation.
"""

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from slam_core import geometry
from slam_core.intersection import intersect
from slam_core.kernels.navigation import ERRORS, gain_update, inject, is_covariance
from slam_core.measurements import Float64s

# Nothing that a robot reports about its place or its speed is further out than this, in metres or m/s.
PLAUSIBLE = 1e7


class Correction(Protocol):
    """A measurement of the state at one instant."""

    @property
    def usable(self) -> bool:
        """Whether the values are finite and the noise is a covariance."""

    def apply(self, x: Float64s, P: Float64s) -> tuple[Float64s, Float64s]:
        """The belief after the measurement."""


@dataclass(frozen=True, slots=True, eq=False)
class PlanarPose:
    """Section V-B: a match xi (3,) with covariance R (3, 3), fused by intersection with weight omega."""

    xi: Float64s
    R: Float64s
    omega: float

    @property
    def usable(self) -> bool:
        """Finite, with a sensible noise."""
        return _plausible(self.xi) and bool(is_covariance(self.R))

    def apply(self, x: Float64s, P: Float64s) -> tuple[Float64s, Float64s]:
        """Eqs. (18)-(20) with C x = (p_x, p_y, psi)."""
        innovation = self.xi - project(x)
        innovation[2] = geometry.wrap(innovation[2])
        error, P = intersect(P, observer(x), self.R, innovation, self.omega)
        return inject(x, error), P


@dataclass(frozen=True, slots=True, eq=False)
class HeightAid:
    """A height in metres over the start, with its standard deviation."""

    height: float
    sigma: float

    @property
    def usable(self) -> bool:
        """Finite, with a sensible noise."""
        return abs(self.height) < PLAUSIBLE and 0.0 < self.sigma < math.inf

    def apply(self, x: Float64s, P: Float64s) -> tuple[Float64s, Float64s]:
        """A Kalman update of p_z."""
        C = np.zeros((1, ERRORS))
        C[0, 5] = 1.0
        error, P = gain_update(P, C, np.array([[self.sigma**2]]), np.array([self.height - x[6]]))
        return inject(x, error), P


@dataclass(frozen=True, slots=True, eq=False)
class BodyVelocity:
    """Velocity in the axes of the base, (2,) forward and left or (3,) also up, m/s, and its deviation."""

    velocity: Float64s
    sigma: float

    @property
    def usable(self) -> bool:
        """Finite, with a sensible noise."""
        return _plausible(self.velocity) and 0.0 < self.sigma < math.inf

    def apply(self, x: Float64s, P: Float64s) -> tuple[Float64s, Float64s]:
        """A Kalman update with C x = R^T v."""
        n = len(self.velocity)
        to_body = geometry.rotation_matrix(x[:4]).T[:n]
        C = np.zeros((n, ERRORS))
        C[:, :3] = np.cross(to_body, x[7:10])
        C[:, 6:9] = to_body
        error, P = gain_update(P, C, self.sigma**2 * np.eye(n), self.velocity - to_body @ x[7:10])
        return inject(x, error), P


def project(x: Float64s) -> Float64s:
    """C x of eq. (19): position in the plane and heading (3,) of a state."""
    return np.array([x[4], x[5], geometry.heading(x[:4])])


def observer(x: Float64s) -> Float64s:
    """The observer matrix C (3, 15) of eqs. (16)-(20): how the planar pose follows the errors of the state."""
    C = np.zeros((3, ERRORS))
    C[0, 3] = C[1, 4] = 1.0
    C[2, :3] = geometry.heading_gradient(x[:4])
    return C


def _plausible(values: Float64s) -> bool:
    return bool(np.all(np.abs(values) < PLAUSIBLE))
