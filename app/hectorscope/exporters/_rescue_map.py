"""The picture of a map in the style of the rescue league (RoboCup Rescue Robot League, rules for GeoTIFF maps)."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from hectorscope.run.annotations import Annotation, Kind
from hectorscope.run.map_image import FREE, OCCUPIED, MapImage
from slam_core.geometry import to_euler

MOST = 1 << 25  # pixels: of a larger map a coarser level is drawn
MARGIN = 1.0  # m around the map, and twice as much at the top, for scale, orientation and name
FINE = 0.5  # m between the lines over explored ground
UNEXPLORED = np.array([(226, 226, 227), (237, 237, 238)], np.uint8)  # a chequer of 1 m
GRID, EXPLORED, WALL = (190, 190, 191), (255, 255, 255), (0, 40, 120)
START, PATH, SCALE, TEXT = (255, 200, 0), (120, 0, 140), (0, 50, 140), (0, 44, 207)
# As in the rules: victims solid red, hazards solid orange; the others are ours.
MARKS: dict[Kind, tuple[int, int, int]] = {
    "victim": (240, 10, 10),
    "hazard": (255, 100, 30),
    "door": (10, 110, 60),
    "note": (90, 90, 100),
}


class Place(NamedTuple):
    """Where a picture lies: map coordinates of its upper left corner, and metres a pixel."""

    x: float
    y: float
    resolution: float

    def pixels(self, xy: NDArray[np.float64]) -> NDArray[np.int64]:
        """(n, 2) column and row of the pixels that contain points (n, 2) of the map."""
        away = np.column_stack([xy[:, 0] - self.x, self.y - xy[:, 1]])
        return np.floor(away / self.resolution).astype(np.int64)


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """rgb: (rows, columns, 3), the highest y first."""

    rgb: NDArray[np.uint8]
    place: Place


def picture(
    maps: tuple[MapImage, ...],
    trajectory: NDArray[np.float64],
    name: str,
    annotations: tuple[Annotation, ...] = (),
) -> Picture:
    """The map, the path, the start and the marks of a run.

    maps, trajectory: as in a `Run`, at least one map and one pose.
    """
    level = next((level for level in maps if level.cells.size <= MOST), maps[-1])
    edge = round(MARGIN / level.resolution)
    cells = np.pad(level.cells[::-1], ((2 * edge, edge), (edge, edge)))
    top = level.y + (len(level.cells) + 2 * edge) * level.resolution
    place = Place(level.x - edge * level.resolution, top, level.resolution)
    image = Image.fromarray(_ground(cells, place))
    draw = ImageDraw.Draw(image)
    path = place.pixels(trajectory[:, 1:3])
    draw.line([tuple(point) for point in _turns(path).tolist()], PATH, 1)
    _start(draw, path[0], to_euler(trajectory[0, 4:8])[2], 0.5 / level.resolution)
    for mark in annotations:
        _mark(draw, mark, place)
    _legend(draw, 1.0 / level.resolution, name)
    return Picture(np.asarray(image), place)


def _ground(cells: NDArray[np.uint8], place: Place) -> NDArray[np.uint8]:
    """Chequer, explored ground with its grid, walls; squares and lines are those of the map's metres."""
    rows, columns = cells.shape
    x = place.x + (np.arange(columns) + 0.5) * place.resolution
    y = place.y - (np.arange(rows) + 0.5) * place.resolution
    odd = (np.floor(x)[None, :] + np.floor(y)[:, None]).astype(np.int64) % 2
    rgb: NDArray[np.uint8] = UNEXPLORED[odd]
    free = cells == FREE
    rgb[free] = EXPLORED
    line = (np.mod(x, FINE) < place.resolution)[None, :] | (np.mod(y, FINE) < place.resolution)[:, None]
    rgb[free & line] = GRID
    rgb[cells == OCCUPIED] = WALL
    return rgb


def _turns(path: NDArray[np.int64]) -> NDArray[np.int64]:
    """The pixels without repetitions, and one at least twice: a line has two ends."""
    moved = np.any(np.diff(path, axis=0, prepend=path[:1] - 1), axis=1)
    return path[moved] if np.count_nonzero(moved) > 1 else path[[0, 0]]


def _start(draw: ImageDraw.ImageDraw, at: NDArray[np.int64], yaw: float, size: float) -> None:
    """An arrow to where the robot looked at first; size: its length in pixels."""
    corners = np.array([[0.5, 0.0], [-0.5, 0.35], [-0.25, 0.0], [-0.5, -0.35]]) * max(size, 8.0)
    c, s = np.cos(yaw), np.sin(yaw)
    turned = corners @ np.array([[c, -s], [s, c]])  # rows of the picture run down
    draw.polygon([tuple(corner) for corner in (turned + at).tolist()], START)


def _mark(draw: ImageDraw.ImageDraw, mark: Annotation, place: Place) -> None:
    """A disc in the colour of its kind with its number."""
    column, row = place.pixels(np.array([[mark.x, mark.y]]))[0].tolist()
    radius = max(0.175 / place.resolution, 7.0)
    draw.ellipse((column - radius, row - radius, column + radius, row + radius), MARKS[mark.kind])
    draw.text((column, row), str(mark.number), EXPLORED, ImageFont.load_default(10), anchor="mm")


def _legend(draw: ImageDraw.ImageDraw, metre: float, name: str) -> None:
    """The name, a scale of one metre, and an arrow along the x axis of the map."""
    font, left, top = ImageFont.load_default(10), 0.25 * metre, 0.2 * metre
    draw.text((left, top), name, TEXT, font)
    y = top + 12 + 0.5 * metre
    draw.line([(left, y), (left + metre, y)], SCALE, 2)
    for x in (left, left + metre):
        draw.line([(x, y - 3), (x, y + 3)], SCALE, 2)
    draw.text((left, y + 3), "1 m", TEXT, font)
    tip = left + 3.0 * metre
    draw.line([(tip - metre, y), (tip, y)], SCALE, 2)
    draw.polygon([(tip + 2, y), (tip - 5, y - 4), (tip - 5, y + 4)], SCALE)
    draw.text((tip - metre, y + 3), "x", TEXT, font)
