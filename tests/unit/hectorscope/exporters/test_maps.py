"""Images of the map, read by the rules of the map servers, from pixels that Pillow decodes."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from ruamel.yaml import YAML

from hectorscope.exporters import chosen
from hectorscope.maps.ros_map import read_ros_map
from hectorscope.run.results import Run
from hectorscope.run.settings import Settings
from slam_core.config import MapConfig
from slam_core.localization.prior_map import SavedLevel

UNKNOWN = -1
# Surely free, likely free, between the thresholds, likely occupied, occupied; the second row is unknown in part.
LOG_ODDS = np.array([[-200.0, -3.0, -0.4, 0.9, 50.0], [-2.0, 0.0, 0.0, 0.0, 2.0]], np.float32)
PROBABILITY = 1.0 / (1.0 + np.exp(-LOG_ODDS.astype(np.float64)))


@pytest.fixture
def run() -> Run:
    """A run with that map, its corner at column -30 and row 40."""
    level = SavedLevel(0.05, np.array([-30, 40]), LOG_ODDS)
    coarse = SavedLevel(0.1, np.array([-15, 20]), LOG_ODDS[:1])
    return Run(0, np.zeros((1, 8)), (), Settings(), {}, (level, coarse))


def served(folder: Path, described: str) -> NDArray[np.int64]:
    """(rows, columns) of the occupancy grid that a map server publishes, row 0 the lowest y: -1, or 0 to 100."""
    said = YAML(typ="safe", pure=True).load((folder / described).read_text())
    assert said["resolution"] == 0.05
    assert said["origin"] == [-1.5, 2.0, 0.0]
    pixels = np.asarray(Image.open(folder / said["image"]).convert("LA"))[::-1].astype(np.int64)
    grey, opacity = pixels[..., 0], pixels[..., 1]
    if said["mode"] == "raw":
        return np.where(grey <= 100, grey, UNKNOWN)
    occupied, free = said["occupied_thresh"], said["free_thresh"]
    occupancy = (255 - grey) / 255.0
    between = np.rint(100.0 * (occupancy - free) / (occupied - free)).astype(np.int64)
    values = np.where(occupancy > occupied, 100, np.where(occupancy < free, 0, between))
    return np.where(opacity < 255, UNKNOWN, values)


def test_the_raw_mode_gives_every_probability_in_percent(run: Run, tmp_path: Path):
    """To the nearest percent; unknown cells are unknown."""
    chosen("raw")[0].write(run, tmp_path)
    expected = np.where(LOG_ODDS == 0.0, UNKNOWN, np.rint(100.0 * PROBABILITY).astype(np.int64))
    np.testing.assert_array_equal(served(tmp_path, "map_raw.yaml"), expected)


@pytest.mark.parametrize(("name", "unknown"), [("scale", 50), ("png", UNKNOWN)])
def test_the_scale_mode_keeps_what_lies_between_the_thresholds(name: str, unknown: int, run: Run, tmp_path: Path):
    """Free 0, occupied 100, the rest in proportion; unknown is a half in a PGM and transparent in a PNG."""
    chosen(name)[0].write(run, tmp_path)
    got = served(tmp_path, f"map_{name}.yaml")
    share = 100.0 * (PROBABILITY - 0.196) / (0.65 - 0.196)
    expected = np.where(LOG_ODDS == 0.0, unknown, np.rint(np.clip(share, 0.0, 100.0)))
    np.testing.assert_allclose(got, expected, atol=1)
    assert 0 < got[0, 2] < 100


@pytest.mark.parametrize("name", ["scale", "png"])
def test_our_own_reader_takes_them_too(name: str, run: Run, tmp_path: Path):
    """`--map` finds the free and the occupied cells where they were, and nothing where all is unknown."""
    chosen(name)[0].write(run, tmp_path)
    level = read_ros_map(tmp_path / f"map_{name}.yaml", MapConfig(levels=1))[0]
    assert level.corner.tolist() == [-30, 40]
    signs = np.where(PROBABILITY > 0.65, 1, np.where(PROBABILITY < 0.196, -1, 0))
    np.testing.assert_array_equal(np.sign(level.log_odds), signs)


def test_a_map_in_parts_comes_out_in_one_piece(tmp_path: Path):
    """Parts of the finest level that do not touch; what lies between them is unknown."""
    parts = (
        SavedLevel(0.05, np.array([0, 0]), np.full((2, 2), 3.0, np.float32)),
        SavedLevel(0.05, np.array([4, 3]), np.full((1, 3), -3.0, np.float32)),
        SavedLevel(0.1, np.array([0, 0]), np.full((1, 1), 3.0, np.float32)),
    )
    chosen("raw")[0].write(Run(0, np.zeros((1, 8)), (), Settings(), {}, parts), tmp_path)
    pixels = np.asarray(Image.open(tmp_path / "map_raw.pgm"))[::-1]
    assert pixels.shape == (4, 7)
    np.testing.assert_array_equal(pixels[:2, :2], 95)
    np.testing.assert_array_equal(pixels[3, 4:], 5)
    assert np.count_nonzero(pixels == 255) == 28 - 4 - 3
