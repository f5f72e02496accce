"""Formats that are written while the run goes on."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from hectorscope.exporters import OutputError, chosen, run
from hectorscope.exporters._files import unfinished
from hectorscope.inputs import Item, SourceOptions
from hectorscope.run.headless import run_headless
from hectorscope.run.series import SERIES_FIELDS
from hectorscope.simulation import SimulateOptions, simulate
from hectorscope.sources import open_source
from tests.conftest import ROOT
from tests.engines import START
from tests.sources import MemoryRecording

PATIENCE_S = 180.0
SCANS = 70  # of the drive, until it breaks off
# Runs that drive, and kills itself without a word in the middle.
KILLED = f"""
import os, signal, sys
from pathlib import Path
from hectorscope.exporters import chosen, run
from hectorscope.simulation import SceneOptions, Simulation
from slam_core.measurements import LaserScan
from tests.engines import START
from tests.sources import MemoryRecording

class Broken(MemoryRecording):
    def items(self):
        scans = 0
        for item in super().items():
            scans += isinstance(item, LaserScan)
            if scans > {SCANS}:
                os.kill(os.getpid(), signal.SIGKILL)
            yield item

drive = list(Simulation("rooms", SceneOptions(duration=4.0, scan_rate=20.0, beams=181)).items())
run(Broken(drive), START, Path(sys.argv[1]), truth=None, progress=lambda _: None, formats=chosen(sys.argv[2]))
"""


def exported(drive: list[Item], folder: Path, formats: str) -> None:
    """The files of a whole run over the drive."""
    run(MemoryRecording(drive), START, folder, truth=None, progress=lambda _: None, formats=chosen(formats))


def killed(folder: Path, formats: str) -> None:
    """What a process leaves that was killed after SCANS scans."""
    path = os.pathsep.join([str(ROOT), str(ROOT / "app")])
    command = [sys.executable, "-c", KILLED, str(folder), formats]
    done = subprocess.run(
        command,
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )
    assert done.returncode == -signal.SIGKILL, done.stderr


def table(path: Path) -> np.ndarray:
    """A CSV with a head, by name."""
    return np.genfromtxt(path, delimiter=",", names=True, dtype=np.float64)


def test_the_series_has_every_figure_of_every_scan(drive: list[Item], tmp_path: Path):
    """The head names them, the values are those of the run to nine digits, the time is whole."""
    exported(drive, tmp_path, "csv")
    assert [path.name for path in tmp_path.iterdir()] == ["series.csv"]
    read = table(tmp_path / "series.csv")
    pipeline, _ = run_headless(MemoryRecording(drive), START)
    assert read.dtype.names == ("t", *SERIES_FIELDS)
    assert len(read) == pipeline.scans
    for column, name in enumerate(SERIES_FIELDS):
        if not name.endswith("_ms"):  # what a clock measured
            np.testing.assert_allclose(read[name], pipeline.series[:, column], rtol=1e-8, atol=1e-12)
    np.testing.assert_allclose(read["t"] - (pipeline.start_ns or 0) / 1e9, read["time_s"], atol=1e-6)


def test_a_killed_run_leaves_the_rows_it_had(drive: list[Item], tmp_path: Path):
    """Under a name that says so, each row whole; nothing has the name of a finished file."""
    killed(tmp_path, "csv,tum,kitti")
    names = {"series.csv", "trajectory.tum", "trajectory.kitti", "times.txt"}
    left = {unfinished(tmp_path / name) for name in names}
    assert set(tmp_path.iterdir()) == left
    read = table(tmp_path / "series.unfinished.csv")
    assert 32 <= len(read) <= SCANS
    exported(drive, tmp_path / "whole", "csv,tum,kitti")
    assert {path.name for path in (tmp_path / "whole").iterdir()} == names
    for path in left - {tmp_path / "series.unfinished.csv"}:
        lines = path.read_bytes()
        assert lines.count(b"\n") == len(read)
        assert (tmp_path / "whole" / path.name.replace(".unfinished", "")).read_bytes().startswith(lines)
    np.testing.assert_array_equal(read["x"], table(tmp_path / "whole" / "series.csv")["x"][: len(read)])


def test_the_next_run_sets_a_killed_one_aside(drive: list[Item], tmp_path: Path):
    """One file with the whole run, and no half one beside it; the half one is kept, of any format."""
    half = tmp_path / "trajectory.unfinished.tum"
    half.write_text("half")
    os.utime(half, (0, 0))
    exported(drive, tmp_path, "csv")
    assert {path.name for path in tmp_path.iterdir()} == {"series.csv", "earlier"}
    assert (tmp_path / "earlier" / "19700101T000000Z" / half.name).read_text() == "half"


def test_an_interrupted_run_leaves_the_rows_it_had(drive: list[Item], tmp_path: Path):
    """As by Ctrl-C: the older finished file stays beside the unfinished one."""
    (tmp_path / "series.csv").write_text("old")
    with pytest.raises(KeyboardInterrupt):
        run(
            MemoryRecording(drive, error=KeyboardInterrupt(), fail_at=len(drive) - 5),  # type: ignore[arg-type]
            START, tmp_path, truth=None, progress=lambda _: None, formats=chosen("csv"),
        )  # fmt: skip
    assert (tmp_path / "series.csv").read_text() == "old"
    assert len(table(tmp_path / "series.unfinished.csv")) >= 32


def test_a_stream_that_cannot_be_opened_costs_no_other_file(drive: list[Item], tmp_path: Path):
    """A folder in the way is told at the end, and the trajectory is there."""
    (tmp_path / "series.unfinished.csv").mkdir()
    with pytest.raises(OutputError, match=r"Is a directory: series\.csv"):
        exported(drive, tmp_path, "csv,tum")
    assert (tmp_path / "trajectory.tum").stat().st_size > 0


def test_a_recording_with_satellites_gives_the_place_on_the_earth(tmp_path: Path):
    """The first fix is where east and north count from; without one there is no such place."""
    for extras, known in ((("gps",), True), ((), False)):
        bag = tmp_path / f"{known}.bag"
        simulate(SimulateOptions(out=bag, scenario="rooms", duration=3.0, beams=91, extras=extras))
        source = open_source(str(bag), SourceOptions())
        assert sum(1 for _ in source.items()) > 0
        source.close()
        if known:
            assert source.report.origin is not None
            np.testing.assert_allclose(source.report.origin[:2], (37.059, -80.637), atol=1e-4)
        else:
            assert source.report.origin is None
