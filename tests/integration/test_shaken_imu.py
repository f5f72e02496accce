"""An IMU whose samples leap: its link is disturbed, or the robot is hit harder than it can measure."""

import pytest

from slam_core.kernels.memory import CHECKED
from slam_core.navigation.imu_check import AFTER_LEAP
from slam_core.navigation.imu_spikes import SPIKE
from tests.ensemble import items_of, outcomes, told

VARIANTS = 1, 2


@pytest.mark.parametrize(
    ("case", "metres"),
    [
        ("rooms, 1 of 200 IMU samples a spike", 0.005),
        ("people, IMU with spikes of 2 samples", 0.01),
        ("littoral, IMU with spikes of 3 samples", 0.03),
        ("handheld, knocked round every 2 s", 0.01),
        ("people, hit every 2 s, IMU of 2 g", 0.02),
        ("handheld, hit every 2 s, IMU of 2 g", 0.02),
    ],
)
def test_a_robot_is_not_led_astray_by_samples_that_leap(case: str, metres: float) -> None:
    """Spikes change nothing; after a hit the scans tell where the robot is, and it does not fly off."""
    found = outcomes(case, VARIANTS, {})
    assert max(each.error for each in found) < metres
    assert not any(each.misplaced or each.silent for each in found)


def test_a_match_is_compared_with_a_search_where_the_heading_is_unsure() -> None:
    """Among reeds, where few beams fit: without the comparison these drives are up to 0.3 m off.

    Checked kernels round otherwise.
    """
    found = outcomes("littoral, hit every 2 s, IMU of 2 g", [24, 38], {})
    assert max(each.error for each in found) < (0.22 if CHECKED else 0.15)


@pytest.mark.parametrize(
    ("case", "code", "reason"),
    [
        ("rooms, 1 of 200 IMU samples a spike", "imu_spikes", SPIKE),
        ("rooms, IMU with spikes of 3 samples", "imu_spikes", SPIKE),
        ("rooms, hit every 2 s, IMU of 2 g", "imu_shaken", AFTER_LEAP),
    ],
)
def test_the_user_is_told_of_samples_that_leap(case: str, code: str, reason: str) -> None:
    """They are counted by their reason, and the faults of the sensors name them."""
    pipeline, faults = told(items_of(case))
    assert code in faults
    assert pipeline.slam.status.unused[reason] > 10
