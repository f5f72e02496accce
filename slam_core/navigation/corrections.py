"""Section V: corrections of the inertial state by other sensors, on an estimate (x, P).

x (19,) and P (15, 15) are laid out as in slam_core.kernels.navigation.
"""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import ClassVar, NamedTuple

import numpy as np

from slam_core import geometry
from slam_core.config import FusionMethod
from slam_core.kernels import fusion
from slam_core.kernels.linear import is_measurement
from slam_core.kernels.navigation import ERRORS
from slam_core.measurements import PLAUSIBLE, Float64s
from slam_core.navigation.chi_square import bound
from slam_core.navigation.covariance_intersection import RULES
from slam_core.results import NOWHERE

HEIGHT = np.eye(1, ERRORS, 5)  # how p_z follows the errors


class Update(NamedTuple):
    """A correction worked out: x and P after it, its innovation (m,) with covariance S (m, m), and the gate.

    nis: nu^T S^-1 nu, which the gate compares with `bound`; past it (or NaN) x and P are as they were.
    """

    x: Float64s
    P: Float64s
    innovation: Float64s
    S: Float64s
    nis: float
    bound: float

    @property
    def accepted(self) -> bool:
        """Whether it passed the gate."""
        return self.nis <= self.bound


class Correction(ABC):
    """A measurement of the state at one instant: a Kalman update behind a gate.

    source: a word for where it comes from. measures: the error states it is about; their
    covariance is raised if they contradict this source for long. gate: in sigmas, see `chi_square.bound`; 0 is
    open.
    """

    __slots__ = ()
    source: ClassVar[str]
    measures: ClassVar[tuple[int, ...]]
    gate: float

    @property
    def reading(self) -> tuple[float, ...]:
        """The raw value of a sensor that repeats none while the robot moves, unless it is frozen; else empty."""
        return ()

    @property
    @abstractmethod
    def usable(self) -> bool:
        """Whether the values are finite and the noise is a covariance."""

    @abstractmethod
    def observe(self, x: Float64s) -> tuple[Float64s, Float64s, Float64s]:
        """Innovation (m,) z - h(x) with angles wrapped, observer C (m, 15), and noise R (m, m)."""

    def update(self, x: Float64s, P: Float64s) -> Update:
        """The estimate after the measurement."""
        innovation, C, R = self.observe(x)
        limit = bound(self.gate, len(innovation))
        better, reduced, S = np.empty(len(x)), np.empty(P.shape), np.empty(R.shape)
        nis = fusion.correct(x, P, innovation, C, R, limit, better, reduced, S)
        return Update(better, reduced, innovation, S, nis, limit)


@dataclass(frozen=True, slots=True, eq=False)
class PlanarPose(Correction):
    """Section V-B: a match xi (3,) with covariance R (3, 3), fused by a method, if fixed with weight omega.

    unobservable: (2,) direction of the plane that the match does not observe, or zero: position and velocity along
    it stay as they are. widen_vertical: eq. (18) widens height, vertical velocity and bias like the rest of the
    state, although the match does not observe them.
    """

    xi: Float64s
    R: Float64s
    omega: float
    method: FusionMethod = "fixed"
    gate: float = 0.0
    unobservable: Float64s = field(default_factory=lambda: NOWHERE)
    widen_vertical: bool = True
    source: ClassVar[str] = "scan"
    measures: ClassVar[tuple[int, ...]] = (2, 3, 4)

    @property
    def usable(self) -> bool:
        """Finite, with a sensible noise."""
        return bool(is_measurement(self.xi, self.R, PLAUSIBLE))

    def observe(self, x: Float64s) -> tuple[Float64s, Float64s, Float64s]:
        """C x = (p_x, p_y, psi)."""
        innovation = self.xi - project(x)
        innovation[2] = geometry.wrap(innovation[2])
        return innovation, fusion.planar_observer(x), self.R

    def update(self, x: Float64s, P: Float64s) -> Update:
        """Eqs. (18)-(20)."""
        limit = bound(self.gate, 3)
        rule = RULES[self.method], self.omega, self.unobservable, self.widen_vertical
        after = np.empty(len(x)), np.empty(P.shape), np.empty(3), np.empty((3, 3))
        nis = fusion.correct_planar(x, P, (self.xi, self.R), rule, limit, after)
        return Update(*after, nis, limit)


@dataclass(frozen=True, slots=True, eq=False)
class HeightAid(Correction):
    """A height in metres over the start, with its standard deviation."""

    height: float
    sigma: float
    gate: float = 0.0
    source: ClassVar[str] = "height"
    measures: ClassVar[tuple[int, ...]] = (5,)

    @property
    def usable(self) -> bool:
        """Finite, with a sensible noise."""
        return abs(self.height) < PLAUSIBLE and 0.0 < self.sigma < math.inf

    @property
    def reading(self) -> tuple[float, ...]:
        """Weather and noise move a barometer all the time."""
        return (self.height,)

    def observe(self, x: Float64s) -> tuple[Float64s, Float64s, Float64s]:
        """C x = p_z."""
        return np.array([self.height - x[6]]), HEIGHT, np.array([[self.sigma**2]])


@dataclass(frozen=True, slots=True, eq=False)
class BodyVelocity(Correction):
    """Velocity in the axes of the base, (2,) forward and left or (3,) also up, m/s, and its deviation."""

    velocity: Float64s
    sigma: float
    gate: float = 0.0
    source: ClassVar[str] = "wheels"
    measures: ClassVar[tuple[int, ...]] = (6, 7, 8)

    @property
    def usable(self) -> bool:
        """Finite, with a sensible noise."""
        return _plausible(self.velocity) and 0.0 < self.sigma < math.inf

    def observe(self, x: Float64s) -> tuple[Float64s, Float64s, Float64s]:
        """C x = R^T v."""
        predicted, C = fusion.body_velocity(x, len(self.velocity))
        return self.velocity - predicted, C, self.sigma**2 * np.eye(len(self.velocity))


def project(x: Float64s) -> Float64s:
    """C x of eq. (19): position in the plane and heading (3,) of a state."""
    return np.array([x[4], x[5], geometry.heading(x[:4])])


def _plausible(values: Float64s) -> bool:
    return bool(np.all(np.abs(values) < PLAUSIBLE))
