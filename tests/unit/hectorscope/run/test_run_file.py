"""RUN.toml: a run as text, there and back, and what is none."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hectorscope.run.annotations import Annotations
from hectorscope.run.fingerprint import Identity
from hectorscope.run.permalink import Permalink
from hectorscope.run.run_file import FILE, RunFile, RunFileError, hash_of, read_run, write_text
from hectorscope.run.settings import Settings
from slam_core.config import SlamConfig, with_values

SETTINGS = Settings(with_values(SlamConfig(), {"fusion.omega": 0.25, "fusion.method": "trace"}))
NAME = 'the "first"\x7f\\ one = [1]'
RUN = RunFile(
    link=Permalink(Identity(7, "ab" * 32), 12, SETTINGS.changed(5, "fusion.omega", 0.5), NAME, "cd" * 32),
    recording="arena.bag",
    scans=3,
    trajectory_sha256=hash_of(np.zeros((3, 8))),
    sensors={"imu_accel_unit": "g", "imu_rotation": (3.14, 0.0, 0.0)},
    annotations=Annotations().put("victim", 17, (1.5, -2.0), (0.0, 0.25, 3.0), '"<b>"\x1b'),
)


def read(tmp_path: Path, text: str) -> RunFile:
    (tmp_path / FILE).write_text(text, encoding="utf-8")
    return read_run(tmp_path / FILE)


def test_a_run_is_read_as_it_was_written(tmp_path: Path) -> None:
    """Recording, time, name, prior map, settings with their changes, sensors and results."""
    again = read(tmp_path, write_text(RUN))
    assert again.link.name == 'the "first"\N{REPLACEMENT CHARACTER}\\ one = [1]'
    assert (again.link.recording, again.link.offset_ns) == (RUN.link.recording, 12)
    assert again.link.settings == RUN.link.settings
    assert again.link.map_sha256 == "cd" * 32
    assert (again.scans, again.trajectory_sha256, again.sensors) == (3, RUN.trajectory_sha256, RUN.sensors)


def test_marks_are_read_as_they_were_written(tmp_path: Path) -> None:
    """With the next number that is given; only what a terminal could take for a command is left out of a text."""
    (mark,), (wanted,) = read(tmp_path, write_text(RUN)).annotations.marks, RUN.annotations.marks
    assert replace(mark, text="") == replace(wanted, text="")
    assert mark.text == '"<b>"\N{REPLACEMENT CHARACTER}'
    assert read(tmp_path, write_text(RUN)).annotations.given == 1


def test_an_emoji_is_read_as_it_was_written(tmp_path: Path) -> None:
    """In a name and in a mark; the name of a file that is no text has a replacement for what is none."""
    link = replace(RUN.link, name="\N{FIRE} \\ud83d\\udd25")
    marks = Annotations().put("hazard", 17, (1.5, -2.0), (0.0, 0.25, 3.0), "\N{FIRE}")
    again = read(tmp_path, write_text(replace(RUN, link=link, recording="\udcff.bag", annotations=marks)))
    assert (again.link.name, again.annotations) == (link.name, marks)
    assert again.recording == "\N{REPLACEMENT CHARACTER}.bag"


def test_an_emoji_in_a_file_of_an_earlier_version_is_read(tmp_path: Path) -> None:
    """Two escapes stood there for one character; a backslash before them is none of theirs."""
    text = write_text(RUN).replace('"arena.bag"', r'"\\ud83d \\\ud83d\udd25"')
    assert read(tmp_path, text).recording == "\\ud83d \\\N{FIRE}"


def test_another_trajectory_has_another_hash() -> None:
    """By a single bit."""
    rows = np.zeros((3, 8))
    rows[2, 7] = -0.0
    assert hash_of(rows) != RUN.trajectory_sha256


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("[run]", "[ran]", "[run] is missing"),
        ("[results]", "[result]", "[results] is missing"),
        ("size = 7", "size = -7", "out of range"),
        ("size = 7", 'size = "7"', "run.size"),
        ("offset_ns = 12", "offset_ns = -1", "out of range"),
        ("ab" * 32, "ab" * 31, "out of range"),
        ("scans = 3", "scans = true", "results.scans"),
        ("cd" * 32, "cd" * 31, "run.map_sha256"),
        ('kind = "victim"', 'kind = "ghost"', "ghost"),
        ("place = [1.5,", "place = [nan,", "place"),
        ("place = [1.5,", f"place = [1{400 * '0'},", "place"),
        ("time_ns = 17", f"time_ns = {2**63}", "time_ns"),
        ("number = 1\n", "", "number"),
        ("omega = 0.25", "omega = 7", "fusion.omega"),
        ("[fusion]", "[fusion", "TOML"),
        ("[fusion]", "[sensor]\nx = 1\n[fusion]", "sensor.x"),
    ],
)
def test_a_damaged_file_is_named_with_the_reason(tmp_path: Path, old: str, new: str, reason: str) -> None:
    """In one sentence."""
    text = write_text(RUN)
    assert old in text
    with pytest.raises(RunFileError, match=rf"^{tmp_path.name}/RUN\.toml is no run \(") as refused:
        read(tmp_path, text.replace(old, new, 1))
    assert reason in str(refused.value) or reason == "TOML"


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    """With the reason of the system."""
    with pytest.raises(RunFileError, match="No such file"):
        read_run(tmp_path / FILE)
