"""One palette for the scene, the plots and the panels.

The hues are those of Okabe and Ito ("Color Universal Design", 2008), at lightnesses that keep apart what lies side
by side: areas by a contrast of 3, text by 4.5, and curves also for readers with protanopia, deuteranopia and
tritanopia; benchmarks/contrast.py checks it. No meaning hangs on colour alone: truth is dashed, every line and
ellipse has a name in the legend. Residuals run blue, yellow, vermilion: by hue for most readers, by lightness for
the rest.

Each browser chooses its theme. What is sent has the colours of SENT; static/dress.js puts on those of the theme.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

Rgb = tuple[int, int, int]


@dataclass(frozen=True, slots=True)
class Theme:
    """Every colour of the page, sRGB 0-255, by what it means.

    background: unknown cells, and all around the map. surface, field, line: of panels, their fields and rules.
    match, prior, fused, position: the three planar covariances and the position ellipsoid. compared: the line and
    the walls of another run. ramp: small to large residual. unexpected: beams that end in free space. veil: how
    opaque free and occupied cells of a level are that lies over others. series: for plots of several curves.
    """

    dark: bool
    background: Rgb
    surface: Rgb
    field: Rgb
    line: Rgb
    text: Rgb
    muted: Rgb
    grid: Rgb
    free: Rgb
    occupied: Rgb
    robot: Rgb
    trajectory: Rgb
    truth: Rgb
    match: Rgb
    prior: Rgb
    fused: Rgb
    position: Rgb
    compared: Rgb
    accent: Rgb
    warning: Rgb
    error: Rgb
    ramp: tuple[Rgb, ...]
    unexpected: Rgb
    veil: tuple[float, float]
    series: tuple[Rgb, ...]

    def residual_colours(self, values: NDArray[np.float32]) -> NDArray[np.uint8]:
        """(n, 3) colours along the ramp for values 0..1 (clipped; NaN as 1)."""
        at = np.clip(np.nan_to_num(values, nan=1.0), 0.0, 1.0) * (len(self.ramp) - 1)
        stops = np.arange(len(self.ramp))
        channels = np.array(self.ramp, np.float64).T
        return np.stack([np.interp(at, stops, channel) for channel in channels], axis=1).astype(np.uint8)


def css(colour: Rgb, alpha: float = 1.0) -> str:
    """`colour` as CSS."""
    red, green, blue = colour
    return f"rgb({red} {green} {blue} / {alpha:g})" if alpha < 1.0 else f"#{red:02x}{green:02x}{blue:02x}"


# The film curve (ACES as fitted by Hill) through which the page sends lines, but not maps and points: a mixture of
# the channels, a fraction of two polynomials in each, and another mixture.
BEFORE_CURVE = np.array([[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]])
AFTER_CURVE = np.array(
    [[1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]]
)
OVER, UNDER = (1.0, 0.0245786, -0.000090537), (0.983729, 0.4329510, 0.238081)
EXPOSURE = 1.0 / 0.6
BRIGHTEST = 0.77  # that the curve makes of any colour


def linear(colours: ArrayLike) -> NDArray[np.float64]:
    """Light, 0 to 1, of colours in sRGB, 0-255 (IEC 61966-2-1)."""
    share = np.asarray(colours, np.float64) / 255.0
    light: NDArray[np.float64] = np.where(share > 0.04045, ((share + 0.055) / 1.055) ** 2.4, share / 12.92)
    return light


def for_lines(colours: ArrayLike) -> NDArray[np.uint8]:
    """What to send for lines that shall show colours (..., 3), 0-255: as near as the film curve lets them."""
    value = np.clip(linear(colours) @ np.linalg.inv(AFTER_CURVE).T, 0.0, BRIGHTEST)
    a, b, c = (over - value * under for over, under in zip(OVER, UNDER, strict=True))
    wanted = (np.sqrt(b * b - 4.0 * a * c) - b) / (2.0 * a) @ np.linalg.inv(BEFORE_CURVE).T / EXPOSURE
    light = np.clip(wanted, 0.0, 1.0)
    encoded: NDArray[np.uint8] = np.rint(
        255.0 * np.where(light > 0.0031308, 1.055 * light ** (1.0 / 2.4) - 0.055, 12.92 * light)
    ).astype(np.uint8)
    return encoded


@lru_cache(maxsize=64)
def for_line(colour: Rgb) -> NDArray[np.uint8]:
    """The same for one colour, (3,), which views ask for whenever they draw."""
    made = for_lines(colour)
    made.flags.writeable = False
    return made


DARK = Theme(
    dark=True,
    background=(10, 13, 18),
    surface=(27, 32, 41),
    field=(17, 21, 28),
    line=(46, 53, 65),
    text=(236, 240, 245),
    muted=(158, 168, 182),
    grid=(52, 60, 73),
    free=(84, 96, 113),
    occupied=(246, 248, 251),
    robot=(240, 228, 66),
    trajectory=(240, 228, 66),
    truth=(226, 231, 238),
    match=(255, 182, 48),
    prior=(120, 190, 255),
    fused=(60, 212, 160),
    position=(250, 176, 216),
    compared=(255, 84, 196),
    accent=(36, 200, 150),
    warning=(255, 178, 48),
    error=(255, 118, 70),
    ramp=((110, 195, 245), (240, 228, 66), (255, 156, 96)),
    unexpected=(211, 255, 225),
    veil=(0.16, 0.8),
    series=((120, 190, 255), (255, 178, 48), (60, 212, 160), (250, 176, 216), (240, 228, 66), (255, 118, 70)),
)

LIGHT = Theme(
    dark=False,
    background=(142, 148, 158),
    surface=(255, 255, 255),
    field=(240, 242, 246),
    line=(206, 212, 221),
    text=(22, 28, 36),
    muted=(84, 94, 108),
    grid=(120, 127, 138),
    free=(255, 255, 255),
    occupied=(24, 32, 44),
    robot=(205, 88, 0),
    trajectory=(94, 60, 153),
    truth=(60, 68, 80),
    match=(198, 114, 0),
    prior=(0, 114, 178),
    fused=(0, 138, 100),
    position=(184, 84, 146),
    compared=(190, 0, 130),
    accent=(0, 104, 76),
    warning=(138, 75, 0),
    error=(190, 60, 0),
    ramp=((0, 114, 178), (185, 135, 0), (170, 40, 0)),
    unexpected=(165, 75, 250),
    veil=(0.3, 0.8),
    series=((0, 114, 178), (198, 114, 0), (0, 138, 100), (184, 84, 146), (84, 94, 108), (170, 40, 0)),
)

SENT = DARK
