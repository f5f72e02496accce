"""What hides the walls, repeats a scan or breaks off, again and again: the map stays right."""

from itertools import pairwise

import numpy as np
import pytest

from benchmarks import ensemble_cases, ensembles
from slam_core.config import SlamConfig
from slam_core.diagnostics import REPEATED
from tests.ensemble import told

CASES = {each.name: each for each in ensemble_cases.cases()}


def outcome(name: str, variant: int) -> ensembles.Outcome:
    """Of a variant of an ensemble."""
    items = CASES[name].load(variant)
    run = ensembles.follow(ensembles.varied(items, variant), SlamConfig(), items[0].stamp_ns)
    return ensembles.outcomes([run])[0]


@pytest.mark.parametrize(
    ("name", "limit"),
    [
        ("arena, covered for 2 s in 10", 0.15),
        ("rooms, covered for 5 s in 15", 0.15),
        ("rooms, 4 people around for 4 s in 10", 0.02),
        ("arena, scans repeated for 2 s in 10", 0.02),
        ("people, scans repeated for 5 s in 15", 0.05),
        ("handheld, IMU repeats itself for 3 s in 12", 0.15),
        ("arena, no data for 1 s in 6", 0.05),
        pytest.param("rooms, scans repeated for 2 s in 10", 0.02, marks=pytest.mark.slow),
        pytest.param("littoral, no data for 1 s in 6", 0.2, marks=pytest.mark.slow),
    ],
)
def test_inertial_data_carry_a_robot_through_what_its_laser_does_not_see(name: str, limit: float) -> None:
    """Its pose is off by as much as it drifts meanwhile, and no scan is written at a wrong place."""
    found = outcome(name, 2)
    assert found.error < limit
    assert not (found.lost or found.misplaced or found.silent)


@pytest.mark.parametrize("variant", [2, 3, 12])
def test_by_inertial_data_no_companion_holds_a_robot_back(variant: int) -> None:
    """They walk beside it, half out of its view, and 6 m far next to nothing else tells how far it has come."""
    found = outcome("people, 6 m", variant)
    assert found.error < 0.15
    assert not (found.lost or found.misplaced or found.silent)


@pytest.mark.parametrize("variant", [4, 11])
def test_a_covered_boat_on_its_way_out_of_the_map_does_not_continue_it_with_what_covers_it(variant: int) -> None:
    """Ahead nothing is known: there the hand hides no wall. Its way is that of the inertial data."""
    found = outcome("littoral, covered for 2 s in 10", variant)
    assert found.error < 0.15
    assert not (found.lost or found.misplaced or found.silent)


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["rooms, laser alone, covered for 2 s in 10", "rooms, laser alone, 4 people around for 4 s in 10"]
)
def test_a_robot_with_nothing_but_a_laser_gets_lost_then_and_finds_its_place(name: str) -> None:
    """It says so, and no scan is written at a wrong place."""
    found = outcome(name, 1)
    assert not (found.lost or found.misplaced or found.silent)


def test_scans_that_the_driver_sends_again_are_counted() -> None:
    """They have no result: the reason stands beside their number, and the sensors' faults contain them."""
    items = CASES["rooms, laser alone, scans repeated for 0.5 s in 6"].load(1)
    pipeline, faults = told(items)
    scans = [each for each in items if hasattr(each, "ranges")]
    again = sum(np.array_equal(a.ranges, b.ranges) for a, b in pairwise(scans))
    assert 50 < pipeline.skipped[REPEATED] <= again
    assert faults == {"scans_repeated"}
