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
def test_smoothing_takes_a_third_of_the_error_away(case: str) -> None:
    """Of each drive, against the same one with its ranges as they are measured."""
    for variant in VARIANTS:
        smoothed, measured = (
            ensembles.outcomes([ensembles.run(case, variant, settings)])[0].error
            for settings in ({}, {"scan.smooth_noise": 0.0})
        )
        assert smoothed < 0.7 * measured
