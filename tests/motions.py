"""Rides with exact truth for tests of the filter: plain numpy, by other formulas than the core's."""

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from slam_core.measurements import Imu

Array = NDArray[np.float64]
GRAVITY = np.array([0.0, 0.0, -9.80665])
START_NS = 1_000_000_000_000


def cross_matrix(v: Array) -> Array:
    """[v] x as a matrix."""
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def turn_matrix(v: Array) -> Array:
    """Rotation by |v| about v, after Rodrigues."""
    angle = float(np.linalg.norm(v))
    K = cross_matrix(v)
    half = 0.5 * angle
    return np.eye(3) + np.sinc(angle / np.pi) * K + 0.5 * np.sinc(half / np.pi) ** 2 * (K @ K)


def euler_matrix(roll: float, pitch: float, yaw: float) -> Array:
    """Rz Ry Rx."""
    z, y, x = np.array([0.0, 0.0, yaw]), np.array([0.0, pitch, 0.0]), np.array([roll, 0.0, 0.0])
    return turn_matrix(z) @ turn_matrix(y) @ turn_matrix(x)


class Ride:
    """position: seconds -> (3,) metres; attitude: seconds -> (3, 3) base to map. Inputs by central differences."""

    def __init__(self, position: Callable[[float], Array], attitude: Callable[[float], Array]) -> None:
        self.position, self.attitude = position, attitude

    def rate(self, t: float, h: float = 1e-4) -> Array:
        """Angular rate in body axes, rad/s."""
        spin = self.attitude(t).T @ (self.attitude(t + h) - self.attitude(t - h)) / (2 * h)
        return np.array([spin[2, 1] - spin[1, 2], spin[0, 2] - spin[2, 0], spin[1, 0] - spin[0, 1]]) / 2

    def force(self, t: float, h: float = 1e-3) -> Array:
        """Specific force in body axes, m/s^2."""
        acceleration = (self.position(t + h) - 2 * self.position(t) + self.position(t - h)) / h**2
        return self.attitude(t).T @ (acceleration - GRAVITY)

    def velocity(self, t: float, h: float = 1e-4) -> Array:
        """Velocity in the map, m/s."""
        return (self.position(t + h) - self.position(t - h)) / (2 * h)

    def samples(
        self, seconds: float, rate: float = 100.0, noise: float = 0.0, bias: Array | None = None, seed: int = 0
    ) -> Iterator[Imu]:
        """Inertial data from START_NS on; noise is 0.005 rad/s and 0.03 m/s^2 at 1, bias (6,) is added."""
        rng = np.random.default_rng(seed)
        scale = noise * np.repeat([0.005, 0.03], 3)
        for k in range(round(seconds * rate) + 1):
            t = k / rate
            u = np.concatenate([self.rate(t), self.force(t)]) + scale * rng.normal(size=6)
            u += 0.0 if bias is None else bias
            yield Imu(stamp(t), u[:3], u[3:])


def stamp(t: float) -> int:
    """The clock at t seconds of a ride."""
    return START_NS + round(t * 1e9)


def still() -> Ride:
    """A level base that stands at the origin."""
    return Ride(lambda t: np.zeros(3), lambda t: np.eye(3))


def grown(t: float, start: float = 1.0) -> float:
    """0 up to `start`, then smoothly up to 1 within two seconds."""
    u = min(max((t - start) / 2.0, 0.0), 1.0)
    return u**3 * (10 - 15 * u + 6 * u**2)


def gait() -> Ride:
    """A walk in curves that sways and bounces; still for the first second."""

    def position(t: float) -> Array:
        return grown(t) * np.array([1.5 * np.sin(0.5 * t), 2.0 * np.sin(0.3 * t), 0.04 * np.sin(11.0 * t)])

    def attitude(t: float) -> Array:
        g = grown(t)
        return euler_matrix(g * 0.15 * np.sin(5.5 * t), g * 0.2 * np.sin(2.1 * t), g * 0.6 * np.sin(0.7 * t))

    return Ride(position, attitude)


def tumble() -> Ride:
    """A base that pitches through 90 degrees, to 130 and back, while it drives and yaws; still at first."""

    def position(t: float) -> Array:
        return grown(t) * np.array([np.sin(0.6 * t), np.cos(0.4 * t) - 1.0, 0.3 * np.sin(0.5 * t)])

    def attitude(t: float) -> Array:
        pitch = grown(t) * np.radians(65.0) * (1.0 - np.cos(0.8 * (t - 1.0)))
        return turn_matrix(np.array([0.0, 0.0, 0.4 * grown(t)])) @ turn_matrix(
            np.array([0.1 * grown(t), pitch, 0.0])
        )

    return Ride(position, attitude)
