"""The navigation filter alone, on three inertial units that nothing else helps."""

from pathlib import Path

import numpy as np
import pytest

from benchmarks.cases import INERTIAL
from benchmarks.inertial import Ride, degrees, ride

pytestmark = pytest.mark.real


def ridden(_: Path, name: str) -> Ride:
    """The filter's way through the recording of that device."""
    return ride(next(recording for recording in INERTIAL if name in recording.name))


def test_the_device_upside_down_stands_level_once_it_is_turned(recordings: Path) -> None:
    """A minute on a turntable: up stays within two degrees of gravity, and the base is level within three."""
    phidgets = ridden(recordings, "phidgets")
    assert phidgets.astray < 2.0
    assert degrees(phidgets.ours, np.array([[0.0, 0.0, 1.0]])).max() < 3.0
    assert phidgets.own_astray is phidgets.apart is None


def test_attitude_beside_that_of_the_device_itself(recordings: Path) -> None:
    """In somebody's hands: at rest the filter is on gravity where the device's own attitude is not.

    The two differ by some 12 degrees rms; at rest before the first move, the device's own is that far off gravity.
    """
    drone = ridden(recordings, "ardrone")
    assert drone.apart is not None
    assert drone.own_astray is not None
    assert drone.apart < 15.0
    before = slice(0, 150)
    assert degrees(drone.ours, drone.felt)[before].mean() < 0.5
    assert degrees(drone.own, drone.felt)[before].mean() > 10.0
    assert drone.astray < drone.own_astray


def test_shaking_leaves_the_filter_sound(recordings: Path) -> None:
    """Half a minute of turns up to 40 rad/s: finite, with a covariance, and up at rest within 8 degrees."""
    razor = ridden(recordings, "razor")
    assert np.isfinite(razor.state.T_map_base.rotation).all()
    assert np.linalg.eigvalsh(razor.state.covariance).min() > 0.0
    assert razor.astray < 8.0
