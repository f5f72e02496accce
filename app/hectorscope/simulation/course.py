"""A closed course over the ground: rounded corners, a speed that respects the turns, round after round."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from slam_core.measurements import Float64s

SPACING = 0.01  # m between samples of the path
STILL = 2.5  # s at rest before the start, so that a filter can settle


@dataclass(frozen=True, slots=True)
class Pace:
    """How a vehicle drives: m/s, rad/s in turns, m/s^2, and the radius of its corners in metres."""

    speed: float
    turn_rate: float
    acceleration: float
    radius: float


def follow(waypoints: Float64s, pace: Pace, duration: float) -> Callable[[Float64s], Float64s]:
    """(m,) seconds -> (m, 3) x, y, yaw on the closed course through (k, 2) waypoints, heading along the path.

    The first waypoint must lie on a straight stretch: there the motion rests for STILL seconds.
    """
    lap = _smooth(_rounded(waypoints, pace.radius), max(0.1, 0.4 * pace.radius))
    length = len(lap) * SPACING
    rounds = int(np.ceil(duration * pace.speed / length)) + 1
    path = np.tile(lap, (rounds, 1))
    tangent = np.roll(path, -1, axis=0) - np.roll(path, 1, axis=0)
    yaw = np.unwrap(np.arctan2(tangent[:, 1], tangent[:, 0]))
    times = STILL + _schedule(yaw, pace)
    samples = np.column_stack((path, yaw))
    return lambda t: np.column_stack([np.interp(t, times, column) for column in samples.T])


def _rounded(waypoints: Float64s, radius: float) -> Float64s:
    """(n, 2) points every SPACING along the closed polygon with each corner replaced by an arc."""
    before, after = np.roll(waypoints, 1, axis=0), np.roll(waypoints, -1, axis=0)
    corners = [_arc(a, b, c, radius) for a, b, c in zip(before, waypoints, after, strict=True)]
    outline = np.concatenate([*corners, corners[0][:1]])
    station = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(outline, axis=0), axis=1))))
    count = round(station[-1] / SPACING)
    even = np.linspace(0.0, station[-1], count, endpoint=False)
    points = np.column_stack([np.interp(even, station, axis) for axis in outline.T])
    start = int(np.argmin(np.linalg.norm(points - waypoints[0], axis=1)))
    shifted: Float64s = np.roll(points, -start, axis=0) - points[start] + waypoints[0]
    return shifted


def _arc(a: Float64s, b: Float64s, c: Float64s, radius: float) -> Float64s:
    """Points of the arc that rounds the corner a-b-c; b itself on a straight stretch."""
    u, v = (b - a) / np.linalg.norm(b - a), (c - b) / np.linalg.norm(c - b)
    turn = np.arctan2(u[0] * v[1] - u[1] * v[0], u @ v)
    if abs(turn) < 1e-6:
        return b[None, :]
    reach = min(radius * np.tan(abs(turn) / 2), 0.5 * np.linalg.norm(b - a), 0.5 * np.linalg.norm(c - b))
    bend = reach / np.tan(abs(turn) / 2)
    centre = b - reach * u + bend * np.sign(turn) * np.array([-u[1], u[0]])
    first = np.arctan2(u[1], u[0]) - np.sign(turn) * np.pi / 2
    angles = first + np.linspace(0.0, turn, max(3, int(abs(turn) * bend / SPACING)))
    arc: Float64s = centre + bend * np.column_stack((np.cos(angles), np.sin(angles)))
    return arc


def _smooth(lap: Float64s, width: float) -> Float64s:
    """The closed lap averaged over a Hann window `width` metres wide: turns begin and end gently."""
    half = max(1, round(width / 2 / SPACING))
    window = np.hanning(2 * half + 3)[1:-1]
    padded = np.concatenate((lap[-half:], lap, lap[:half]))
    return np.column_stack([np.convolve(axis, window / window.sum(), "valid") for axis in padded.T])


def _schedule(yaw: Float64s, pace: Pace) -> Float64s:
    """(n,) seconds at which each sample of the path is reached, from rest, within the limits of `pace`."""
    curvature = np.abs(np.gradient(yaw)) / SPACING
    speed = np.minimum(pace.speed, pace.turn_rate / np.maximum(curvature, 1e-9))
    speed[0] = 0.0
    gain = 2 * pace.acceleration * SPACING
    for i in range(1, len(speed)):
        speed[i] = min(speed[i], np.sqrt(speed[i - 1] ** 2 + gain))
    for i in range(len(speed) - 2, 0, -1):
        speed[i] = min(speed[i], np.sqrt(speed[i + 1] ** 2 + gain))
    return np.concatenate(([0.0], np.cumsum(2 * SPACING / (speed[1:] + speed[:-1]))))
