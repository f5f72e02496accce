"""A drive of a base that looks another way is the same drive."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.accuracy import outcome, process
from benchmarks.cases import DRIVE_SEEDS, METHODS
from benchmarks.turned import angle_of, turned
from hectorscope.simulation import SceneOptions, Simulation
from slam_core import geometry
from slam_core.measurements import Imu, LaserScan, Odometry, TruthPose

SHORT = SceneOptions(duration=5.0, scan_rate=10.0, beams=271, sway=15.0, sway_frequency=1.2)


def test_a_turned_base_is_followed_as_well() -> None:
    """Scans, inertial data and truth are turned alike: through sway and a curve all agree within 5 cm."""
    items = list(Simulation("rooms", replace(SHORT, seed=1)).items())
    assert outcome(process(turned(items, 1.0), METHODS["full"])).raw < 0.05


def test_walls_lie_at_the_angle() -> None:
    """The laser looks back by what the base was turned; the base begins where the map does."""
    items = list(turned(Simulation("rooms", SHORT).items(), 1.0))
    scan = next(item for item in items if isinstance(item, LaserScan))
    truth = next(item for item in items if isinstance(item, TruthPose))
    assert geometry.heading(scan.T_base_laser.rotation) == pytest.approx(-1.0)
    assert geometry.planar(truth.T_map_base) == pytest.approx(np.zeros(3), abs=1e-3)


def test_turned_back_it_is_as_it_was() -> None:
    """Forth and back leaves every inertial sample as it was."""
    items = list(Simulation("rooms", SHORT).items())
    again = list(turned(turned(items, 0.7), -0.7))
    for before, after in zip(items, again, strict=True):
        assert type(before) is type(after)
        if isinstance(before, Imu) and isinstance(after, Imu):
            assert after.angular_velocity == pytest.approx(before.angular_velocity)
            assert after.linear_acceleration == pytest.approx(before.linear_acceleration)


def test_what_cannot_be_turned_is_named() -> None:
    """Wheels roll along their own base."""
    with pytest.raises(TypeError, match="Odometry"):
        list(turned([Odometry(0, np.zeros(2), 0.0)], 1.0))


def test_every_seed_has_an_angle_of_its_own() -> None:
    """Within a right angle, after which walls are square to the cells again."""
    angles = [angle_of(seed) for seed in DRIVE_SEEDS]
    assert len(set(angles)) == len(angles)
    assert 0.0 < min(angles) < 0.3 < 1.2 < max(angles) < np.pi / 2.0
