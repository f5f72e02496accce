"""The GeoTIFF, read back by rasterio (GDAL)."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import rasterio
from rasterio.warp import transform

from hectorscope.exporters import chosen
from hectorscope.exporters._rescue_map import EXPLORED, PATH, START, WALL
from hectorscope.inputs import SourceReport
from hectorscope.run.map_image import MapImage
from hectorscope.run.results import Run
from hectorscope.run.settings import Settings
from slam_core.navigation.aiding.geodesy import TangentPlane

ORIGIN = (37.059, -80.637, 562.0)
RESOLUTION = 0.05


@pytest.fixture
def run() -> Run:
    """A free square of 4 m about the origin, a wall at its right edge, and a path along the x axis."""
    cells = np.ones((80, 80), np.uint8)
    cells[:, -1] = 2
    cells[:10, :10] = 0
    level = MapImage(0, RESOLUTION, -2.0, -2.0, cells, 1)
    trajectory = np.array([[t, 0.12 * t, 0.03, 0.0, 1.0, 0.0, 0.0, 0.0] for t in range(12)])
    return Run(0, trajectory, (level,), Settings(), {"map_in_world": None})


def located(run: Run) -> Run:
    """The same, where satellites gave the origin and the map is turned by 30 degrees."""
    where = {"east_m": 120.0, "north_m": -45.0, "from_east_deg": 30.0}
    return replace(run, metrics={"map_in_world": where}, report=SourceReport(origin=ORIGIN))


def colour(picture: rasterio.DatasetReader, x: float, y: float) -> tuple[int, ...]:
    """Of the pixel at a place in the coordinates of the picture."""
    row, column = picture.index(x, y)
    return tuple(picture.read()[:, row, column].tolist())


def test_rasterio_finds_every_colour_at_its_place(run: Run, tmp_path: Path):
    """In metres of the map: wall, explored and unexplored ground, the path and the start where they are."""
    chosen("geotiff")[0].write(run, tmp_path)
    with rasterio.open(tmp_path / "map.tif") as picture:
        wkt = picture.crs.to_wkt()
        assert wkt.startswith("LOCAL_CS")
        assert 'UNIT["metre",1' in wkt
        assert picture.res == (RESOLUTION, RESOLUTION)
        assert colour(picture, 1.98, 0.33) == WALL
        assert colour(picture, -0.72, 0.83) == EXPLORED
        assert {colour(picture, -1.78, -1.78), colour(picture, -2.5, -1.78)} == {(226, 226, 227), (237, 237, 238)}
        assert colour(picture, 1.2, 0.03) == PATH
        assert colour(picture, 0.02, 0.03) == START


def test_the_world_file_says_the_same(run: Run, tmp_path: Path):
    """Readers that know no GeoTIFF find the picture at the same place: the centre of the upper left pixel."""
    for each in (run, located(run)):
        chosen("geotiff")[0].write(each, tmp_path)
        a, d, b, e, c, f = map(float, (tmp_path / "map.tfw").read_text().split())
        with rasterio.open(tmp_path / "map.tif") as picture:
            corner = picture.transform @ (0.5, 0.5)
            np.testing.assert_allclose((a, b, d, e), [getattr(picture.transform, n) for n in "abde"], atol=1e-9)
            np.testing.assert_allclose((c, f), corner, atol=1e-9)


def test_a_map_that_satellites_placed_lies_on_the_earth(run: Run, tmp_path: Path):
    """A point of the map has the latitude and longitude of the tangent plane, to a centimetre in 150 m."""
    chosen("geotiff")[0].write(located(run), tmp_path)
    turn = math.radians(30.0)
    with rasterio.open(tmp_path / "map.tif") as picture:
        assert picture.crs.is_projected
        for x, y in ((0.0, 0.0), (1.98, 0.33), (-1.33, 1.83)):
            east = 120.0 + math.cos(turn) * x - math.sin(turn) * y
            north = -45.0 + math.sin(turn) * x + math.cos(turn) * y
            (longitude,), (latitude,) = transform(picture.crs, "EPSG:4326", [east], [north])
            expected = TangentPlane(*ORIGIN).geodetic(np.array([east, north, 0.0]))
            assert latitude == pytest.approx(expected[0], abs=1e-7)
            assert longitude == pytest.approx(expected[1], abs=1e-7)
            assert colour(picture, east, north) == (START if x == 0.0 else WALL if x > 1.9 else EXPLORED)


def test_a_run_at_rest_or_without_a_map(run: Run, tmp_path: Path):
    """One pose is a start without a way; without a map there is no picture."""
    chosen("geotiff")[0].write(replace(run, trajectory=run.trajectory[:1]), tmp_path)
    with rasterio.open(tmp_path / "map.tif") as picture:
        assert colour(picture, 0.02, 0.03) == START
    chosen("geotiff")[0].write(replace(run, maps=()), tmp_path / "none")
    assert not (tmp_path / "none").exists()
