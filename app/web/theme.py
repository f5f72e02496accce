"""One palette for the scene, the plots and the panels.

The line colours are those of Okabe and Ito ("Color Universal Design", 2008), lightened for the dark theme: they
stay apart for readers with protanopia, deuteranopia and tritanopia, and no meaning hangs on colour alone (truth
is dashed, every line and ellipse has a name in the legend). Residuals run blue, yellow, vermilion: by hue for most
readers, by lightness for the rest. Walls carry the strongest contrast of all so that a projector cannot lose them.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

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
