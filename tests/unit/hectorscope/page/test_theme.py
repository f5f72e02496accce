"""The palette keeps what it promises: contrast, and differences that colour-blind readers see."""

from itertools import combinations

import numpy as np
import pytest

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

# How linear sRGB looks without one kind of cone (Machado, Oliveira and Fernandes 2009, severity 1).
SEEN_BY = {
    "all": np.eye(3),
    "protanopia": np.array(
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]
    ),
    "deuteranopia": np.array(
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]
    ),
    "tritanopia": np.array(
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]]
    ),
}
TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])


def linear(colour: Rgb) -> np.ndarray:
    c = np.array(colour) / 255.0
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def filmed(colour: Rgb) -> np.ndarray:
    """What the page shows of a line of that colour: three.js's ACES film curve."""
    light = BEFORE_CURVE @ (EXPOSURE * linear(colour))
    over, under = (np.polyval(series, light) for series in (OVER, UNDER))
    light = np.clip(AFTER_CURVE @ (over / under), 0.0, 1.0)
    return 255.0 * np.where(light > 0.0031308, 1.055 * light ** (1 / 2.4) - 0.055, 12.92 * light)


def contrast(a: Rgb, b: Rgb) -> float:
    """WCAG contrast ratio."""
    low, high = sorted(float(linear(c) @ TO_XYZ[1]) for c in (a, b))
    return (high + 0.05) / (low + 0.05)


def lab(colour: Rgb, eye: np.ndarray) -> np.ndarray:
    """CIE Lab of a colour as that eye sees it."""
    xyz = TO_XYZ @ np.clip(eye @ linear(colour), 0.0, 1.0) / np.array([0.9505, 1.0, 1.089])
    f = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16 / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


@THEMES
def test_walls_stand_out(theme: Theme) -> None:
    """Occupied against free has more contrast than text needs, also on a pale projector."""
    assert contrast(theme.occupied, theme.free) > 7.0


@THEMES
@pytest.mark.parametrize("name", [*LINES, "trajectory", "truth", "unexpected"])
def test_lines_are_seen_on_the_map(theme: Theme, name: str) -> None:
    """Every line has the contrast that graphics need against free space."""
    assert contrast(getattr(theme, name), theme.free) > 2.9


@THEMES
def test_text_is_read(theme: Theme) -> None:
    """Texts, also the muted ones, have the contrast that small text needs."""
    assert contrast(theme.text, theme.surface) > 7.0
    assert contrast(theme.muted, theme.surface) > 4.5


@THEMES
@pytest.mark.parametrize("eye", SEEN_BY)
def test_estimates_are_told_apart(theme: Theme, eye: str) -> None:
    """The colours of match, filter, fused and position differ clearly for every kind of colour vision."""
    for a, b in combinations(LINES, 2):
        difference = lab(getattr(theme, a), SEEN_BY[eye]) - lab(getattr(theme, b), SEEN_BY[eye])
        assert np.linalg.norm(difference) > 12.0, (a, b)


@THEMES
@pytest.mark.parametrize("eye", SEEN_BY)
def test_residuals_are_told_apart(theme: Theme, eye: str) -> None:
    """Small, middle and large residuals, and surprises, differ clearly for every kind of colour vision."""
    for a, b in combinations([*theme.ramp, theme.unexpected], 2):
        assert np.linalg.norm(lab(a, SEEN_BY[eye]) - lab(b, SEEN_BY[eye])) > 20.0


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
