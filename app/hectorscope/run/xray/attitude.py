"""Eq. (1) near 90 degrees of pitch: rates of Euler angles, beside the quaternion that the filter turns."""

import math
from dataclasses import dataclass

import numpy as np

from slam_core import geometry
from slam_core.measurements import Float64s

REACH = math.radians(45.0)  # from the pitch that is passed, down to the start and up to the end
SECONDS, RATE = 1.0, 100  # of the motion; Hz of the inertial unit
ASIDE = math.radians(0.5)  # rad/s about the other two axes: so 90 degrees are passed beside the pole
OMEGA = np.array([ASIDE, 2.0 * REACH / SECONDS, ASIDE])  # body rates, rad/s


@dataclass(frozen=True, eq=False)
class Passage:
    """A steady turn through a pitch (radians). E: (3, 3) of (1) there, at no roll.

    by_angles, by_quaternion: radians between the attitude at the end and the true one, where each sample of the
    rates turns Euler angles by (1), or a quaternion.
    """

    pitch: float
    E: Float64s
    by_angles: float
    by_quaternion: float


def passage(pitch: float) -> Passage:
    """Both ways of integration, from REACH below a pitch to about REACH above it."""
    begin = geometry.from_euler(0.0, pitch - REACH, 0.0)
    truth = geometry.multiply(begin, geometry.from_rotation_vector(OMEGA * SECONDS))
    by_angles, by_quaternion = _by_angles(pitch - REACH), _by_quaternion(begin)
    E = geometry.euler_rates(0.0, pitch)
    return Passage(pitch, E, _between(truth, by_angles), _between(truth, by_quaternion))


def _by_quaternion(q: Float64s) -> Float64s:
    for _ in range(round(SECONDS * RATE)):
        q = geometry.multiply(q, geometry.from_rotation_vector(OMEGA / RATE))
    return q


def _by_angles(pitch: float) -> Float64s:
    """By the midpoint rule."""
    angles = np.array([0.0, pitch, 0.0])
    for _ in range(round(SECONDS * RATE)):
        middle = angles + 0.5 / RATE * geometry.euler_rates(*angles[:2].tolist()) @ OMEGA
        angles = angles + geometry.euler_rates(*middle[:2].tolist()) @ OMEGA / RATE
    return geometry.from_euler(*angles.tolist())


def _between(p: Float64s, q: Float64s) -> float:
    """The angle between two attitudes."""
    return float(np.linalg.norm(geometry.to_rotation_vector(geometry.multiply(geometry.conjugate(p), q))))
