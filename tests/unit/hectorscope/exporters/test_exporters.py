import json
import math
import zipfile
from base64 import b64encode
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import tifffile

from hectorscope.exporters import FormatError, chosen, exporters
from hectorscope.exporters.occupancy import GREYS, description, pgm
from hectorscope.exporters.tum import tum_lines
from hectorscope.run.annotations import Annotation
from hectorscope.run.map_image import MapImage
from hectorscope.run.pictures import picture_of
from hectorscope.run.results import Run
from hectorscope.run.settings import Settings
from hectorscope.run.settings_file import read_toml
from slam_core.localization.prior_map import SavedLevel
from tests.pictures import picture_bytes

PICTURE = picture_of(picture_bytes())
MARK = Annotation(3, "victim", 0, 1.5, 2.1, (1.0, 2.0, 0.0), "two", PICTURE)
START_NS = 1_700_000_000_123_456_789


@pytest.fixture
def finished() -> Run:
    """Two poses and a map of two rows, the upper one occupied."""
    trajectory = np.array([[0.0, 1, 2, 3, 1, 0, 0, 0], [0.000000001, 4, 5, 6, 0.5, 0.5, 0.5, -0.5]])
    cells = np.array([[1, 1, 0], [2, 2, 2]], np.uint8)
    level = SavedLevel(0.05, np.array([-30, 40]), np.array([[-1, -1, 0], [2, 2, 2]], np.float32))
    return Run(
        START_NS,
        trajectory,
        (MapImage(0, 0.05, -1.5, 2.0, cells, 1),),
        Settings(),
        {"wall_s": 2},
        (level,),
        annotations=(MARK,),
    )


def test_every_exporter_leaves_exactly_its_files(finished: Run, tmp_path: Path):
    """The contract of the folder: the files that an exporter names, whole, and nothing temporary."""
    whole = [exporter for exporter in exporters() if exporter.stream is None]
    for exporter in whole:
        exporter.write(finished, tmp_path)
        for name in exporter.files:
            assert (tmp_path / name).stat().st_size > 0
    assert {path.name for path in tmp_path.iterdir()} == {name for e in whole for name in e.files}


def test_formats_are_chosen_by_name():
    """One, several with spaces or capitals, everything; in the order of the folder. Unasked, eight files."""
    assert [exporter.name for exporter in chosen("tum")] == ["tum"]
    assert [exporter.name for exporter in chosen("CSV, default")] == [*(e.name for e in chosen()), "csv"]
    assert chosen("all") == exporters()
    assert {name for exporter in chosen() for name in exporter.files} == {
        "map.npz", "map.pgm", "map.yaml", "trajectory.tum", "config.toml", "metrics.json", "navigation.csv",
        "pictures.zip",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("wrong", "nearest"),
    [("kiti", "kitti"), ("tum,pgmm", "pgm"), ("metric", "metrics"), ("html", "report"), ("tiff", "geotiff")],
)
def test_a_wrong_name_is_answered_with_the_nearest(wrong: str, nearest: str):
    """By its name or the suffix of its files; and with all that there are."""
    with pytest.raises(FormatError, match=rf"is no format: did you mean {nearest}\? There are all, .*, tum"):
        chosen(wrong)


def test_names_and_files_are_unique():
    """No two formats answer to one name or write one file."""
    names = [exporter.name for exporter in exporters()]
    files = [name for exporter in exporters() for name in exporter.files]
    assert len(set(names)) == len(names)
    assert len(set(files)) == len(files)


def test_the_map_comes_first():
    """An operator needs it to go on; the lines of a long run take longer, and their end may not be waited for."""
    assert exporters()[0].files == ("map.npz",)


def test_an_older_file_is_replaced(finished: Run, tmp_path: Path):
    """A second run into the same folder leaves its own files."""
    for exporter in (each for each in exporters() if each.stream is None):
        for name in exporter.files:
            (tmp_path / name).write_text("old")
        exporter.write(finished, tmp_path)
        assert all((tmp_path / name).read_bytes() != b"old" for name in exporter.files)


