"""Robots that wheels and a laser measure, and no IMU."""

import pytest

from slam_core.navigation.rejections import SLIPPED
from tests.cases import quick_first
from tests.ensemble import failures, items_of, outcomes, told

VARIANTS = range(1, 5)


@pytest.mark.parametrize("case", quick_first(["people, with wheels, 4 m", "rooms, with wheels, 4 m"]))
def test_a_laser_that_sees_four_metres_is_enough_with_wheels(case: str) -> None:
    """Where wheels weigh no more than another prediction, somebody who walks along drags the match off."""
    found, otherwise = (outcomes(case, VARIANTS, {"matcher.wheels_weight": weight}) for weight in (10.0, 0.0))
    assert sum(each.error for each in found) < 0.8 * sum(each.error for each in otherwise)
    assert failures(found) <= 1


def test_somebody_who_walks_along_drags_no_match_off() -> None:
    """Wheels know better, so that a match far from their prediction leaves out the foreground."""
    assert not failures(outcomes("people, with wheels, 6 m", [1, 6], {}))


@pytest.mark.parametrize(
    "case", quick_first(["offices, wheels stuck for 2 s in 10", "offices, wheels that spin for 2 s in 10"])
)
def test_wheels_that_slip_are_no_better_than_the_scans(case: str) -> None:
    """Known walls contradict them."""
    assert not failures(outcomes(case, VARIANTS, {}))


def test_the_user_is_told_of_wheels_that_spin() -> None:
    """They are counted, and the faults of the sensors name them."""
    pipeline, faults = told(items_of("rooms, wheels that spin for 2 s in 10"))
    assert "wheels_slip" in faults
    assert pipeline.slam.status.unused[SLIPPED] > 50


def test_wheels_that_roll_are_used_all() -> None:
    """No fault is reported."""
    pipeline, faults = told(items_of("people, with wheels, 6 m"))
    assert not faults
    assert not pipeline.slam.status.unused[SLIPPED]
