"""Checks the palette: contrasts, and colours that readers with a colour blindness still tell apart.

    python -m benchmarks.contrast

Contrast is that of WCAG 2: areas need 3 for every reader, lines and points 3 for readers with all cones and 2.4
for others, text 4.5. Colour blindness is simulated in linear sRGB (Machado, Oliveira and Fernandes 2009, severity
1). What must be told apart differs by some units of CIE Lab for every reader.
Prints a line for each pair, the narrowest first, and ends with 1 when one is below its limit.
"""

import argparse
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from hectorscope.page.theme import DARK, LIGHT, Rgb, Theme, linear

Floats = NDArray[np.float64]

AREA, MARK, TEXT = 3.0, 2.4, 4.5  # contrast; a mark is a line or a point, for readers without all cones
LINES_APART, RAMP_APART, SERIES_APART = 12.0, 20.0, 8.0  # units of CIE Lab
CHIP, NOTE = (
    0.22,
    0.14,
)  # share of its colour below the text of a chip and of a note (hectorscope.css)
READERS: dict[str, Floats] = {
    "all cones": np.eye(3),
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
WHITE = np.array([0.9505, 1.0, 1.089])
ESTIMATES = ("match", "prior", "fused", "position")


@dataclass(frozen=True, slots=True)
class Finding:
    """How far apart two colours are for a reader, and how far they have to be."""

    theme: str
    what: str
    reader: str
    found: float
    wanted: float

    @property
    def good(self) -> bool:
        """Whether it is enough."""
        return self.found >= self.wanted


def seen(colour: Rgb, reader: str) -> Floats:
    """The light as that reader sees it."""
    light: Floats = np.clip(READERS[reader] @ linear(colour), 0.0, 1.0)
    return light


def contrast(a: Rgb, b: Rgb, reader: str = "all cones") -> float:
    """Ratio of luminances, 1 to 21 (WCAG 2)."""
    low, high = sorted(float(TO_XYZ[1] @ seen(colour, reader)) for colour in (a, b))
    return (high + 0.05) / (low + 0.05)


def lab(colour: Rgb, reader: str) -> Floats:
    """CIE Lab (3,) as that reader sees the colour."""
    xyz = TO_XYZ @ seen(colour, reader) / WHITE
    f = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16.0 / 116.0)
    return np.array([116.0 * f[1] - 16.0, 500.0 * (f[0] - f[1]), 200.0 * (f[1] - f[2])])


def over(colour: Rgb, below: Rgb, opacity: float) -> Rgb:
    """A see-through colour over another, as a browser mixes them."""
    red, green, blue = (round(opacity * a + (1.0 - opacity) * b) for a, b in zip(colour, below, strict=True))
    return red, green, blue


def areas(theme: Theme) -> dict[str, tuple[Rgb, Rgb]]:
    """What lies side by side in the scene, by what it is."""
    upper = {
        f"wall of an upper level on {name}": (over(theme.occupied, below, theme.veil[1]), below)
        for name, below in (("free", theme.free), ("unknown", theme.background))
    }
    return {
        "free on unknown": (theme.free, theme.background),
        "occupied on free": (theme.occupied, theme.free),
        "occupied on unknown": (theme.occupied, theme.background),
        **upper,
    }


def marks(theme: Theme) -> dict[str, tuple[Rgb, Rgb]]:
    """Lines and points of the scene and the charts, on what they lie."""
    lines = {name: (getattr(theme, name), theme.free) for name in (*ESTIMATES, "trajectory", "truth", "robot")}
    scan = {f"residual {i}": (colour, theme.free) for i, colour in enumerate(theme.ramp)}
    curves = {f"curve {i}": (colour, theme.surface) for i, colour in enumerate(theme.series)}
    return {
        "unexpected": (theme.unexpected, theme.free),
        "button": (theme.accent, theme.surface),
        **lines,
        **scan,
        **curves,
    }


def texts(theme: Theme) -> dict[str, tuple[Rgb, Rgb]]:
    """What is read, on what it stands."""
    surface = theme.surface
    plain = {name: (getattr(theme, name), surface) for name in ("text", "muted", "accent", "warning", "error")}
    chips = {
        f"{name} on its chip": (getattr(theme, name), over(getattr(theme, name), surface, CHIP))
        for name in ("accent", "warning")
    }
    return {
        **plain,
        **chips,
        "muted on a field": (theme.muted, theme.field),
        "text on a field": (theme.text, theme.field),
        "text on a rule": (theme.text, theme.line),
        "muted in a note": (theme.muted, over(theme.warning, surface, NOTE)),
        "on an accent": (theme.field if theme.dark else surface, theme.accent),
        "on an error": (surface, theme.error),
    }


def apart(theme: Theme) -> Iterator[tuple[str, Rgb, Rgb, float]]:
    """Pairs that mean different things side by side."""
    for a, b in combinations(ESTIMATES, 2):
        yield f"{a} / {b}", getattr(theme, a), getattr(theme, b), LINES_APART
    scan = {**{f"residual {i}": colour for i, colour in enumerate(theme.ramp)}, "unexpected": theme.unexpected}
    for (a, one), (b, other) in combinations(scan.items(), 2):
        yield f"{a} / {b}", one, other, RAMP_APART
    for (i, one), (j, other) in combinations(enumerate(theme.series[:4]), 2):
        yield f"curve {i} / curve {j}", one, other, SERIES_APART


def findings(theme: Theme) -> list[Finding]:
    """Every pair of a theme, for every reader; text by its contrast to readers with all cones."""
    name = "dark" if theme.dark else "light"
    found = [Finding(name, what, "all cones", contrast(*pair), TEXT) for what, pair in texts(theme).items()]
    for pairs, others in ((areas(theme), AREA), (marks(theme), MARK)):
        found += [
            Finding(name, what, reader, contrast(*pair, reader), AREA if reader == "all cones" else others)
            for what, pair in pairs.items()
            for reader in READERS
        ]
    return found + [
        Finding(name, what, reader, float(np.linalg.norm(lab(one, reader) - lab(other, reader))), wanted)
        for what, one, other, wanted in apart(theme)
        for reader in READERS
    ]


def main() -> int:
    """Print all of them; 1 when one is below its limit."""
    argparse.ArgumentParser(description=__doc__.splitlines()[0]).parse_args()
    found = sorted((f for theme in (DARK, LIGHT) for f in findings(theme)), key=lambda f: f.found / f.wanted)
    for f in found:
        print(
            f"{'ok ' if f.good else 'LOW'} {f.found:6.2f} of {f.wanted:5.2f}  {f.theme:5} {f.reader:12} {f.what}"
        )
    return 0 if all(f.good for f in found) else 1


if __name__ == "__main__":
    sys.exit(main())
