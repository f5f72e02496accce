"""The report: what is in it, and the curves."""

import hashlib
import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hectorscope.exporters._charts import BINS, HEIGHT, LEFT, TOP, WIDTH, chart
from hectorscope.exporters.report import charts, figures, page
from hectorscope.inputs import Finding, SourceReport
from hectorscope.run.fingerprint import fingerprints
from hectorscope.run.map_image import MapImage
from hectorscope.run.results import Run
from hectorscope.run.series import SERIES_FIELDS, TRACKING
from hectorscope.run.settings import Change, Settings
from slam_core.config import SlamConfig, with_value

START_NS = 1_700_000_000_000_000_000


@pytest.fixture
def run(tmp_path: Path) -> Run:
    """Ten seconds with a finding, a changed setting, and a recording whose name looks like markup."""
    seconds = np.linspace(0.0, 10.0, 101)
    trajectory = np.column_stack([seconds, 0.1 * seconds, *np.zeros((2, 101)), np.ones(101), *np.zeros((3, 101))])
    series = np.full((101, len(SERIES_FIELDS)), 0.2)
    series[:, 0] = seconds
    recording = tmp_path / "<i>a&b.bag"
    recording.write_bytes(b"some bytes")
    return Run(
        START_NS,
        trajectory,
        (MapImage(0, 0.05, -1.0, -1.0, np.ones((40, 60), np.uint8), 1),),
        Settings(
            with_value(SlamConfig(), "matcher.prior_weight", 2.5), (Change(START_NS + 10**9, "fusion.omega", 0.4),)
        ),
        {
            "scans": {"used": 101, "read": 103, "skipped": {"no beam": 2}},
            "tracking": {"tracking": 101},
            "notes": ["n<1"],
        },
        report=SourceReport(findings=(Finding("the gyro is in deg/s", {"imu_gyro_unit": "deg/s"}),)),
        series=series,
        recording=recording,
    )


def points(path: str) -> np.ndarray:
    """(n, 2) of the path of an SVG."""
    return np.array(re.findall(r"[ML]([-\d.]+) ([-\d.]+)", path), np.float64)


def test_the_path_is_that_in_the_plane(run: Run):
    """A height that nothing measured makes it no longer."""
    run.trajectory[:, 3] = np.sin(np.arange(101.0))
    assert dict(figures(run))["Path in the plane"].startswith("1.00 m in 10.0 s")


def test_everything_that_is_known_is_in_it(run: Run):
    """Figures, the finding with its remedy, settings that differ, their changes, the hash of the recording."""
    text = page(run)
    assert "101 used of 103" in text
    assert "2 × no beam" in text
    assert "1.00 m in 10.0 s" in text
    assert "<code>--imu-gyro-unit deg/s</code>" in text
    assert re.search(r"matcher.prior_weight</code></td><td>2.5 *</td><td>1.0", text)
    assert re.search(r"1.000 s</td><td><code>fusion.omega</code></td><td>0.4", text)
    assert hashlib.sha256(b"some bytes").hexdigest() in text
    assert "2023-11-14 22:13:20 UTC" in text
    assert len(charts(run)) == 5


def test_what_is_worth_a_look_is_listed(run: Run):
    """By time: a change of settings, and the matches that were rejected; a finding has no time, and is no mark."""
    series = run.series.copy()
    series[:, SERIES_FIELDS.index("tracking")] = 0.0
    series[[50, 51], SERIES_FIELDS.index("tracking")] = TRACKING.index("degraded")
    text = page(replace(run, series=series))
    rows = re.findall(r"<tr><td>([\d.]+) s</td><td>([\w ]+)</td><td>(.*)</td></tr>", text)
    assert rows == [
        ("1.000", "settings changed", "fusion.omega = 0.4"),
        ("5.000", "bad match", "2 matches rejected: at worst 20% of the points lie on walls"),
    ]


def test_nothing_of_a_recording_becomes_markup(run: Run):
    """Its name and its notes are text, and the page has no script and loads nothing."""
    text = page(run)
    assert "<i>" not in text
    assert "&lt;i&gt;a&amp;b.bag" in text
    assert "n&lt;1" in text
    assert "<script" not in text
    assert not re.search(r"(src|href)=.https?:", text)


def test_a_run_without_map_curves_or_recording_has_a_page(run: Run):
    """What is not there is left out."""
    text = page(replace(run, maps=(), series=run.series[:0], recording=None, metrics={}, report=SourceReport()))
    assert "<svg" not in text
    assert "SHA-256" not in text
    assert "<p>None.</p>" in text


def test_a_curve_lies_between_its_axes_and_breaks_where_there_is_nothing():
    """The largest value is on top, the first time at the left; a nan is a gap."""
    seconds = np.arange(5.0)
    made = chart("c", seconds, {"a": np.array([0.0, 1.0, math.nan, 4.0, 2.0])})
    found = points(made.curves[0].path)
    assert made.curves[0].path.count("M") == 2
    np.testing.assert_allclose(found[0], [LEFT, HEIGHT - 22], atol=0.1)
    assert found[2, 1] == pytest.approx(TOP, abs=0.1)
    assert found[:, 0].max() < WIDTH
    assert {tick.label for tick in made.up} >= {"0", "4"}


def test_decades_have_round_marks():
    """Of a logarithmic axis; what is not above 0 is left out."""
    made = chart("c", np.arange(3.0), {"a": np.array([0.0, 0.02, 30.0])}, log=True)
    assert [tick.label for tick in made.up] == ["0.01", "0.1", "1", "10", "100"]
    assert len(points(made.curves[0].path)) == 2


def test_a_long_curve_keeps_its_peaks():
    """A single scan in a hundred thousand that is out of line is drawn, in a path of bounded length."""
    values = np.full(100_000, 0.1)
    values[54_321] = 0.9
    found = points(chart("c", np.arange(1e5), {"a": values}).curves[0].path)
    assert len(found) <= 2 * BINS
    assert found[:, 1].min() == pytest.approx(TOP, abs=0.1)


def test_nothing_to_draw_is_no_chart():
    """A column of nothing but nan, or no rows at all."""
    assert chart("c", np.arange(3.0), {"a": np.full(3, np.nan)}).empty
    assert chart("c", np.zeros(0), {"a": np.zeros(0)}).empty


def test_a_folder_is_hashed_file_by_file(tmp_path: Path):
    """In the order of their names."""
    (tmp_path / "b.db3").write_bytes(b"data")
    (tmp_path / "a.yaml").write_bytes(b"")
    first, second = fingerprints(tmp_path)
    assert (first.name, first.size, first.sha256) == ("a.yaml", 0, hashlib.sha256(b"").hexdigest())
    assert (second.name, second.size, second.sha256) == ("b.db3", 4, hashlib.sha256(b"data").hexdigest())
