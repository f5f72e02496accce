"""A laser whose ranges scatter by 1 % of them, as of cheap ones: walls at 10 m are 20 cm thick in the map."""

import pytest

from benchmarks import ensembles

VARIANTS = 1, 2


@pytest.mark.parametrize(
    "case",
    [
        "rooms, noise of 1 % of the range",
        "people, noise of 1 % of the range",
        "people, laser alone, noise of 1 % of the range",
    ],
)
def test_a_laser_with_much_noise_maps_to_two_centimetres(case: str) -> None:
    """Its ranges are smoothed along the walls: without that the error is three to five centimetres."""
    runs = [ensembles.run(case, variant, {}) for variant in VARIANTS]
    assert max(each.error for each in ensembles.outcomes(runs)) < 0.02
    plain = [ensembles.run(case, variant, {"scan.smooth_noise": 0.0}) for variant in VARIANTS]
    assert min(each.error for each in ensembles.outcomes(plain)) > 0.025
