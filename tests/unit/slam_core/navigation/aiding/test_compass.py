"""North in the map, learned while the map is trusted."""

import math

import pytest

from slam_core.navigation.aiding.compass import Compass


def test_north_is_the_mean_across_half_a_turn() -> None:
    """Directions just short of and just past pi average to pi; a far one later on is left out."""
    compass = Compass()
    for direction in (math.pi - 0.1, -math.pi + 0.1) * 2:
        compass.learn_north(direction, 1.0, 0.1)
    assert abs(compass.north) == pytest.approx(math.pi)
    compass.learn_north(0.0, 1.0, 0.1)
    assert abs(compass.north) == pytest.approx(math.pi)
