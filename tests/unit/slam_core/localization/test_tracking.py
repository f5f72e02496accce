"""Which matches are believed."""

import numpy as np
import pytest

from slam_core.config import TrackingConfig
from slam_core.localization.tracking import Tracker, disagreement, is_vague
from slam_core.mapping.grid import GridLevel
from slam_core.results import Fit, MatchResult, PlanarGaussian
from tests.worlds import fit, in_parts

CONFIG = TrackingConfig(lost_after=3)
GOOD, WORSE, BAD = Fit(0.9, 0.95), Fit(0.9, 0.65), Fit(0.9, 0.2)
NEW = Fit(0.1, 0.8)


def test_the_fit_counts_known_and_occupied_cells():
    """One endpoint off the map, one on unknown, one on free and one on occupied ground: half known, half hits."""
    level = GridLevel(1.0, (4, 4), np.array([-1.0, -1.0]))
    level.cells[1, 2], level.cells[2, 1] = in_parts([0.9, 0.1])  # at x, y = 1, 0 and 0, 1
    points = np.array([[9.0, 0.0], [-0.5, -0.5], [1.5, 0.5], [0.5, 1.5]], np.float32)
    assert fit(level, points, np.zeros(3)) == Fit(0.5, 0.5)
    turned = np.column_stack([points[:, 1], -points[:, 0]])  # as seen from a quarter turn to the left
    assert fit(level, turned, np.array([0.0, 0.0, 0.5 * np.pi])) == Fit(0.5, 0.5)
    assert fit(level, points[2:3], np.zeros(3)) == Fit(1.0, 1.0)


def test_a_match_is_doubted_for_each_of_three_reasons():
    """Little overlap, few hits, far from the prediction: the reason says which, with its figure."""
    tracker = Tracker()
    assert tracker.doubt(GOOD, 1.0, CONFIG) == ""
    assert "10% of the scan on known map" in tracker.doubt(Fit(0.1, 1.0), 1.0, CONFIG)
    assert "20% of the known endpoints on walls" in tracker.doubt(BAD, 1.0, CONFIG)
    assert "400 sigmas" in tracker.doubt(GOOD, 400.0, CONFIG)
    assert tracker.doubt(GOOD, 40.0, CONFIG) == ""  # what a robot out of a corridor has to make good


def test_what_is_usual_follows_the_place():
    """In a place where few endpoints ever hit, as among reeds, that is no reason for doubt any more."""
    tracker = Tracker()
    reeds = Fit(0.9, 0.55)
    assert tracker.doubt(reeds, 0.0, CONFIG)
    for hit in np.linspace(0.9, 0.6, 200):
        tracker.believe(Fit(0.9, float(hit)), "")
    assert not tracker.doubt(reeds, 0.0, CONFIG)


def test_the_states_follow_each_other():
    """Degraded, lost after as many scans as set, recovered once, then tracking."""
    tracker = Tracker()
    missed = [tracker.miss(BAD, "why", CONFIG) for _ in range(4)]
    assert [verdict.state for verdict in missed] == ["degraded", "degraded", "lost", "lost"]
    assert not any(verdict.believed or verdict.beyond for verdict in missed)
    found = [tracker.believe(GOOD, "") for _ in range(2)]
    assert [verdict.state for verdict in found] == ["recovered", "tracking"]
    assert tracker.believe(GOOD, "searched for").state == "recovered"


@pytest.mark.parametrize(("seen", "beyond"), [([NEW] * 4, True), ([BAD, NEW, NEW, NEW], False)])
def test_a_robot_is_lost_beyond_the_map_if_it_never_saw_any(seen, beyond):
    """Not one that was carried away in known rooms, though it then wanders off: it has to be found in the map."""
    tracker = Tracker()
    for _ in range(2):  # the second time after it was found
        missed = [tracker.miss(each, "why", CONFIG) for each in seen]
        assert [verdict.beyond for verdict in missed] == [False, False, beyond, beyond]
        tracker.believe(GOOD, "")


def test_a_pose_that_was_searched_for_must_convince():
    """What is just good enough to go on with is not good enough to jump to."""
    tracker = Tracker()
    assert not tracker.doubt(WORSE, 0.0, CONFIG)
    assert not tracker.convinces(WORSE, 0.0, CONFIG)
    assert tracker.convinces(GOOD, 90.0, CONFIG)
    assert not tracker.convinces(Fit(0.1, 1.0), 0.0, CONFIG)


def test_little_known_map_proves_little_far_from_the_prediction() -> None:
    """Four tenths of a scan that fit are believed near the prediction, and not ten sigmas away."""
    tracker, little = Tracker(), Fit(0.4, 0.95)
    assert tracker.doubt(little, 3.0, CONFIG) == ""
    assert tracker.convinces(little, 3.0, CONFIG)
    assert "10 sigmas" in tracker.doubt(little, 10.0, CONFIG)
    assert not tracker.convinces(little, 10.0, CONFIG)


@pytest.mark.parametrize(("degrees", "vague"), [(5.0, False), (5.7, False), (5.8, True), (40.0, True)])
def test_a_prediction_is_vague_by_three_sigmas_of_its_heading(degrees: float, vague: bool) -> None:
    """However well its place is known; 0.3 rad are the bound."""
    prior = PlanarGaussian(np.zeros(3), np.diag([1.0, 1.0, np.radians(degrees) ** 2]))
    assert is_vague(prior) == vague


def test_disagreement_is_in_sigmas_of_both_and_across_the_seam_of_the_heading():
    """Three and four centimetres and 0.02 rad, on sigmas that add up to 1 cm and 0.01 rad."""
    half = np.diag([1e-4, 1e-4, 1e-4]) / 2
    match = MatchResult(
        np.array([0.03, 0.0, np.pi - 0.01]), half, np.eye(3), np.zeros(1), (1,), True, np.zeros((0, 4))
    )
    prior = PlanarGaussian(np.array([0.0, 0.04, -np.pi + 0.01]), half)
    assert disagreement(match, prior) == pytest.approx(np.sqrt(9 + 16 + 4))


def test_the_weakest_direction_is_the_long_axis_of_the_covariance():
    """Two metres along a diagonal corridor, a centimetre across it."""
    turn = np.array([[1.0, -1.0], [1.0, 1.0]]) / np.sqrt(2)
    covariance = np.zeros((3, 3))
    covariance[:2, :2] = turn @ np.diag([4.0, 1e-4]) @ turn.T
    match = MatchResult(np.zeros(3), covariance, np.eye(3), np.zeros(1), (1,), True, np.zeros((0, 4)))
    assert match.weakest_sigma == pytest.approx(2.0)
