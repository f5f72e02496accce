"""Something blocks the view ahead, so that few beams or none tell how far the robot has come along a corridor."""

from statistics import median

import pytest

from benchmarks import ensembles


@pytest.mark.parametrize(("scene", "metres"), [("handheld", 1.0), ("corridor", 2.0)])
def test_inertial_data_tell_the_way_where_few_beams_do(scene: str, metres: float) -> None:
    """The map confirms no few beams that it does not hold, and the gap ahead is no wall: nobody flies off."""
    runs = [ensembles.run(f"{scene}, 120 degrees ahead unseen", variant, {}) for variant in (1, 2, 3)]
    assert median(each.error for each in ensembles.outcomes(runs)) < metres
