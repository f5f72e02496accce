"""Colours along the ramp, in style sheets, and through the film curve. Contrasts: benchmarks/contrast.py."""

import numpy as np
import pytest

from benchmarks.contrast import linear
from hectorscope.page.theme import (
    AFTER_CURVE,
    BEFORE_CURVE,
    DARK,
    EXPOSURE,
    LIGHT,
    OVER,
    UNDER,
    Rgb,
    Theme,
    css,
    for_lines,
)

THEMES = pytest.mark.parametrize("theme", [DARK, LIGHT], ids=["dark", "light"])
LINES = ("match", "prior", "fused", "position")


def filmed(colour: Rgb) -> np.ndarray:
    """What the page shows of a line of that colour: three.js's ACES film curve."""
    light = BEFORE_CURVE @ (EXPOSURE * linear(colour))
    over, under = (np.polyval(series, light) for series in (OVER, UNDER))
    light = np.clip(AFTER_CURVE @ (over / under), 0.0, 1.0)
    return 255.0 * np.where(light > 0.0031308, 1.055 * light ** (1 / 2.4) - 0.055, 12.92 * light)


@THEMES
def test_the_ramp_ends_where_it_should(theme: Theme) -> None:
    """0 has the first colour, 1, more than 1 and NaN the last."""
    colours = theme.residual_colours(np.array([0.0, 1.0, 7.0, np.nan, -1.0], np.float32))
    assert [tuple(c) for c in colours] == [theme.ramp[i] for i in (0, -1, -1, -1, 0)]


def test_css() -> None:
    """Colours as style sheets write them."""
    assert css((1, 2, 255)) == "#0102ff"
    assert css((1, 2, 255), 0.5) == "rgb(1 2 255 / 0.5)"


@THEMES
@pytest.mark.parametrize("name", [*LINES, "trajectory", "truth", "robot"])
def test_lines_come_out_of_the_film_curve_as_they_should(theme: Theme, name: str) -> None:
    """Nearer to the theme than if sent as they are; the light one, whose colours are darker, is nearly met."""
    colour = getattr(theme, name)
    sent = for_lines(colour)
    seen = filmed(tuple(sent.tolist()))
    assert np.abs(seen - colour).max() <= np.abs(filmed(colour) - colour).max()
    if not theme.dark:
        assert np.abs(seen - colour).max() <= 16.5
    assert (for_lines([colour, colour]) == sent).all()
