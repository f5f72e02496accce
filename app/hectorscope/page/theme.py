"""One palette for the scene, the plots and the panels.

The line colours are those of Okabe and Ito ("Color Universal Design", 2008), lightened for the dark theme: they
stay apart for readers with protanopia, deuteranopia and tritanopia, and no meaning hangs on colour alone (truth
is dashed, every line and ellipse has a name in the legend). Residuals run blue, yellow, vermilion: by hue for most
readers, by lightness for the rest. Walls carry the strongest contrast of all so that a projector cannot lose them.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

Rgb = tuple[int, int, int]


@dataclass(frozen=True, slots=True)
class Theme:
    """Every colour of the page, sRGB 0-255, by what it means.

    match, prior, fused, position: the three planar covariances and the position ellipsoid. ramp: small to large
    residual. unexpected: beams that end in free space. series: for plots of several curves.
    """

    dark: bool
    background: Rgb
    surface: Rgb
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
    accent: Rgb
    warning: Rgb
    error: Rgb
    ramp: tuple[Rgb, ...]
    unexpected: Rgb
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


def for_lines(colours: ArrayLike) -> NDArray[np.uint8]:
    """What to send for lines that shall show colours (..., 3), 0-255: as near as the film curve lets them."""
    share = np.asarray(colours, np.float64) / 255.0
    light = np.where(share > 0.04045, ((share + 0.055) / 1.055) ** 2.4, share / 12.92)  # IEC 61966-2-1
    value = np.clip(light @ np.linalg.inv(AFTER_CURVE).T, 0.0, BRIGHTEST)
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
    background=(17, 21, 28),
    surface=(27, 32, 41),
    text=(236, 240, 245),
    muted=(150, 160, 174),
    grid=(46, 53, 65),
    free=(52, 61, 76),
    occupied=(240, 243, 247),
    robot=(240, 228, 66),
    trajectory=(240, 228, 66),
    truth=(214, 220, 228),
    match=(255, 178, 48),
    prior=(90, 170, 250),
    fused=(36, 200, 150),
    position=(224, 150, 196),
    accent=(36, 200, 150),
    warning=(255, 178, 48),
    error=(255, 110, 60),
    ramp=((86, 180, 233), (240, 228, 66), (240, 100, 20)),
    unexpected=(180, 92, 255),
    series=((90, 170, 250), (255, 178, 48), (36, 200, 150), (224, 150, 196), (240, 228, 66), (255, 110, 60)),
)

LIGHT = Theme(
    dark=False,
    background=(232, 235, 240),
    surface=(255, 255, 255),
    text=(22, 28, 36),
    muted=(92, 102, 116),
    grid=(206, 212, 221),
    free=(255, 255, 255),
    occupied=(24, 32, 44),
    robot=(213, 94, 0),
    trajectory=(94, 60, 153),
    truth=(70, 78, 90),
    match=(217, 130, 0),
    prior=(0, 114, 178),
    fused=(0, 138, 100),
    position=(184, 84, 146),
    accent=(0, 138, 100),
    warning=(186, 104, 0),
    error=(200, 70, 0),
    ramp=((0, 114, 178), (230, 170, 0), (205, 70, 0)),
    unexpected=(165, 75, 250),
    series=((0, 114, 178), (217, 130, 0), (0, 138, 100), (184, 84, 146), (92, 102, 116), (200, 70, 0)),
)
