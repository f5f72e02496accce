"""The usual field, disturbances of it, and north."""

import math

import numpy as np
import pytest

from slam_core.navigation.aiding.compass import LEARNED, PATIENCE_NS, Compass, Field, seen

EARTH = Field(5e-5, 1.1, 0.3)
TENTH = 100_000_000


def learned() -> Compass:
    """A compass that knows the usual field."""
    compass = Compass()
    answers = [compass.check(EARTH, i * TENTH, 0.15) for i in range(LEARNED)]
    assert answers[-1] == ""
    assert all("not known yet" in answer for answer in answers[:-1])
    return compass


def test_a_field_is_taken_apart() -> None:
    """Size, dip below the horizon, and direction from x."""
    field = seen(np.array([0.0, 3e-5, -4e-5]))
    assert field == pytest.approx((5e-5, math.atan2(4.0, 3.0), math.pi / 2))


@pytest.mark.parametrize("changed", [EARTH._replace(size=6e-5), EARTH._replace(inclination=1.3)])
def test_metal_shows_in_size_or_dip(changed: Field) -> None:
    """A field that differs in either is doubted; one whose direction alone differs is not."""
    compass = learned()
    assert "disturbed" in compass.check(changed, 10 * TENTH, 0.15)
    assert compass.check(EARTH._replace(direction=2.0), 11 * TENTH, 0.15) == ""


def test_a_change_that_lasts_is_the_new_usual() -> None:
    """After some seconds of the same disturbance it is learned anew."""
    compass, changed = learned(), EARTH._replace(size=7e-5)
    compass.learn_north(0.3, 1.0, 0.1)
    assert "disturbed" in compass.check(changed, 0, 0.15)
    assert "disturbed" in compass.check(changed, PATIENCE_NS - 1, 0.15)
    assert [compass.check(changed, PATIENCE_NS + i, 0.15) for i in range(LEARNED)][-1] == ""
    assert compass.norths == 0.0


def test_north_is_the_mean_across_half_a_turn() -> None:
    """Directions just short of and just past pi average to pi; a far one later on is left out."""
    compass = Compass()
    for direction in (math.pi - 0.1, -math.pi + 0.1) * 2:
        compass.learn_north(direction, 1.0, 0.1)
    assert abs(compass.north) == pytest.approx(math.pi)
    compass.learn_north(0.0, 1.0, 0.1)
    assert abs(compass.north) == pytest.approx(math.pi)
