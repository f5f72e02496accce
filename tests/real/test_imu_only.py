"""The navigation filter alone, on three inertial units that nothing else helps."""

from pathlib import Path

import numpy as np
import pytest

from app.sources import SourceOptions
from app.sources.bag import open_bag
from slam_core import geometry
from slam_core.config import SlamConfig
from slam_core.measurements import Attitude, Float64s, Imu
from slam_core.navigation import NavigationFilter

pytestmark = pytest.mark.real

QUIET = 0.05  # rad/s: slower than this nobody moves the device
FORCE = 0.3  # m/s²: closer than this to gravity it does not accelerate


class Ride:
    """Up in the axes of the device, sample by sample: by the filter, the accelerometer, the device itself."""

    def __init__(self, path: Path, options: SourceOptions) -> None:
        self.filter = NavigationFilter(SlamConfig().navigation)
        ours, felt, own, still = [], [], [], []
        for item in open_bag(path, options).items():
            if isinstance(item, Imu):
                self.filter.predict(item)
                sample = item
            elif isinstance(item, Attitude):
                own.append(_up(item.rotation))
            if isinstance(item, Imu) and self.filter.ready:
                force = float(np.linalg.norm(item.linear_acceleration))
                ours.append(_up(self.filter.pose(item.stamp_ns).rotation))
                felt.append(sample.linear_acceleration / max(force, 1e-9))
                still.append(np.abs(item.angular_velocity).max() < QUIET and abs(force - 9.8) < FORCE)
        self.ours, self.felt, self.own = np.array(ours), np.array(felt), np.array(own[-len(ours) :])
        self.still = np.array(still)


def _up(rotation: Float64s) -> Float64s:
    return geometry.rotate(geometry.conjugate(rotation), np.array([0.0, 0.0, 1.0]))


def degrees(a: Float64s, b: Float64s) -> Float64s:
    """Angles (n,) between directions (n, 3)."""
    between: Float64s = np.degrees(np.arccos(np.clip(np.sum(a * b, axis=1), -1.0, 1.0)))
    return between


def test_the_device_upside_down_stands_level_once_it_is_turned(recordings: Path) -> None:
    """A minute on a turntable: up stays within two degrees of gravity, and the base is level within three."""
    path = recordings / "imu_only" / "phidgets_imu_upside_down.bag"
    ride = Ride(path, SourceOptions(imu_rotation=(3.14159, 0.0, 0.0)))
    assert np.median(degrees(ride.ours, ride.felt)) < 2.0
    assert degrees(ride.ours, np.array([[0.0, 0.0, 1.0]])).max() < 3.0


def test_attitude_beside_that_of_the_device_itself(recordings: Path) -> None:
    """In somebody's hands: at rest the filter is on gravity where the device's own attitude is not.

    The two differ by some 12 degrees rms; at rest before the first move, the device's own is that far off gravity.
    """
    ride = Ride(recordings / "imu_only" / "ardrone_imu.bag", SourceOptions(attitude_topic="/ardrone/imu"))
    difference = degrees(ride.ours, ride.own)
    assert np.sqrt(np.mean(difference**2)) < 15.0
    before = slice(0, 150)
    assert degrees(ride.ours, ride.felt)[before].mean() < 0.5
    assert degrees(ride.own, ride.felt)[before].mean() > 10.0
    still = ride.still
    assert np.median(degrees(ride.ours, ride.felt)[still]) < np.median(degrees(ride.own, ride.felt)[still])


def test_shaking_leaves_the_filter_sound(recordings: Path) -> None:
    """Half a minute of turns up to 40 rad/s: finite, with a covariance, and up at rest within 20 degrees."""
    ride = Ride(recordings / "imu_only" / "sparkfun_razor.bag", SourceOptions())
    state = ride.filter.state
    assert np.isfinite(state.T_map_base.rotation).all()
    assert np.linalg.eigvalsh(state.covariance).min() > 0.0
    assert np.median(degrees(ride.ours, ride.felt)[ride.still]) < 20.0
