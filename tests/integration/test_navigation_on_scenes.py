import pytest

from benchmarks.navigation import drive, summary
from slam_core.config import SlamConfig


@pytest.mark.parametrize("scene", ["arena", "littoral", "handheld"])
def test_the_filter_holds_attitude_and_height_on_a_scene(scene: str) -> None:
    """With a barometer and matches good to 1 cm: roll and pitch within 1.0 deg rms, height within 0.15 m."""
    found = summary(drive(scene, 2, SlamConfig()))
    assert found["roll/pitch"] < 1.0
    assert found["height"] < 0.15
    assert found["heading"] < 0.2 and found["plane"] < 0.02


def test_a_scene_without_a_barometer_keeps_its_height_near_the_start() -> None:
    """Nothing measures the height; the pseudo measurement keeps it within a metre instead of a hundred."""
    assert summary(drive("handheld", 2, SlamConfig(), barometer=False))["height"] < 1.0
