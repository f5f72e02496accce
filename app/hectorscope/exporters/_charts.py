"""Curves over time as paths of an SVG."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

WIDTH, HEIGHT = 900, 170  # units of the drawing
LEFT, RIGHT, TOP, BOTTOM = 58, 20, 8, 22
BINS = 900  # of a curve with more points the lowest and the highest of each bin are drawn
STEPS = (1.0, 2.0, 5.0)

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Tick:
    """A mark on an axis: where, and what is written there."""

    at: float
    label: str


@dataclass(frozen=True, slots=True)
class Curve:
    """A name, the path of an SVG, and which colour of the sheet it has."""

    name: str
    path: str
    colour: int


@dataclass(frozen=True, slots=True)
class Chart:
    """Curves that share their axes. empty: there is no value to draw."""

    title: str
    curves: tuple[Curve, ...]
    across: tuple[Tick, ...]
    up: tuple[Tick, ...]

    @property
    def empty(self) -> bool:
        """Whether no curve has a point."""
        return not any(curve.path for curve in self.curves)


def chart(title: str, seconds: Floats, columns: dict[str, Floats], *, log: bool = False) -> Chart:
    """Columns (n,) over seconds (n,), both finite or nan; log: by decades, and what is not above 0 is left out."""
    if log:
        columns = {name: _logarithm(values) for name, values in columns.items()}
    low, high = _range(columns, log)
    last = float(seconds[-1]) if len(seconds) else 0.0
    begin = float(seconds[0]) if len(seconds) else 0.0
    x = LEFT + (seconds - begin) / max(last - begin, 1e-9) * (WIDTH - LEFT - RIGHT)

    def up(value: Floats | float) -> Floats:
        return np.asarray(HEIGHT - BOTTOM - (value - low) / (high - low) * (HEIGHT - TOP - BOTTOM))

    curves = (Curve(name, _path(x, up(values)), i) for i, (name, values) in enumerate(columns.items()))
    across = tuple(
        Tick(LEFT + (t - begin) / max(last - begin, 1e-9) * (WIDTH - LEFT - RIGHT), f"{t:g} s")
        for t in _nice(begin, last, 10)
    )
    marks = range(math.ceil(low), math.floor(high) + 1) if log else _nice(low, high, 4)
    labels = tuple(Tick(float(up(float(m))), f"{10.0**m:g}" if log else f"{m:g}") for m in marks)
    return Chart(title, tuple(curves), across, labels)


def _logarithm(values: Floats) -> Floats:
    return np.log10(np.where(values > 0.0, values, np.nan))


def _range(columns: dict[str, Floats], log: bool) -> tuple[float, float]:
    """Lowest and highest value to be drawn; never the same. Without decades the axis begins at 0 or below."""
    values = np.concatenate([*columns.values(), np.zeros(0)])
    values = values[np.isfinite(values)]
    if not len(values):
        return 0.0, 1.0
    low, high = float(values.min()), float(values.max())
    if log:
        return math.floor(low), max(math.ceil(high), math.floor(low) + 1)
    low = min(low, 0.0)
    return low, high if high > low else low + 1.0


def _nice(low: float, high: float, most: int) -> list[float]:
    """Round values between two, about `most` of them."""
    rough = max(high - low, 1e-9) / most
    decade = 10.0 ** math.floor(math.log10(rough))
    step = next((decade * s for s in STEPS if decade * s >= rough), 10.0 * decade)
    return [round(step * k, 12) for k in range(math.ceil(low / step), math.floor(high / step) + 1)]


def _path(x: Floats, y: Floats) -> str:
    """M and L commands; a value that is nan is a gap."""
    x, y = _thinned(x, y)
    parts, pen = [], "M"
    for a, b in zip(x.tolist(), y.tolist(), strict=True):
        if math.isfinite(b):
            parts.append(f"{pen}{a:.1f} {b:.1f}")
        pen = "L" if math.isfinite(b) else "M"
    return "".join(parts)


def _thinned(x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """The lowest and the highest of each bin, in their order, so that no peak is lost."""
    if len(x) <= 2 * BINS:
        return x, y
    edges = np.linspace(0, len(x), BINS + 1).astype(int)
    chosen: list[int] = []
    for begin, end in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
        part = y[begin:end]
        if np.isfinite(part).any():
            chosen += sorted({begin + int(np.nanargmin(part)), begin + int(np.nanargmax(part))})
        else:
            chosen.append(begin)
    return x[chosen], y[chosen]
