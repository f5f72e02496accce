"""Magnetometer, satellite receiver and rangefinder: what a robot may carry besides laser, IMU and barometer."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from hectorscope.simulation.motion import Motion
from hectorscope.simulation.options import SceneOptions
from hectorscope.simulation.scene import Scene, ease_in
from hectorscope.simulation.sensors import Arrival, nanoseconds, ticks
from slam_core.measurements import Float64s, GpsPosition, GpsVelocity, GroundDistance, MagneticField
from slam_core.navigation.aiding.geodesy import TangentPlane

# Where the map's origin lies, and how far its x axis is turned from east: on Claytor Lake, as in the paper.
ORIGIN = TangentPlane(37.0590, -80.6370, 562.0)
MAP_YAW = float(np.radians(25.0))
# The field there: horizontal and vertical tesla, and how far its north lies east of true north.
HORIZONTAL, VERTICAL, DECLINATION = 2.2e-5, 4.6e-5, float(np.radians(-9.0))
COMPASS_RATE, GPS_RATE, GROUND_RATE = 20.0, 5.0, 20.0  # Hz


@dataclass(frozen=True, slots=True)
class Magnetometer:
    """Tesla. Metal passes by for a tenth of the drive, and adds up to `metal`."""

    noise: float = 3e-7
    own: float = 5e-7  # magnetism of the robot that calibration left, at most on each axis
    metal: float = 2e-5
    metal_from: float = 0.3  # of the duration
    metal_lasts: float = 0.1
    latency: float = 0.002


@dataclass(frozen=True, slots=True)
class Receiver:
    """A satellite receiver, metres and m/s. Its error wanders: a receiver is wrong in the same way for a while."""

    sigma: float = 1.0  # east and north; up is twice as bad
    wander: float = 40.0  # s
    noise: float = 0.05
    velocity_noise: float = 0.1
    latency: float = 0.08
    antenna: tuple[float, float, float] = (-0.3, 0.0, 0.9)


@dataclass(frozen=True, slots=True)
class Rangefinder:
    """A beam straight down from below the base, metres."""

    noise: float = 0.01
    latency: float = 0.005
    origin: tuple[float, float, float] = (0.0, 0.0, 0.3)
    reach: float = 10.0


MAGNETOMETER, RECEIVER, RANGEFINDER = Magnetometer(), Receiver(), Rangefinder()


def compass(motion: Motion, options: SceneOptions) -> Iterator[Arrival]:
    """The Earth's field in the axes of the base, with what else is magnetic."""
    rng = np.random.default_rng([options.seed, 3])
    t = ticks(motion, COMPASS_RATE)
    azimuth = np.pi / 2 - DECLINATION - MAP_YAW
    earth = np.array([HORIZONTAL * np.cos(azimuth), HORIZONTAL * np.sin(azimuth), -VERTICAL])
    begin, lasts = motion.duration * MAGNETOMETER.metal_from, motion.duration * MAGNETOMETER.metal_lasts
    near = ease_in(t, begin, 1.0) - ease_in(t, begin + lasts - 1.0, 1.0)
    metal = options.noise * MAGNETOMETER.metal * near[:, None] * np.array([0.5, -0.8, 0.33])
    fields = np.einsum("mji,mj->mi", motion.poses(t)[1], earth + metal)
    own = rng.uniform(-MAGNETOMETER.own, MAGNETOMETER.own, size=3)
    fields += options.noise * (own + rng.normal(scale=MAGNETOMETER.noise, size=fields.shape))
    for time, field in zip(t, fields, strict=True):
        yield nanoseconds(time + MAGNETOMETER.latency), MagneticField(nanoseconds(time), field)


def fixes(motion: Motion, options: SceneOptions, outage: float) -> Iterator[Arrival]:
    """Position and velocity of the antenna in the tangent plane; none for `outage` seconds in the middle."""
    rng = np.random.default_rng([options.seed, 4])
    t = ticks(motion, GPS_RATE)
    positions, attitudes = motion.poses(t)
    antenna = np.array(RECEIVER.antenna)
    scale = RECEIVER.sigma * np.array([1.0, 1.0, 2.0])
    drift = options.noise * scale * _wandering(rng, len(t))
    measured = (positions + attitudes @ antenna) @ _to_enu().T + drift
    measured += options.noise * rng.normal(scale=RECEIVER.noise, size=measured.shape)
    velocities = motion.at(t, 1)[:, :3] @ _to_enu().T
    velocities += options.noise * rng.normal(scale=RECEIVER.velocity_noise, size=velocities.shape)
    covariance = np.diag(scale**2)
    for time, position, velocity in zip(t, measured, velocities, strict=True):
        if abs(time - motion.duration / 2) >= outage / 2:
            stamp_ns, arrival_ns = nanoseconds(time), nanoseconds(time + RECEIVER.latency)
            yield arrival_ns, GpsPosition(stamp_ns, position, covariance, antenna)
            yield arrival_ns, GpsVelocity(stamp_ns, velocity)


def _wandering(rng: np.random.Generator, count: int) -> Float64s:
    """(count, 3) of unit variance at GPS_RATE that forgets within RECEIVER.wander."""
    keep = float(np.exp(-1.0 / (GPS_RATE * RECEIVER.wander)))
    values = rng.normal(size=(count, 3))
    for i in range(1, count):
        values[i] = keep * values[i - 1] + np.sqrt(1.0 - keep**2) * values[i]
    return values


def _to_enu() -> Float64s:
    c, s = np.cos(MAP_YAW), np.sin(MAP_YAW)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def ground_distances(scene: Scene, options: SceneOptions) -> Iterator[Arrival]:
    """Along a beam straight down in the axes of the base; water is ground to it."""
    rng = np.random.default_rng([options.seed, 5])
    t = ticks(scene.motion, GROUND_RATE)
    positions, attitudes = scene.motion.poses(t)
    origin, direction = np.array(RANGEFINDER.origin), np.array([0.0, 0.0, -1.0])
    firm = replace(scene.world, water=False)
    true, _ = firm.cast(positions + attitudes @ origin, attitudes @ direction, RANGEFINDER.reach)
    measured = true + options.noise * rng.normal(scale=RANGEFINDER.noise, size=len(t))
    for time, distance in zip(t, measured, strict=True):
        if distance <= RANGEFINDER.reach:
            arrival_ns = nanoseconds(time + RANGEFINDER.latency)
            yield arrival_ns, GroundDistance(nanoseconds(time), float(distance), origin, direction)
