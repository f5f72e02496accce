"""Maps as the map servers of ROS share them: map.yaml and a grey image (PGM, PNG or BMP), from any tool."""

import math
from dataclasses import dataclass
from pathlib import Path
from reprlib import Repr
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError
from ruamel.yaml import YAML

from hectorscope.common.paths import absence
from slam_core.config import MapConfig
from slam_core.localization.prior_map import MapError, SavedLevel

FARTHEST = 1e5  # metres to an origin
SMALLEST, LARGEST = 1e-4, 100.0  # metres of a cell
WORDS = Repr()
WORDS.maxlevel = 1  # a list of lists of lists has no end
POSE = ("the x of its origin", "the y of its origin", "the yaw of its origin")
THRESHOLDS = {"free_thresh": 0.196, "occupied_thresh": 0.65}  # and what holds without them
LONGEST_DESCRIPTION = 2**16  # bytes of a yaml file
CELL_BYTES = 10  # of a cell in the map, all levels together
STRIP = 256  # rows that are turned at once
PLAIN_BYTES = 8  # of a pixel in plain text, with room for a header
FORMATS = ("PPM", "PNG", "BMP")  # the first with PGM
MODES = {"1", "L", "LA", "P", "PA", "RGB", "RGBA"}
OPAQUE = 128  # opacity below which a pixel is unknown
HAIR = 1e-6  # of a cell: a corner rounded in the yaml file falls on the cell that was meant
OCCUPIED = 2  # class of a cell
Image.MAX_IMAGE_PIXELS = None  # the memory limit of the map holds in its place

# Surer than one look, less sure than many: a map that goes on can still change its mind.
LOG_ODDS = np.array([0.0, -3.0, 3.0], np.float32)  # of unknown, free, occupied


@dataclass(frozen=True, slots=True)
class Described:
    """The content of the yaml file. x, y, yaw: the lower left corner of the image, metres and radians."""

    image: str
    resolution: float
    x: float
    y: float
    yaw: float
    negate: bool
    occupied_thresh: float
    free_thresh: float


def read_ros_map(file: Path, config: MapConfig) -> tuple[SavedLevel, ...]:
    """The image that a yaml file describes, and coarser levels built from it, as many as the settings have."""
    said = _described(file)
    if abs(said.resolution - config.resolution) > 1e-9:
        raise MapError(
            f"{file} has cells of {said.resolution:g} m, the settings {config.resolution:g} m: "
            f"give --map.resolution {said.resolution:g}"
        )
    most = int(config.limit * 1e6 / CELL_BYTES)
    classes = _classes(read_image(file.parent / said.image, most), said)
    if not (classes == OCCUPIED).any():
        raise MapError(f"{file} has not one occupied cell: check its thresholds, negate and image")
    low, high = _extent(classes, said, 2 ** (config.levels - 1))
    if math.prod((high - low).tolist()) > most:
        wide, long = (high - low).tolist()
        raise MapError(f"{file} covers {wide} x {long} cells, turned by {said.yaw:g} rad: raise --map.limit")
    corner, cells = low, _on_lattice(classes, said, low, high)
    levels = [SavedLevel(said.resolution, corner, LOG_ODDS[cells])]
    for _ in range(1, config.levels):
        levels.append(coarser(levels[-1]))
    return tuple(levels)


