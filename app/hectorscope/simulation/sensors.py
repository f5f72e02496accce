"""Laser, inertial unit and barometer: what they measure of the true motion, with the errors of real parts."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from hectorscope.simulation.beams import first_returns
from hectorscope.simulation.motion import Motion
from hectorscope.simulation.options import SceneOptions
from hectorscope.simulation.scanner import Scanner
from hectorscope.simulation.scene import Scene
from slam_core.measurements import Aid, Float64s, Height, Imu, LaserScan, TruthPose

START_NS = 1_700_000_000 * 10**9  # the time on the clock when a motion begins
IMU_RATE, HEIGHT_RATE, TRUTH_RATE = 100.0, 10.0, 100.0  # Hz

Arrival = tuple[int, LaserScan | Imu | Aid | TruthPose]
"""When a measurement reached the recorder [ns], and the measurement."""


@dataclass(frozen=True, slots=True)
class Mems:
    """A consumer inertial unit, rad/s and m/s^2: noise of a sample at IMU_RATE, largest bias, its random walk."""

    gyro_noise: float = 0.005
    gyro_bias: float = float(np.radians(0.5))
    gyro_walk: float = 2e-5  # per sqrt(s)
    accel_noise: float = 0.03
    accel_bias: float = 0.05
    accel_walk: float = 2e-4  # per sqrt(s)
    latency: float = 0.001


@dataclass(frozen=True, slots=True)
class Barometer:
    """A pressure sensor, as metres of height."""

    noise: float = 0.15
    walk: float = 0.01  # per sqrt(s)
    latency: float = 0.004


MEMS, BAROMETER = Mems(), Barometer()


def nanoseconds(t: float) -> int:
    """The clock at `t` seconds of the motion."""
    return START_NS + round(t * 1e9)


def laser_scans(scene: Scene, options: SceneOptions) -> Iterator[Arrival]:
    """Every complete sweep of the motion, when its last beam has been handed over."""
    rng, panes = np.random.default_rng([options.seed, 0]), np.random.default_rng([options.seed, 3])
    scanner, period = scene.scanner, 1.0 / options.scan_rate
    increment = scanner.field / (options.beams - 1)
    time_increment = period * increment / (2 * np.pi) if options.beam_timing else 0.0
    count = np.arange(options.beams, dtype=np.float64)
    angles, lapse = increment * count - scanner.field / 2, time_increment * count
    for k in range(int((scene.motion.duration - lapse[-1]) / period) + 1):
        t = k * period
        true, depths = first_returns(scene, t + lapse, angles, scanner.range_max, panes)
        scan = LaserScan(
            stamp_ns=nanoseconds(t),
            ranges=measured(scanner, true, depths, options.noise, rng).astype(np.float32),
            angle_min=float(angles[0]),
            angle_increment=float(increment),
            time_increment=float(time_increment),
            range_min=scanner.range_min,
            range_max=scanner.range_max,
            T_base_laser=scene.T_base_laser,
        )
        yield scan.end_ns + round(scanner.latency * 1e9 * rng.uniform(1.0, 1.5)), scan


def measured(
    scanner: Scanner, true: Float64s, depths: Float64s, noise: float, rng: np.random.Generator
) -> Float64s:
    """(n,) ranges as the scanner reports them, after REP-117: noise, foliage, drop-outs, millimetres."""
    white, inward, luck = rng.normal(size=len(true)), np.abs(rng.normal(size=len(true))), rng.random(len(true))
    growth = (scanner.sigma_far - scanner.sigma_near) / (scanner.range_max - scanner.sigma_near_to)
    sigma = scanner.sigma_near + growth * np.clip(true - scanner.sigma_near_to, 0.0, scanner.range_max)
    measured = true + noise * (sigma * white + depths * inward)
    if noise > 0.0:
        measured = np.round(measured / scanner.resolution) * scanner.resolution
    measured[(measured > scanner.range_max) | (luck < noise * scanner.dropout)] = np.inf
    measured[measured < scanner.range_min] = -np.inf
    return measured


def inertial(motion: Motion, options: SceneOptions) -> Iterator[Arrival]:
    """Body rates and specific force, each with a constant bias, a wandering bias and white noise."""
    rng = np.random.default_rng([options.seed, 1])
    t = ticks(motion, IMU_RATE)
    rates = motion.body_rates(t) + options.noise * _drifting(
        rng, len(t), MEMS.gyro_bias, MEMS.gyro_walk, MEMS.gyro_noise
    )
    forces = motion.specific_force(t) + options.noise * _drifting(
        rng, len(t), MEMS.accel_bias, MEMS.accel_walk, MEMS.accel_noise
    )
    delays = MEMS.latency * rng.uniform(1.0, 1.5, len(t))
    for time, delay, omega, force in zip(t, delays, rates, forces, strict=True):
        yield nanoseconds(time + delay), Imu(nanoseconds(time), omega, force)


def _drifting(rng: np.random.Generator, count: int, bias: float, walk: float, noise: float) -> Float64s:
    """(count, 3) errors of three axes at IMU_RATE."""
    steps = rng.normal(scale=walk / np.sqrt(IMU_RATE), size=(count, 3))
    return rng.uniform(-bias, bias, size=3) + np.cumsum(steps, axis=0) + rng.normal(scale=noise, size=(count, 3))


def heights(motion: Motion, options: SceneOptions) -> Iterator[Arrival]:
    """Height over the start, with white noise and the slow drift of the weather."""
    rng = np.random.default_rng([options.seed, 2])
    t = ticks(motion, HEIGHT_RATE)
    drift = np.cumsum(rng.normal(scale=BAROMETER.walk / np.sqrt(HEIGHT_RATE), size=len(t)))
    errors = options.noise * (drift + rng.normal(scale=BAROMETER.noise, size=len(t)))
    over_start = motion.at(t)[:, 2] - motion.at(np.zeros(1))[0, 2]
    for time, height in zip(t, over_start + errors, strict=True):
        yield nanoseconds(time + BAROMETER.latency), Height(nanoseconds(time), float(height))


def truth(motion: Motion) -> Iterator[Arrival]:
    """The true pose, without delay."""
    for t in ticks(motion, TRUTH_RATE):
        yield nanoseconds(t), TruthPose(nanoseconds(t), motion.transform(t))


def ticks(motion: Motion, rate: float) -> Float64s:
    """Seconds at which a sensor measures, through the whole motion."""
    return np.arange(int(motion.duration * rate) + 1) / rate
