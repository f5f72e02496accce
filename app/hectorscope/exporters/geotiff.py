"""map.tif and map.tfw: the map, the path and the start in the style of the rescue league, at its place.

In metres of the map; or, if satellites gave the origin, on the Earth: projected about it (transverse Mercator).
"""

import io
import math
from pathlib import Path

import numpy as np
import tifffile
from numpy.typing import NDArray

from hectorscope.common.paths import write_whole
from hectorscope.exporters import Exporter
from hectorscope.exporters._files import PICTURES
from hectorscope.exporters._rescue_map import Picture, Place, picture
from hectorscope.run.results import Run

EARTH_RADIUS = 6.371e6  # m
# TIFF tags of GeoTIFF.
SCALE, TIEPOINT, TRANSFORMATION, DIRECTORY, DOUBLES, ASCII = 33550, 33922, 34264, 34735, 34736, 34737
# GeoTIFF keys, in order, and their values.
MODEL_TYPE, RASTER_TYPE, CITATION, GEOGRAPHIC_TYPE, PROJECTED_TYPE = 1024, 1025, 1026, 2048, 3072
PROJECTION, METHOD, LINEAR_UNITS, ORIGIN_LONGITUDE, ORIGIN_LATITUDE = 3074, 3075, 3076, 3080, 3081
FALSE_EASTING, FALSE_NORTHING, ORIGIN_SCALE = 3082, 3083, 3092
USER_DEFINED, PROJECTED, AREA, WGS_84, TRANSVERSE_MERCATOR, METRE = 32767, 1, 1, 4326, 1, 9001

Keys = dict[int, int | float | str]
Tag = tuple[int, str, int, tuple[float, ...] | str, bool]


def local_keys() -> Keys:
    """A grid of metres that lies nowhere on the Earth."""
    return {
        MODEL_TYPE: USER_DEFINED,
        RASTER_TYPE: AREA,
        CITATION: "map of Hectorscope, metres",
        LINEAR_UNITS: METRE,
    }


def earth_keys(latitude: float, longitude: float, altitude: float) -> Keys:
    """East and north of a point on WGS 84, degrees and metres, as measured at its altitude."""
    return {
        MODEL_TYPE: PROJECTED,
        RASTER_TYPE: AREA,
        CITATION: "east and north of the first satellite fix",
        GEOGRAPHIC_TYPE: WGS_84,
        PROJECTED_TYPE: USER_DEFINED,
        PROJECTION: USER_DEFINED,
        METHOD: TRANSVERSE_MERCATOR,
        LINEAR_UNITS: METRE,
        ORIGIN_LONGITUDE: longitude,
        ORIGIN_LATITUDE: latitude,
        FALSE_EASTING: 0.0,
        FALSE_NORTHING: 0.0,
        ORIGIN_SCALE: 1.0 + altitude / EARTH_RADIUS,
    }


def key_tags(keys: Keys) -> list[Tag]:
    """The directory of the keys, whole numbers in place, and the others in tags of their own."""
    doubles: list[float] = []
    text = ""
    entries: list[int] = []
    for key, value in keys.items():
        if isinstance(value, str):
            entries += [key, ASCII, len(value) + 1, len(text)]
            text += f"{value}|"
        elif isinstance(value, float):
            entries += [key, DOUBLES, 1, len(doubles)]
            doubles.append(value)
        else:
            entries += [key, 0, 1, value]
    directory = (1, 1, 0, len(keys), *entries)
    tags: list[Tag] = [(DIRECTORY, "H", len(directory), directory, True)]
    if doubles:
        tags.append((DOUBLES, "d", len(doubles), tuple(doubles), True))
    return [*tags, (ASCII, "s", len(text) + 1, text, True)]


def affine(place: Place, east: float = 0.0, north: float = 0.0, turn: float = 0.0) -> NDArray[np.float64]:
    """(2, 3) column and row of a picture to its place, with the map's origin at east, north, turned by `turn`."""
    c, s, r = math.cos(turn), math.sin(turn), place.resolution
    return np.array([
        [r * c, r * s, east + c * place.x - s * place.y],
        [r * s, -r * c, north + s * place.x + c * place.y],
    ])  # fmt: skip


def place_tags(A: NDArray[np.float64]) -> list[Tag]:
    """An affine as scale and tie point where it is upright, which every reader knows."""
    (a, b, c), (d, e, f) = A.tolist()
    if b == d == 0.0:
        return [(SCALE, "d", 3, (a, -e, 0.0), True), (TIEPOINT, "d", 6, (0.0, 0.0, 0.0, c, f, 0.0), True)]
    matrix = (a, b, 0.0, c, d, e, 0.0, f, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)
    return [(TRANSFORMATION, "d", 16, matrix, True)]


def world_file(A: NDArray[np.float64]) -> str:
    """The six lines of a .tfw; the last two are the centre of the upper left pixel."""
    (a, b, c), (d, e, f) = A.tolist()
    values = (a, d, b, e, c + 0.5 * (a + b), f + 0.5 * (d + e))
    return "".join(f"{value:.12g}\n" for value in values)


def _located(run: Run, drawn: Picture) -> tuple[NDArray[np.float64], Keys]:
    origin, where = run.report.origin, run.metrics.get("map_in_world")
    if origin is None or where is None:
        return affine(drawn.place), local_keys()
    turn = math.radians(where["from_east_deg"])
    return affine(drawn.place, where["east_m"], where["north_m"], turn), earth_keys(*origin)


def described(run: Run) -> str | None:
    """Which files of pictures.zip show what is marked in the picture, a line each; None without any."""
    shown = (mark for mark in run.annotations if mark.picture)
    return "\n".join(f"mark {mark.number} {mark.kind}: {PICTURES}/{mark.picture_name}" for mark in shown) or None


def _write(run: Run, folder: Path) -> None:
    if not run.maps:
        return
    name = run.recording.name if run.recording else "Hectorscope"
    drawn = picture(run.maps, run.trajectory, name, run.annotations)
    A, keys = _located(run, drawn)
    content = io.BytesIO()
    tags = [*place_tags(A), *key_tags(keys)]
    tifffile.imwrite(
        content, drawn.rgb, photometric="rgb", compression="zlib", predictor=True, rowsperstrip=64, metadata=None,
        software="Hectorscope", description=described(run), extratags=tags,
    )  # fmt: skip
    write_whole(folder / "map.tif", content.getvalue())
    write_whole(folder / "map.tfw", world_file(A).encode())


EXPORTER = Exporter("geotiff", ("map.tif", "map.tfw"), _write)
