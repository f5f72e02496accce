"""What rejected matches show of a robot whose pose is not sure."""

from collections.abc import Sequence

from slam_core.config import TrackingConfig
from slam_core.localization.rejected_matches import RejectedMatches
from slam_core.results import Fit

USUAL, CONFIG = 0.9, TrackingConfig(lost_after=4)
NEW, PARTLY, ELSEWHERE = Fit(0.1, 0.8), Fit(0.5, 0.8), Fit(0.9, 0.1)


def rejected(fits: Sequence[Fit], *, is_vague: bool = False) -> RejectedMatches:
    """All of them, in this order."""
    matches = RejectedMatches()
    for fit in fits:
        matches.add(fit, USUAL, CONFIG, is_vague=is_vague)
    return matches


def test_scans_on_mostly_unknown_cells_are_outside_the_map() -> None:
    """Also if they meet some known ones, and if one of many meets many; none at all shows nothing."""
    assert rejected([NEW]).outside_map
    assert rejected([PARTLY] * 4).outside_map
    assert rejected([Fit(0.8, 0.8), NEW, NEW, NEW]).outside_map
    assert not rejected([Fit(0.8, 0.8)] * 4).outside_map
    assert not rejected([]).outside_map


def test_a_robot_that_was_carried_away_in_known_rooms_has_to_be_found_in_the_map() -> None:
    """Its scans hit nothing where it was predicted for sure; that the prediction leaves the map tells nothing."""
    carried = rejected([ELSEWHERE] * 4)
    assert carried.contradict and not carried.outside_map
    assert rejected([Fit(0.55, 0.1)] * 4).contradict
    for _ in range(100):  # and becomes vague meanwhile
        carried.add(NEW, USUAL, CONFIG, is_vague=True)
    assert carried.contradict and not carried.outside_map
    assert not rejected([ELSEWHERE] * 4 + [NEW] * 100).outside_map


def test_a_vague_prediction_is_not_known_to_be_wrong() -> None:
    """What is matched metres off hits nothing either way."""
    assert not rejected([ELSEWHERE] * 4, is_vague=True).contradict
    assert not rejected([NEW] * 4).contradict
    assert not rejected([Fit(0.9, 0.6)] * 4).contradict
