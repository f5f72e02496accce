"""Courses over the ground."""

import numpy as np

from hectorscope.simulation.course import STILL, Pace, follow

SQUARE = np.array([(0, 0), (6, 0), (6, 6), (-2, 6), (-2, 0)], dtype=np.float64)
PACE = Pace(speed=1.0, turn_rate=0.8, acceleration=0.5, radius=1.0)


def sampled(duration: float, rate: float = 100.0) -> tuple[np.ndarray, np.ndarray]:
    t = np.arange(0.0, duration, 1 / rate)
    return t, follow(SQUARE, PACE, duration)(t)


def test_rests_at_the_first_waypoint() -> None:
    """Until STILL nothing moves: x, y and yaw are zero, along the first stretch."""
    t, course = sampled(10.0)
    np.testing.assert_allclose(course[t < STILL], 0.0, atol=1e-9)
    assert course[t > STILL + 2.0][0, 0] > 0.5


def test_keeps_its_limits() -> None:
    """Speed, turn rate and acceleration stay within the pace, and each limit is used."""
    t, course = sampled(60.0, rate=20.0)
    rate = np.gradient(course, t, axis=0)
    speed, turning = np.hypot(rate[:, 0], rate[:, 1]), np.abs(rate[:, 2])
    assert 0.99 < speed.max() < 1.005
    assert 0.78 < turning.max() < 0.82
    under_way = t > STILL + 0.3  # the first centimetre is a step
    assert np.abs(np.gradient(speed, t))[under_way].max() < 0.6


def test_rounds_the_corners() -> None:
    """The course stays inside the polygon and passes each corner at the distance of an arc of the radius."""
    _, course = sampled(60.0)
    for corner in SQUARE[1:]:
        nearest = np.hypot(*(course[:, :2] - corner).T).min()
        assert 0.35 < nearest < 0.6  # (sqrt(2) - 1) radius, a little more by the smoothing
    assert course[:, 0].min() > -2.001
    assert course[:, 0].max() < 6.001


def test_heads_along_the_path_and_comes_round() -> None:
    """Yaw is the direction of travel, and two laps are two turns."""
    t, course = sampled(120.0)
    moving = t > STILL + 1.0
    rate = np.gradient(course, t, axis=0)[moving]
    error = np.angle(np.exp(1j * (np.arctan2(rate[:, 1], rate[:, 0]) - course[moving, 2])))
    assert np.abs(error).max() < 0.05
    again = np.flatnonzero(np.diff(np.sign(course[:, 0] * (np.abs(course[:, 1]) < 0.1))) > 0)
    assert len(again) >= 2
    assert course[-1, 2] > 2 * 2 * np.pi
