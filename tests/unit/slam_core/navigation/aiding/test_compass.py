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


def test_a_north_that_stays_elsewhere_is_learned_anew() -> None:
    """A load of steel turns the field for good; metal that is passed by does not."""
    compass = Compass()
    for direction in (0.3,) * 20 + (1.0,) * 9 + (0.3,) + (1.0,) * 9:
        compass.learn_north(direction, 1.0, 0.1)
    assert compass.north == pytest.approx(0.3)
    compass.learn_north(1.0, 1.0, 0.1)
    assert compass.north == pytest.approx(1.0)
    assert compass.norths == 1.0


def test_a_field_with_nothing_new_teaches_nothing() -> None:
    """Such as the first one, if its stamp is not later than that of one before."""
    compass = Compass()
    compass.learn_north(1.0, 0.0, 0.1)
    assert compass.norths == 0.0
