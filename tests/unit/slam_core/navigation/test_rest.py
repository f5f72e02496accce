"""Rest or motion, by two scans."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from slam_core import geometry
from slam_core.measurements import LaserScan, Transform
from slam_core.navigation.rest import shows_motion

BEAMS = 361
ANGLES = np.linspace(-np.pi / 2, np.pi / 2, BEAMS)
Ranges = np.ndarray


def room(moved: float = 0.0, noise: float = 0.01, seed: int = 0) -> Ranges:
    """Ranges to a wall 4 m ahead and to walls 3 m aside, after some metres ahead."""
    with np.errstate(divide="ignore"):
        ahead = (4.0 - moved) / np.cos(ANGLES)
        aside = 3.0 / np.abs(np.sin(ANGLES))
    return np.minimum(ahead, aside) + noise * np.random.default_rng(seed).standard_normal(BEAMS)


def scan(ranges: Ranges) -> LaserScan:
    """At once."""
    return LaserScan(0, ranges.astype(np.float32), -np.pi / 2, np.pi / (BEAMS - 1))


def with_strays(ranges: Ranges, seed: int) -> Ranges:
    """Three beams of ten hit something near."""
    rng = np.random.default_rng(seed)
    return np.where(rng.random(BEAMS) < 0.3, rng.uniform(0.2, 3.0, BEAMS), ranges)


def without(ranges: Ranges, share: float) -> Ranges:
    """A share of the beams comes back from nowhere."""
    return np.where(np.arange(BEAMS) < share * BEAMS, np.inf, ranges)


@pytest.mark.parametrize("noise", [0.0, 0.01, 0.03, 0.1])
def test_noise_is_no_motion(noise: float) -> None:
    """However large it is, as it shows within each scan."""
    assert not shows_motion(scan(room(noise=noise)), scan(room(noise=noise, seed=1)))


def test_stray_beams_are_no_motion() -> None:
    """Rain or dust is there at rest, too."""
    assert not shows_motion(scan(with_strays(room(), 2)), scan(with_strays(room(seed=1), 3)))


@pytest.mark.parametrize("change", [lambda r: r, lambda r: without(r, 0.3), lambda r: without(r, 0.0)])
def test_a_base_that_drives_is_seen(change: Callable[[Ranges], Ranges]) -> None:
    """Two decimetres are enough, also where some beams see nothing."""
    assert shows_motion(scan(change(room())), scan(change(room(0.2, seed=1))))


def test_a_laser_that_a_servo_turned_shows_nothing() -> None:
    """Scans of another mount, or with beams of other angles, see other walls while the base rests."""
    before, now = scan(room()), scan(np.roll(room(), 40))
    assert shows_motion(before, now)
    turned = Transform(rotation=geometry.yaw_quaternion(0.35))
    assert not shows_motion(before, replace(now, T_base_laser=turned))
    assert not shows_motion(before, replace(now, angle_min=now.angle_min + 0.35))


def test_scans_that_cannot_be_compared_show_nothing() -> None:
    """Other beams, or hardly any."""
    other = scan(room(0.2))
    assert not shows_motion(scan(room()[:-1]), other)
    assert not shows_motion(scan(without(room(), 0.97)), other)
    assert not shows_motion(scan(np.full(BEAMS, np.nan)), other)
