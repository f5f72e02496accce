"""A laser whose ranges scatter by 1 % of them, as of cheap ones: walls at 10 m are 20 cm thick in the map."""

import pytest

from tests.ensemble import outcomes

VARIANTS = 1, 2


def error(case: str, **settings: float) -> float:
    """Metres, of all variants together."""
    return sum(each.error for each in outcomes(case, VARIANTS, settings))


@pytest.mark.parametrize(
    "case",
    [
        "rooms, noise of 1 % of the range",
        "people, noise of 1 % of the range",
        "people, laser alone, noise of 1 % of the range",
    ],
)
def test_smoothing_takes_much_of_the_error_away(case: str) -> None:
    """Of the same drives with their ranges as they are measured."""
    assert error(case) < 0.8 * error(case, **{"scan.smooth_noise": 0.0})
