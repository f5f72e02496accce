"""A robot with wheels that sees 5 m and 60 degrees, as many a depth camera does: next to nothing for seconds."""

import pytest

from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from slam_core.localization.tracking import FEWEST
from slam_core.results import StepResult
from tests.ensemble import items_of, outcomes


@pytest.mark.parametrize(
    ("case", "variant"),
    [
        ("rooms, depth camera with wheels and IMU", 7),
        ("rooms, depth camera with wheels and IMU", 14),  # in which such scans come while the pose is not sure
        ("rooms, depth camera with wheels", 7),
    ],
)
def test_a_scan_of_a_few_beams_leads_nobody_astray(case: str, variant: int) -> None:
    """The robot stays where wheels and inertial data have it, until it sees more again."""
    (found,) = outcomes(case, [variant], {})
    assert found.error < 0.2 and not (found.lost or found.misplaced or found.silent)


def test_a_scan_of_a_few_beams_finds_no_place_and_says_so() -> None:
    """It is degraded for that reason, and neither searched for nor written."""
    items = items_of("rooms, depth camera with wheels and IMU")
    pipeline, results = Pipeline(Settings(), items[0].stamp_ns), list[StepResult]()
    for item in items:
        results += [result for each in pipeline.admit(item) if (result := pipeline.step(each))]
    few = [result for result in results[1:] if len(result.points) < FEWEST]
    assert len(few) > 30
    assert not any(result.verdict.recovery or result.map_updated for result in few if not result.verdict.accepted)
    said = [each.verdict.rejection for each in few if each.verdict.rejection]
    assert {each.code for each in said} == {"endpoints"} and all(each.limit == FEWEST for each in said)
