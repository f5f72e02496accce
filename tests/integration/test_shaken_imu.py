"""An IMU whose samples leap: its link is disturbed, or the robot is hit harder than it can measure."""

import pytest

from benchmarks import ensembles
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from slam_core.navigation.imu_check import AFTER_LEAP
from slam_core.navigation.imu_spikes import SPIKE

VARIANTS = 1, 2


@pytest.mark.parametrize(
    ("case", "metres"),
    [
        ("rooms, 1 of 200 IMU samples a spike", 0.005),
        ("people, IMU with spikes of 2 samples", 0.2),
        ("people, hit every 2 s, IMU of 2 g", 0.02),
        ("handheld, hit every 2 s, IMU of 2 g", 0.02),
    ],
)
def test_a_robot_is_not_led_astray_by_samples_that_leap(case: str, metres: float) -> None:
    """Spikes change nothing; after a hit the scans tell where the robot is, and it does not fly off."""
    runs = [ensembles.run(case, variant, {}) for variant in VARIANTS]
    found = ensembles.outcomes(runs)
    assert max(each.error for each in found) < metres
    assert not any(each.misplaced or each.silent for each in found)


def test_a_match_is_compared_with_a_search_where_the_heading_is_unsure() -> None:
    """Among reeds, where few beams fit: without the comparison this drive is metres off."""
    assert ensembles.outcomes([ensembles.run("littoral, IMU with spikes of 2 samples", 1, {})])[0].error < 0.5


@pytest.mark.parametrize(
    ("case", "code", "reason"),
    [
        ("rooms, 1 of 200 IMU samples a spike", "imu_spikes", SPIKE),
        ("rooms, hit every 2 s, IMU of 2 g", "imu_shaken", AFTER_LEAP),
    ],
)
def test_the_user_is_told_of_samples_that_leap(case: str, code: str, reason: str) -> None:
    """They are counted by their reason, and the faults of the sensors name them."""
    items = next(each for each in ensembles.cases() if each.name == case).load(1)
    pipeline, faults = Pipeline(Settings(), items[0].stamp_ns), set[str]()
    for item in items:
        for measurement in pipeline.admit(item):
            pipeline.step(measurement)
            faults |= {each.code for each in pipeline.slam.diagnostics}
    assert code in faults
    assert pipeline.slam.status.unused[reason] > 10
