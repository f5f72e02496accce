"""Streets and corridors of any length, and scans of a drive through them: cheap, exact, and with known truth.

The free space is a union of upright rectangles. A beam goes from rectangle to rectangle until none holds it.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numba import njit

from slam_core.measurements import Float32s, Float64s, LaserScan, Odometry

BEAMS, VIEW = 1081, math.radians(270.0)
RANGE, NOISE = 30.0, 0.01  # metres
SPEED, TURN, RATE = 8.0, math.radians(120.0), 20.0  # m/s, rad/s, scans a second
ACCELERATION = 4.0  # m/s^2
NICHES = (3.0, 12.0)  # metres along the way between changes of its width
CORRIDOR, STREET = (1.3, 2.2), (6.0, 10.0)  # metres from the middle to either side
TINY = 1e-6  # metres that a beam goes into the next rectangle


@dataclass(frozen=True, slots=True, eq=False)
class Streets:
    """corners: (n, 2) of the way, metres; legs are parallel to the axes. boxes: (m, 4) x0, x1, y0, y1, free."""

    corners: Float64s
    boxes: Float64s

    @property
    def length(self) -> float:
        """Of the way, metres."""
        return float(np.abs(np.diff(self.corners, axis=0)).sum())


def streets(legs: list[float], seed: int = 0) -> Streets:
    """Legs of so many metres, to the east and to the north in turn; every other two of them are streets."""
    rng, corners, boxes = np.random.default_rng(seed), [np.zeros(2)], []
    for k, length in enumerate(legs):
        widths, along, x = STREET if k // 2 % 2 else CORRIDOR, np.eye(2)[k % 2], 0.0
        while x < length:
            piece = min(rng.uniform(*NICHES), length - x)
            left, right = rng.uniform(*widths, 2)
            ends = np.array([corners[-1] + x * along, corners[-1] + (x + piece) * along])
            low, high = ends.min(axis=0) - right * along[::-1], ends.max(axis=0) + left * along[::-1]
            boxes.append([low[0], high[0], low[1], high[1]])
            x += piece
        corners.append(corners[-1] + length * along)
        half = STREET[1] if k // 2 % 2 or (k + 1) // 2 % 2 else CORRIDOR[1]
        (a, b) = corners[-1]
        boxes.append([a - half, a + half, b - half, b + half])
    return Streets(np.array(corners), np.array(boxes))


def drive(world: Streets, seed: int = 1, rate: float = RATE) -> Iterator[tuple[Odometry, LaserScan, Float64s]]:
    """What wheels and laser measure on the way, a scan at a time, and the true pose (3,), the first the origin."""
    rng, stamp_ns = np.random.default_rng(seed), 0
    for pose, velocity, turn in _poses(world, rate):
        yield Odometry(stamp_ns, np.array([velocity, 0.0]), turn), scan(world, pose, stamp_ns, rng), pose
        stamp_ns += round(1e9 / rate)


def scan(world: Streets, pose: Float64s, stamp_ns: int, rng: np.random.Generator) -> LaserScan:
    """A scan from a pose (3,)."""
    off = np.abs(world.boxes.reshape(-1, 2, 2) - pose[:2, None])
    inside = (world.boxes[:, ::2] <= pose[:2]) & (pose[:2] <= world.boxes[:, 1::2])
    near = (inside | (off.min(axis=2) < RANGE)).all(axis=1)
    ranges = np.empty(BEAMS, np.float32)
    _cast(np.ascontiguousarray(world.boxes[near]), pose, -0.5 * VIEW, VIEW / (BEAMS - 1), ranges)
    ranges += (NOISE * rng.standard_normal(BEAMS)).astype(np.float32)
    ranges[ranges > RANGE] = np.inf
    return LaserScan(stamp_ns, ranges, -0.5 * VIEW, VIEW / (BEAMS - 1), range_min=0.1, range_max=RANGE)


def _poses(world: Streets, rate: float) -> Iterator[tuple[Float64s, float, float]]:
    """Poses (3,) with velocity and turn: a second at rest, each leg from rest to rest, turns on the spot."""
    heading = 0.0
    for _ in range(round(rate)):
        yield np.zeros(3), 0.0, 0.0
    for begin, end in zip(world.corners[:-1], world.corners[1:], strict=True):
        wanted = math.atan2(*(end - begin)[::-1])
        turns = math.ceil(abs(wanted - heading) / TURN * rate)
        for k in range(turns):
            angle = heading + (wanted - heading) * (k + 1) / turns
            yield np.array([*begin, angle]), 0.0, (wanted - heading) / turns * rate
        heading, length = wanted, float(np.abs(end - begin).sum())
        for covered, speed in _leg(length, rate):
            yield np.array([*(begin + (end - begin) * covered / length), heading]), speed, 0.0


def _leg(length: float, rate: float) -> Iterator[tuple[float, float]]:
    """Metres covered, and the speed there: gathered and lost at ACCELERATION, as wheels can."""
    top = min(SPEED, math.sqrt(length * ACCELERATION))
    gathering = top / ACCELERATION
    lasts = length / top + gathering
    steps = math.ceil(lasts * rate)
    for k in range(1, steps + 1):
        t = lasts * k / steps
        left = lasts - t
        speed = min(top, ACCELERATION * t, ACCELERATION * left)
        if t < gathering:
            yield 0.5 * speed * t, speed
        elif left < gathering:
            yield length - 0.5 * speed * left, speed
        else:
            yield top * (t - 0.5 * gathering), speed


@njit(cache=True)
def _cast(boxes: Float64s, pose: Float64s, first: float, step: float, ranges: Float32s) -> None:
    """Metres to where each beam leaves the last rectangle (m, 4), into `ranges` (n,); 2 RANGE at most."""
    for i in range(len(ranges)):
        c, s = math.cos(pose[2] + first + i * step), math.sin(pose[2] + first + i * step)
        far, further = 0.0, True
        while further and far < 2.0 * RANGE:
            further = False
            x, y = pose[0] + (far + TINY) * c, pose[1] + (far + TINY) * s
            for k in range(len(boxes)):
                if boxes[k, 0] <= x <= boxes[k, 1] and boxes[k, 2] <= y <= boxes[k, 3]:
                    u = (boxes[k, 1 if c > 0.0 else 0] - pose[0]) / c if abs(c) > 1e-12 else np.inf
                    v = (boxes[k, 3 if s > 0.0 else 2] - pose[1]) / s if abs(s) > 1e-12 else np.inf
                    if min(u, v) > far:
                        far, further = min(u, v), True
        ranges[i] = far
