"""Drawings in SVG: maps, curves over them, fields of values, and sheets of panels with captions."""

import base64
import html
import io
from dataclasses import dataclass

import numpy as np
from PIL import Image

from hectorscope.run.map_image import MapImage
from slam_core.measurements import Float64s

CLASSES = np.array([(205, 210, 218), (255, 255, 255), (24, 32, 44)], np.uint8)  # unknown, free, occupied
TRAVELLED, TRUE = "#d1495b", "#00798c"
PANEL = 420  # pixels: the longer side of a panel
MARGIN, CAPTION = 16, 40


@dataclass(frozen=True)
class Drawing:
    """SVG of one panel, in its own pixels from the upper left."""

    width: float
    height: float
    content: str
    caption: str


@dataclass(frozen=True)
class Frame:
    """Places a map in a panel: metres to pixels."""

    x: float
    top: float
    scale: float

    def path(self, points: Float64s, colour: str, wide: float = 2.0) -> str:
        """A line through (n, 2) metres."""
        at = " ".join(f"{self.scale * (x - self.x):.1f},{self.scale * (self.top - y):.1f}" for x, y in points)
        return f'<polyline points="{at}" fill="none" stroke="{colour}" stroke-width="{wide}"/>'


def pixels(values: np.ndarray, side: float) -> tuple[str, float, float]:
    """An image (rows, columns, 3), row 0 the lowest, as SVG whose longer side has so many pixels, and its size."""
    file = io.BytesIO()
    Image.fromarray(values[::-1].astype(np.uint8)).save(file, "PNG")
    scale = side / max(values.shape[:2])
    width, height = scale * values.shape[1], scale * values.shape[0]
    url = f"data:image/png;base64,{base64.b64encode(file.getvalue()).decode()}"
    size = f'width="{width:.1f}" height="{height:.1f}"'
    return f'<image {size} href="{url}" style="image-rendering:pixelated"/>', width, height


def map_panel(image: MapImage, caption: str) -> tuple[Drawing, Frame]:
    """A level as it is, and where its metres lie."""
    content, width, height = pixels(CLASSES[image.cells], PANEL)
    rows = image.cells.shape[0]
    frame = Frame(image.x, image.y + rows * image.resolution, height / (rows * image.resolution))
    return Drawing(width, height, content, caption), frame


def with_lines(drawing: Drawing, *lines: str) -> Drawing:
    """The same with more on it."""
    return Drawing(drawing.width, drawing.height, drawing.content + "".join(lines), drawing.caption)


def grey(values: Float64s) -> Float64s:
    """Free is white, occupied is black."""
    colours: Float64s = np.repeat((255.0 * (1.0 - values))[..., None], 3, axis=2)
    return colours


def diverging(values: Float64s) -> Float64s:
    """Blue falls, red rises, white is level."""
    share = np.clip(values / max(1e-9, float(np.abs(values).max())), -1.0, 1.0)[..., None]
    ends = np.where(share > 0, np.array([178, 24, 43]), np.array([33, 102, 172]))
    colours: Float64s = 255.0 + np.abs(share) * (ends - 255.0)
    return colours


def label(x: float, y: float, text: str, colour: str = "#18202c") -> str:
    """Words in the middle over a place."""
    place = f'x="{x:.1f}" y="{y:.1f}" fill="{colour}" font-size="15" text-anchor="middle"'
    return f"<text {place}>{html.escape(text)}</text>"


def sheet(panels: list[Drawing]) -> str:
    """Panels beside each other with their captions below: a whole SVG."""
    tall = max(panel.height for panel in panels)
    at, parts = float(MARGIN), []
    for panel in panels:
        parts.append(f'<g transform="translate({at:.1f} {MARGIN + tall - panel.height:.1f})">{panel.content}</g>')
        parts.append(label(at + panel.width / 2, MARGIN + tall + 26, panel.caption))
        at += panel.width + MARGIN
    height = MARGIN + tall + CAPTION
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{at:.0f}" height="{height:.0f}"'
        f' viewBox="0 0 {at:.0f} {height:.0f}" font-family="sans-serif">'
        f'<rect width="100%" height="100%" fill="#fff"/>{"".join(parts)}</svg>'
    )
