"""True motion of the base: a uniform quintic spline through position and Euler angles.

The spline is the truth by definition, so that rates and specific force follow from it exactly.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial

from slam_core.geometry import from_euler
from slam_core.measurements import Float64s, Transform

DEGREE = 5
GRAVITY = 9.80665  # m/s^2
STEP = 0.04  # s between control points: fast enough for a gait, and smoothes what is faster

Channels = Callable[[Float64s], Float64s]
"""(m,) seconds -> (m, 6) x, y, z in metres, roll, pitch, yaw in radians."""


def _basis() -> Float64s:
    """(6, 6) coefficients: row p, column j holds the weight of control point j at u^p.

    Cardinal B-splines by N_k(x) = x/k N_{k-1}(x) + (k+1-x)/k N_{k-1}(x-1), piece m being N_k(u + m).
    """
    u = Polynomial([0.0, 1.0])
    pieces = [Polynomial([1.0])]
    for k in range(1, DEGREE + 1):
        padded = [Polynomial([0.0]), *pieces, Polynomial([0.0])]
        pieces = [((u + m) * padded[m + 1] + (k + 1 - m - u) * padded[m]) / k for m in range(k + 1)]
    return np.array([np.resize(piece.cutdeg(DEGREE).coef, DEGREE + 1) for piece in reversed(pieces)]).T


_BASIS = _basis()
_POWERS = np.arange(DEGREE + 1)


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """x, y, z, roll, pitch, yaw of the base over time, from 0 to `duration` seconds.

    controls: (n, 6); control point i + 2 is the value near time i * STEP.
    """

    controls: Float64s
    duration: float

    @classmethod
    def through(cls, channels: Channels, duration: float) -> "Motion":
        """The smooth motion near `channels`, which may have corners."""
        count = int(np.ceil(duration / STEP)) + DEGREE + 1
        return cls(channels(STEP * np.arange(-2.0, count - 2)), duration)

    def begun(self, seconds: float) -> "Motion":
        """The motion from about that many seconds on: from a control point, at which its time is then 0."""
        left_out = round(seconds / STEP)
        return Motion(self.controls[left_out:], self.duration - left_out * STEP)

    def at(self, t: Float64s, derivative: int = 0) -> Float64s:
        """(m, 6) channels or their first or second derivative at (m,) seconds within the motion."""
        span = np.clip(np.floor(t / STEP).astype(np.int64), 0, len(self.controls) - DEGREE - 1)
        u = t / STEP - span
        factors = np.ones(DEGREE + 1)
        for i in range(derivative):
            factors *= _POWERS - i
        exponents = np.maximum(_POWERS - derivative, 0)
        weights = (u[:, None] ** exponents * factors) @ _BASIS / STEP**derivative
        window = self.controls[span[:, None] + np.arange(DEGREE + 1)]
        values: Float64s = np.einsum("mj,mjc->mc", weights, window)
        return values

    def poses(self, t: Float64s) -> tuple[Float64s, Float64s]:
        """(m, 3) positions and (m, 3, 3) rotations, base to map."""
        values = self.at(t)
        return values[:, :3], rotations(values[:, 3:])

    def body_rates(self, t: Float64s) -> Float64s:
        """(m, 3) omega in the base frame, rad/s: the inverse of the Euler-rate equation (2)."""
        roll, pitch = self.at(t)[:, 3:5].T
        d_roll, d_pitch, d_yaw = self.at(t, 1)[:, 3:].T
        return np.column_stack(
            (
                d_roll - d_yaw * np.sin(pitch),
                d_pitch * np.cos(roll) + d_yaw * np.cos(pitch) * np.sin(roll),
                d_yaw * np.cos(pitch) * np.cos(roll) - d_pitch * np.sin(roll),
            )
        )

    def specific_force(self, t: Float64s) -> Float64s:
        """(m, 3) f = R^T (acceleration - g) in the base frame, m/s^2: +g on z at rest."""
        acceleration = self.at(t, 2)[:, :3] + np.array([0.0, 0.0, GRAVITY])
        forces: Float64s = np.einsum("mji,mj->mi", self.poses(t)[1], acceleration)
        return forces

    def transform(self, t: float) -> Transform:
        """T_map_base at one instant."""
        values = self.at(np.array([t]))[0]
        return Transform(values[:3], from_euler(*values[3:]))


def rotations(angles: Float64s) -> Float64s:
    """(m, 3, 3) Rz(yaw) Ry(pitch) Rx(roll) of (m, 3) roll, pitch, yaw."""
    sr, sp, sy = np.sin(angles).T
    cr, cp, cy = np.cos(angles).T
    rows = (
        (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        (-sp, cp * sr, cp * cr),
    )
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
