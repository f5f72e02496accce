"""What one browser is shown of the matcher: words, marks over the scene, and things in it. Plain values."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slam_core.measurements import Float64s

Mark = dict[str, Any]


@dataclass(frozen=True, eq=False)
class Dots:
    """Points (n, 2) on a level with colours (n, 3), and lines (n, 2, 2) from them, metres in the map."""

    level: int
    points: Float64s
    colours: NDArray[np.uint8]
    lines: Float64s
    size: float = 0.06  # metres


@dataclass(frozen=True, eq=False)
class Heat:
    """A picture (rows, columns, 4) on a level, row 0 lowest; centre (2,) and size (2,) in metres.

    heights: (rows, columns) of the surface above it, metres; None for none.
    """

    level: int
    picture: NDArray[np.uint8]
    centre: Float64s
    size: tuple[float, float]
    heights: Float64s | None = None


@dataclass(frozen=True, eq=False)
class Shown:
    """words: HTML. marks: for static/xray.js. handle: (3,) where the start is dragged; None for no handle.

    What is the same object as before is not sent again. level: that all of it lies on, None for no matter which.
    steps, levels: how many there are. scan_s: of the recording, when the scan was taken; None for no scan.
    """

    words: str
    marks: Sequence[Mark] = ()
    dots: Dots | None = None
    heat: Heat | None = None
    handle: Float64s | None = None
    level: int | None = None
    steps: int = 0
    levels: int = 0
    scan_s: float | None = None


def outline(kind: str, level: int, points: Float64s, text: str = "") -> Mark:
    """A closed line through points (n, 2)."""
    return {"kind": kind, "at": _placed(level, points), "closed": True, "text": text}


def line(kind: str, level: int, points: Float64s, text: str = "") -> Mark:
    """An open line through points (n, 2), with a text at its end."""
    return {"kind": kind, "at": _placed(level, points), "closed": False, "text": text}


def robot(kind: str, level: int, pose: Float64s, text: str = "") -> Mark:
    """A small arrow head at a pose (3,)."""
    shape = 0.3 * np.array([[1.0, 0.0], [-0.6, 0.55], [-0.3, 0.0], [-0.6, -0.55]])
    c, s = np.cos(pose[2]), np.sin(pose[2])
    return outline(kind, level, shape @ np.array([[c, s], [-s, c]]) + pose[:2], text)


def ellipse(kind: str, level: int, centre: Float64s, covariance: Float64s, sigmas: float) -> Mark:
    """The ellipse of a covariance, of which the first two rows are the position."""
    variances, axes = np.linalg.eigh(covariance[:2, :2])
    angles = np.linspace(0.0, 2.0 * np.pi, 64, endpoint=False)
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    return outline(kind, level, centre[:2] + sigmas * circle * np.sqrt(np.maximum(variances, 0.0)) @ axes.T)


def _placed(level: int, points: Float64s) -> list[list[float]]:
    return [[level, round(x, 5), round(y, 5)] for x, y in points[:, :2].tolist()]