def test_a_figure_that_is_no_number_is_null(finished: Run, tmp_path: Path):
    """JSON has no word for it, and the rest of the run is worth keeping."""
    run = replace(finished, metrics={"wall_s": 2, "truth": {"raw_rmse_m": math.nan, "poses": math.inf}})
    chosen("metrics")[0].write(run, tmp_path)
    told = json.loads((tmp_path / "metrics.json").read_text())
    assert told == {"wall_s": 2, "truth": {"raw_rmse_m": None, "poses": None}}


def test_tum_lines_have_exact_times_and_the_scalar_last(finished: Run):
    """T x y z qx qy qz qw, to the nanosecond although a float of the date could not hold it."""
    first, second = b"".join(tum_lines(finished.start_ns, finished.trajectory)).decode().splitlines()
    assert first.split()[0] == "1700000000.123456789"
    assert second.split()[0] == "1700000000.123456790"
    assert [float(v) for v in first.split()[1:]] == [1, 2, 3, 0, 0, 0, 1]
    assert [float(v) for v in second.split()[1:]] == [4, 5, 6, 0.5, 0.5, -0.5, 0.5]


def test_the_image_has_its_highest_y_on_top(finished: Run):
    """Row 0 of the map is the last line of the picture."""
    head, pixels = pgm(finished.maps[0].cells).split(b"255\n")
    assert head == b"P5\n3 2\n"
    assert list(pixels) == [0, 0, 0, 254, 254, 205]


def test_a_map_reader_gets_the_classes_back(finished: Run):
    """With the thresholds of map.yaml each grey falls into its own class."""
    values = dict(line.split(": ") for line in description(finished.maps[0]).splitlines())
    probability = (255 - GREYS.astype(float)) / 255
    unknown, free, occupied = probability
    assert occupied > float(values["occupied_thresh"])
    assert free < float(values["free_thresh"])
    assert float(values["free_thresh"]) <= unknown <= float(values["occupied_thresh"])
    assert values["origin"] == "[-1.5, 2.0, 0.0]"
    assert values["resolution"] == "0.05"


def test_a_run_without_a_map_leaves_none(finished: Run, tmp_path: Path):
    """No map, no empty picture."""
    empty = Run(START_NS, finished.trajectory, (), Settings(), {})
    for exporter in exporters():
        exporter.write(empty, tmp_path)
    assert not (tmp_path / "map.pgm").exists()


def test_config_and_metrics_can_be_read_back(finished: Run, tmp_path: Path):
    """config.toml goes back through --config, metrics.json is JSON."""
    for exporter in exporters():
        exporter.write(finished, tmp_path)
    assert read_toml(tmp_path / "config.toml") == finished.settings
    assert json.loads((tmp_path / "metrics.json").read_text()) == {"wall_s": 2}


def test_pictures_of_marks_are_written_by_their_numbers(finished: Run, tmp_path: Path):
    """As they are kept; the map, the figures and the report name or show them; without any, no archive is left."""
    for exporter in chosen("pictures,geotiff,report"):
        exporter.write(finished, tmp_path)
    with zipfile.ZipFile(tmp_path / "pictures.zip") as archive:
        assert {name: archive.read(name) for name in archive.namelist()} == {"mark_3.jpg": PICTURE.content}
    with tifffile.TiffFile(tmp_path / "map.tif") as file:
        assert file.pages[0].description == "mark 3 victim: pictures.zip/mark_3.jpg"  # type: ignore[union-attr]
    shown = b64encode(PICTURE.content).decode()
    assert f'src="data:image/jpeg;base64,{shown}"' in (tmp_path / "report.html").read_text()
    assert MARK.told(0)["picture"] == "mark_3.jpg"
    (exporter,) = chosen("pictures")
    exporter.write(replace(finished, annotations=()), tmp_path)
    assert not (tmp_path / "pictures.zip").exists()