def coarser(level: SavedLevel) -> SavedLevel:
    """Half the resolution: a cell takes the most occupied of its four that are known."""
    rows, columns = level.log_odds.shape
    fours = level.log_odds.reshape(rows // 2, 2, columns // 2, 2)
    known = np.where(fours == 0.0, np.float32(-np.inf), fours).max(axis=(1, 3))
    return SavedLevel(2 * level.resolution, level.corner // 2, np.where(np.isinf(known), np.float32(0.0), known))


def _described(file: Path) -> Described:
    try:
        with file.open("rb") as stream:
            text = stream.read(LONGEST_DESCRIPTION + 1)
        if len(text) > LONGEST_DESCRIPTION:
            raise ValueError(f"it has more than {LONGEST_DESCRIPTION} bytes")
        said = YAML(typ="safe", pure=True).load(text.decode())
    except Exception as error:  # the parser's ways to stumble over words that are no value are many
        raise MapError(f"{file} cannot be read ({error}): give a map's yaml file") from error
    if not isinstance(said, dict) or not {"image", "resolution", "origin"} <= said.keys():
        raise MapError(f"{file} describes no map: it needs image, resolution, origin [x, y, yaw]")
    if said.get("mode", "trinary") == "raw":
        raise MapError(f"{file} is a map in raw mode: save it as trinary")
    try:
        return _checked(said)
    except ValueError as error:
        raise MapError(f"{file} describes no map: {error}") from error


def _checked(said: dict[Any, Any]) -> Described:
    """What the keys say; ValueError names a key, its value, and what to give."""
    low, high = (_number(said, name, 0.0, 1.0, usual) for name, usual in THRESHOLDS.items())
    if low > high:
        raise ValueError(f"free_thresh is {low:g} and occupied_thresh {high:g}: the second must be higher")
    if said.get("negate", 0) not in (0, 1):
        raise ValueError(f"negate is {WORDS.repr(said['negate'])}: give 0 or 1")
    if not isinstance(said["image"], str):
        raise ValueError(f"image is {WORDS.repr(said['image'])}: give the name of a file")
    origin = said["origin"]
    if not isinstance(origin, list) or len(origin) != len(POSE):
        raise ValueError(f"origin is {WORDS.repr(origin)}: give [x, y, yaw]")
    x, y, yaw = (
        _number({name: value}, name, -FARTHEST, FARTHEST) for name, value in zip(POSE, origin, strict=True)
    )
    resolution = _number(said, "resolution", SMALLEST, LARGEST)
    return Described(said["image"], resolution, x, y, yaw, bool(said.get("negate", 0)), high, low)


def _number(said: dict[Any, Any], name: str, low: float, high: float, usual: float | None = None) -> float:
    value = said.get(name, usual)
    try:
        number = float(value)  # type: ignore[arg-type]  # what is none raises
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if not low <= number <= high:
        raise ValueError(f"{name} is {WORDS.repr(value)}: give {low:g} to {high:g}")
    return number


def _classes(pixels: NDArray[np.uint8], said: Described) -> NDArray[np.uint8]:
    """0 unknown, 1 free, 2 occupied; row 0 the lowest y. pixels: grey and opacity."""
    grey, opacity = np.moveaxis(pixels[::-1], -1, 0)
    occupancy = (grey if said.negate else 255 - grey) / 255.0
    free = (occupancy < said.free_thresh).astype(np.uint8)
    known = np.where(occupancy > said.occupied_thresh, OCCUPIED, free)
    return np.where(opacity < OPAQUE, 0, known).astype(np.uint8)


def _extent(
    classes: NDArray[np.uint8], said: Described, block: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Lowest and highest corner of whole blocks of the lattice around an image, wherever it lies and is turned."""
    rows, columns = classes.shape
    u, v = said.x / said.resolution, said.y / said.resolution
    c, s = math.cos(said.yaw), math.sin(said.yaw)
    corners = np.array([[u + c * a - s * b, v + s * a + c * b] for a in (0, columns) for b in (0, rows)])
    low = (np.floor(corners.min(axis=0) / block) * block).astype(np.int64)
    return low, (np.ceil(corners.max(axis=0) / block) * block).astype(np.int64)


def _on_lattice(
    classes: NDArray[np.uint8], said: Described, low: NDArray[np.int64], high: NDArray[np.int64]
) -> NDArray[np.uint8]:
    """The cells between two corners; each takes the pixel of its centre: walls move by half a cell at most."""
    (rows, columns), (width, height) = classes.shape, (high - low).tolist()
    u, v = said.x / said.resolution, said.y / said.resolution
    c, s = math.cos(said.yaw), math.sin(said.yaw)
    cells = np.zeros((height, width), np.uint8)
    for begin in range(0, height, STRIP):
        strip = cells[begin : begin + STRIP]
        first = low[1] + begin
        across, up = np.meshgrid(
            np.arange(low[0], high[0]) + 0.5 - u, np.arange(first, first + len(strip)) + 0.5 - v
        )
        column = np.floor(c * across + s * up + HAIR).astype(np.int64)
        row = np.floor(c * up - s * across + HAIR).astype(np.int64)
        inside = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
        strip[inside] = classes[row[inside], column[inside]]
    return cells


def read_image(file: Path, most_pixels: int) -> NDArray[np.uint8]:
    """Grey and opacity (rows, columns, 2) of an image of 8 bits a channel, rows from the top; else MapError."""
    try:
        size = file.stat().st_size
        if size > PLAIN_BYTES * most_pixels:
            raise MapError(f"{file} has {size} bytes, too many for {most_pixels} cells: raise --map.limit")
        with Image.open(file, formats=FORMATS) as image:
            columns, rows = image.size
            if rows * columns > most_pixels:
                reason = f"{file} has {columns} x {rows} pixels, more than {most_pixels} cells"
                raise MapError(f"{reason}: raise --map.limit")
            if image.mode not in MODES:
                raise MapError(f"{file} has pixels of the kind {image.mode}: save it with 8 bits a channel")
            return np.asarray(image.convert("LA"))
    except MapError:
        raise
    except UnidentifiedImageError as error:
        raise MapError(
            f"{file} is no image in {', '.join(FORMATS)}: convert it, and name it in the yaml"
        ) from error
    except FileNotFoundError as error:
        raise MapError(f"{file} {absence(file)}: the yaml file names it as its image") from error
    except Exception as error:  # the ways of a damaged image to be none are many
        raise MapError(f"{file} cannot be read ({error}): save the map again") from error
