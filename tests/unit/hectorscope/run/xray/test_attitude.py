"""Eq. (1) near 90 degrees of pitch."""

import math

import numpy as np
import pytest

from hectorscope.run.xray.attitude import OMEGA, RATE, REACH, passage
from slam_core import geometry
from slam_core.config import NavigationConfig
from slam_core.reference.navigation_filter import initial_state, predict


def test_angles_do_where_no_pole_is_near():
    """Both ways end at the same attitude, to a hundredth of a degree."""
    for pitch in (0.0, 20.0, 30.0):
        found = passage(math.radians(pitch))
        assert math.degrees(found.by_angles) < 0.01
        assert math.degrees(found.by_quaternion) < 1e-6


def test_angles_fail_where_the_turn_passes_90_degrees():
    """The quaternion does not notice; Euler angles end a degree off and more."""
    for pitch in (60.0, 75.0, 85.0):
        found = passage(math.radians(pitch))
        assert math.degrees(found.by_angles) > 1.0
        assert math.degrees(found.by_quaternion) < 1e-6
    assert np.abs(passage(math.pi / 2).E).max() > 1e15


def test_the_quaternion_is_turned_as_by_the_filter():
    """The reference filter, without noise, ends at the same attitude as the closed form."""
    pitch, config = math.radians(75.0), NavigationConfig()
    begin = geometry.from_euler(0.0, pitch - REACH, 0.0)
    force = geometry.rotate(geometry.conjugate(begin), np.array([0.0, 0.0, config.gravity]))
    state = initial_state(np.tile([0.0, 0.0, 0.0, *force], (5, 1)), config)
    for _ in range(RATE):
        state = predict(state, np.array([*OMEGA, 0.0, 0.0, 0.0]), 1.0 / RATE, config)
    end = geometry.multiply(begin, geometry.from_rotation_vector(OMEGA))
    assert abs(float(end @ state.q)) == pytest.approx(1.0, abs=1e-5)
