"""From names and files to specs."""

from pathlib import Path

import pytest

from hectorscope.sweep.plan import from_file, product, recordings, with_setting
from hectorscope.sweep.spec import RunSpec
from hectorscope.sweep.vary import VaryError
from slam_core.config import SlamConfig
from slam_core.errors import SlamError

BASE = RunSpec("", "", {"map.levels": 2}, ((5, "fusion.omega", 0.1),), {"scan_delay": 0.1})
BAGS = [("a", "/a"), ("b", "/b")]


def test_recordings_are_made_absolute_and_named_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Workers have other folders; the name stays as it was given."""
    (tmp_path / "a.bag").touch()
    monkeypatch.chdir(tmp_path)
    assert recordings(["a.bag", "./a.bag"]) == [("a.bag", str(tmp_path / "a.bag"))]
    with pytest.raises(VaryError, match=r"a.bog does not exist \(did you mean a.bag\?\)"):
        recordings(["a.bog"])


def test_addresses_with_a_pattern_are_listed(tmp_path: Path):
    """By fsspec, sorted; one that fits nothing is named."""
    for name in ("b.bag", "a.bag", "c.txt"):
        (tmp_path / name).touch()
    address = f"{tmp_path.as_uri()}/*.bag"
    assert [Path(path).name for _, path in recordings([address])] == ["a.bag", "b.bag"]
    with pytest.raises(SlamError, match="matches nothing"):
        recordings([f"{tmp_path.as_uri()}/*.mcap"])


def test_every_recording_has_every_setting():
    """Recording by recording; what all share stays."""
    specs = product(BAGS, [{"matcher.sigma": 0.1}, {"matcher.sigma": 0.2}], BASE)
    assert [(spec.recording, spec.value("matcher.sigma")) for spec in specs] == [
        ("a", 0.1),
        ("a", 0.2),
        ("b", 0.1),
        ("b", 0.2),
    ]
    assert all(spec.value("map.levels") == 2 for spec in specs)


def test_a_varied_setting_takes_the_place_of_all_before():
    """Of the base's value, of a change during the run, and of a sensor option."""
    spec = with_setting(BASE, {"fusion.omega": 0.3, "sensors.scan_delay": 0})
    assert spec.settings == {"map.levels": 2, "fusion.omega": 0.3}
    assert (spec.changes, spec.options) == ((), {"scan_delay": 0.0})


def test_a_file_lists_runs(tmp_path: Path):
    """Each with settings of its own, on its recording or on all others; a path is relative to the file."""
    (tmp_path / "c.bag").touch()
    path = tmp_path / "runs.toml"
    path.write_text('[[runs]]\nrecording = "c.bag"\nmatcher.sigma = 0.2\n\n[[runs]]\nsensors.scan_delay = 0.2\n')
    usual = SlamConfig().matcher.sigma
    specs, names = from_file(path, BAGS, BASE)
    assert [spec.path for spec in specs] == [str(tmp_path / "c.bag"), "/a", "/b"]
    assert [spec.value("matcher.sigma") for spec in specs] == [0.2, usual, usual]
    assert [spec.options["scan_delay"] for spec in specs] == [0.1, 0.2, 0.2]
    assert names == ["matcher.sigma", "sensors.scan_delay"]


def test_a_run_of_a_file_may_have_its_own_truth_and_relations(tmp_path: Path):
    """A topic, or files beside the list."""
    (tmp_path / "true.log").touch()
    path = tmp_path / "runs.toml"
    path.write_text('[[runs]]\ntruth = "/vicon"\n[[runs]]\ntruth = "true.log"\nrelations = "true.log"\n[[runs]]\n')
    specs, _ = from_file(path, BAGS[:1], BASE)
    beside = str(tmp_path / "true.log")
    assert [spec.options.get("truth_topic") for spec in specs] == ["/vicon", beside, None]
    assert [spec.relations for spec in specs] == ["", beside, ""]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("runs = 1", "no list of runs"),
        ("[[runs]]\n[other]\n", "no list of runs"),
        ("[[runs]]\nrecording = 1", "give a recording and settings"),
        ("[[runs]]\nmatcher.sigma = 99", "matcher.sigma is 99"),
        ("[[runs]]\nmatcher = 1", "matcher is no setting"),
        ("[[runs", "cannot be read"),
        ("runs = " + "[" * 20000, "cannot be read"),
        ("[[runs]]\n" + "a." * 5000 + "a = 1", "cannot be read"),
        (f'[[runs]]\nrelations = "{"x" * 300}"\nmatcher = 1', "matcher is no setting"),
        ('[[runs]]\nrecording = "missing.bag"', "does not exist"),
        ("[[runs]]\ntruth = 1", "give a recording and settings"),
    ],
)
def test_a_bad_file_is_named(tmp_path: Path, text: str, message: str):
    """With what is wrong in it."""
    path = tmp_path / "runs.toml"
    path.write_text(text)
    with pytest.raises(SlamError, match=message):
        from_file(path, BAGS, BASE)
