"""The map as an image for a page, with the trajectory in its pixels."""

import base64
import io
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from hectorscope.run.map_image import PALETTE, MapImage

MOST = 1 << 22  # pixels
POINTS = 4000  # of the trajectory


@dataclass(frozen=True, slots=True)
class MapDrawing:
    """image: a PNG as a data URL, of width x height pixels. path: "x,y x,y ..." in them, begin and end its ends.

    metre: pixels a metre.
    """

    image: str
    width: int
    height: int
    path: str
    begin: tuple[float, float]
    end: tuple[float, float]
    metre: float


def map_drawing(maps: tuple[MapImage, ...], trajectory: NDArray[np.float64]) -> MapDrawing | None:
    """The finest level that is small enough; None without a map. trajectory: (n, 8), of a `Run`."""
    if not maps:
        return None
    level = next((level for level in maps if level.cells.size <= MOST), maps[-1])
    rows, columns = level.cells.shape
    picture = Image.fromarray(level.cells[::-1].copy())
    picture.putpalette(PALETTE)
    content = io.BytesIO()
    picture.save(content, "PNG", bits=2)
    away = (trajectory[:: 1 + len(trajectory) // POINTS, 1:3] - (level.x, level.y)) / level.resolution
    last = (trajectory[-1, 1:3] - (level.x, level.y)) / level.resolution
    points = [(round(x, 1), round(rows - y, 1)) for x, y in (*away.tolist(), last.tolist())]
    url = f"data:image/png;base64,{base64.b64encode(content.getvalue()).decode()}"
    path = " ".join(f"{x},{y}" for x, y in points)
    return MapDrawing(url, columns, rows, path, points[0], points[-1], 1.0 / level.resolution)
