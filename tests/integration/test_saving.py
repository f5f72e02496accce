"""What a run on the page leaves on the disk: by the button, and at the end of the program."""

import errno
import json
import math
import os
import signal
import socket
import tempfile
import threading
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from hectorscope.cli.interruption import ENDING
from hectorscope.cli.main import main
from hectorscope.exporters import OutputError, export, write
from hectorscope.inputs import Item, SourceReport
from hectorscope.maps.saved_map import load_map
from hectorscope.run.headless import run_headless
from hectorscope.run.metrics import metrics
from hectorscope.run.results import Run
from hectorscope.session.commands import Play, Save, Seek
from hectorscope.session.engine import Engine
from hectorscope.session.snapshot import Snapshot
from hectorscope.simulation import SimulateOptions, simulate
from hectorscope.web.server import PageServer
from slam_core.localization.prior_map import saved_levels
from tests.engines import START, after, running, state, until
from tests.sources import MemoryRecording

PATIENCE_S = 20.0
FILES = {"trajectory.tum", "map.npz", "map.pgm", "map.yaml", "config.toml", "metrics.json", "navigation.csv"}


def saved_by(engine: Engine) -> Snapshot:
    """The snapshot that has the answer to Save, which works beside the engine."""
    lines = len(after(engine, Save()).log)
    return until(engine, lambda now: now.log[-1].answer and len(now.log) >= lines)


def test_save_leaves_what_a_run_leaves(drive: list[Item], tmp_path: Path):
    """Every file, named in the log; the map is that of the run to the last bit, and --map can read it."""
    with running(MemoryRecording(drive), speed=math.inf, out=tmp_path) as engine:
        assert until(engine, state("ended")).saves
        saved = saved_by(engine)
    assert {path.name for path in tmp_path.iterdir()} == FILES
    assert all(name in saved.log[-1].text for name in (*FILES, str(tmp_path)))
    pipeline, _ = run_headless(MemoryRecording(drive), START)
    given = load_map(tmp_path, START.start.map)
    for ours, theirs in zip(given.levels, saved_levels(pipeline.slam.map), strict=True):
        np.testing.assert_array_equal(ours.corner, theirs.corner)
        np.testing.assert_array_equal(ours.log_odds, theirs.log_odds)
    figures = json.loads((tmp_path / "metrics.json").read_text())
    assert figures["scans"]["used"] == saved.scans
    assert "realtime_factor" not in figures


def test_a_save_sets_an_earlier_program_aside_and_replaces_its_own(drive: list[Item], tmp_path: Path):
    """Once, at the first save: until then the earlier map is where it was; the log says where it went."""
    (tmp_path / "map.npz").write_text("earlier")
    (tmp_path / "report.html").write_text("earlier")
    with running(MemoryRecording(drive), autoplay=False, out=tmp_path) as engine:
        until(engine, state("paused"))
        after(engine, Save())
        assert {path.name for path in tmp_path.iterdir()} == {"map.npz", "report.html"}
        after(engine, Seek(drive[0].stamp_ns + 2 * 10**9))
        engine.send(Save())
        told = until(engine, lambda now: now.log[-1].text.startswith("Saved"))
        assert "an earlier run are now in" in told.log[-1].text
        engine.send(Save())
        again = until(engine, lambda now: len(now.log) > len(told.log))
        assert "an earlier run" not in again.log[-1].text
    assert {path.name for path in tmp_path.iterdir()} == FILES | {"earlier"}
    (place,) = (tmp_path / "earlier").iterdir()
    assert {path.name for path in place.iterdir()} == {"map.npz", "report.html"}


def test_save_without_a_folder_or_a_scan_says_so(drive: list[Item], tmp_path: Path):
    """A warning in the log with the remedy, no file, and the run goes on."""
    with running(MemoryRecording(drive), autoplay=False) as engine:
        assert not until(engine, state("paused")).saves
        refused = after(engine, Save())
    assert (refused.log[-1].level, refused.playback.state) == ("warning", "paused")
    assert "--out DIR" in refused.log[-1].text
    with running(MemoryRecording(drive), autoplay=False, out=tmp_path) as engine:
        until(engine, state("paused"))
        refused = after(engine, Save())
    assert "no scan has been used yet" in refused.log[-1].text
    assert not any(tmp_path.iterdir())


def test_the_run_goes_on_while_its_results_are_saved(
    drive: list[Item], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """What is saved is the moment of the button; a second one is told to wait; the end waits for the first."""
    begun, go_on = threading.Event(), threading.Event()

    def slow(run: Run, folder: Path) -> list[Path]:
        begun.set()
        assert go_on.wait(PATIENCE_S)
        return write(run, folder)

    monkeypatch.setattr("hectorscope.exporters.write", slow)
    with running(MemoryRecording(drive), autoplay=False, speed=math.inf, out=tmp_path) as engine:
        until(engine, state("paused"))
        there = after(engine, Seek(drive[0].stamp_ns + 2 * 10**9))
        after(engine, Save())
        assert begun.wait(PATIENCE_S)
        engine.send(Play())
        ended = until(engine, state("ended"))
        assert ended.scans > there.scans
        assert "being saved already" in after(engine, Save()).log[-1].text
        assert not any(tmp_path.iterdir())
        go_on.set()
        until(engine, lambda now: now.log[-1].text.startswith("Saved"))
    rows = np.loadtxt(tmp_path / "trajectory.tum")
    assert len(rows) == there.scans
    levels = load_map(tmp_path, START.start.map).levels
    pipeline, _ = run_headless(MemoryRecording([i for i in drive if i.stamp_ns <= there.playback.time_ns]), START)
    for ours, theirs in zip(levels, saved_levels(pipeline.slam.map), strict=True):
        np.testing.assert_array_equal(ours.log_odds, theirs.log_odds)


def test_a_save_that_ends_in_an_error_is_answered(
    drive: list[Item], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """Whatever it is: the log has it, and one may try again."""

    def full(*_: object) -> list[Path]:
        raise MemoryError("no room for the map")

    monkeypatch.setattr("hectorscope.exporters.write", full)
    with running(MemoryRecording(drive), speed=math.inf, out=tmp_path) as engine:
        until(engine, state("ended"))
        for _ in range(2):
            saved = saved_by(engine)
            assert saved.log[-1].text == "Saving failed: MemoryError: no room for the map"
            assert saved.log[-1].level == "warning"


def test_a_folder_that_went_away_does_not_stop_the_run(drive: list[Item], tmp_path: Path):
    """The reason is a warning in the log."""
    with running(MemoryRecording(drive), speed=math.inf, out=tmp_path / "gone") as engine:
        until(engine, state("ended"))
        refused = saved_by(engine)
    assert "gone cannot be written to" in refused.log[-1].text
    assert refused.playback.state == "ended"


def test_a_file_that_cannot_be_written_costs_no_other(drive: list[Item], tmp_path: Path):
    """A folder in the way of one, no plain value in another: both are told, the rest is there."""
    pipeline, effort = run_headless(MemoryRecording(drive), START)
    (tmp_path / "map.npz").mkdir()
    figures = {**metrics(pipeline, SourceReport(), effort), "no": object()}
    with pytest.raises(OutputError) as told:
        export(pipeline, figures, tmp_path)
    assert "(Is a directory: map.npz; TypeError: " in str(told.value)
    assert str(told.value).endswith(": metrics.json): give another --out")
    assert {path.name for path in tmp_path.iterdir()} == FILES - {"metrics.json"}


@pytest.mark.parametrize("ending", ENDING)
def test_the_end_of_the_program_saves(
    ending: signal.Signals, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
):
    """Ctrl-C, a stopped service or a lost terminal, even twice: `view --out` leaves all and prints where."""
    bag, out = tmp_path / "short.bag", tmp_path / "out"
    simulate(SimulateOptions(out=bag, scenario="rooms", duration=3.0, beams=91))
    stop = Engine.stop

    def serve(served: PageServer, up: Callable[[], None]) -> None:
        up()
        until(served.driver, state("ended"))
        signal.raise_signal(ending)

    def stop_and_be_asked_again(engine: Engine) -> None:
        signal.raise_signal(ending)
        stop(engine)

    monkeypatch.setattr("hectorscope.cli.page.serve", serve)
    monkeypatch.setattr(Engine, "stop", stop_and_be_asked_again)
    assert main(["view", str(bag), "--out", str(out), "--map.size", "512"]) == 130
    assert {path.name for path in out.iterdir()} == FILES
    assert str(out) in capsys.readouterr().out


@pytest.mark.parametrize("ending", ENDING)
@pytest.mark.parametrize("command", ["live", "serve"])
def test_an_end_before_the_first_scan_is_no_mistake(
    command: str, ending: signal.Signals, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    """A robot that is not there: the interruption counts as such, the end says that nothing was saved."""

    def interrupted(*_: object) -> None:
        signal.raise_signal(ending)

    def serve(_: PageServer, up: Callable[[], None]) -> None:
        up()
        interrupted()

    monkeypatch.setattr("hectorscope.cli.page.serve", serve)
    monkeypatch.setattr("hectorscope.cli.node._told", interrupted)
    journal = ["--journal", "off"] if command == "live" else []
    assert main([command, "ws://127.0.0.1:9", "--out", str(tmp_path), *journal]) == 130
    assert "Nothing was saved, as no scan was used" in capsys.readouterr().out
    assert not any(tmp_path.iterdir())


def test_a_page_that_cannot_be_served_says_so_with_out_too(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The port is taken: that is the message, not that there is nothing to save."""
    bag = tmp_path / "short.bag"
    simulate(SimulateOptions(out=bag, scenario="rooms", duration=3.0, beams=91))
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        assert main(["view", str(bag), "--port", str(port), "--out", str(tmp_path / "out")]) == 2
    assert f"port {port} of 127.0.0.1 cannot be had" in capsys.readouterr().err
    assert not list((tmp_path / "out").iterdir())


@pytest.fixture
def short(tmp_path: Path) -> Path:
    """Three simulated seconds."""
    bag = tmp_path / "short.bag"
    simulate(SimulateOptions(out=bag, scenario="rooms", duration=3.0, beams=91))
    return bag


@pytest.fixture
def idle(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing can be processed: whoever begins to fails."""
    monkeypatch.setattr("hectorscope.run.headless.run_headless", lambda *_: pytest.fail("the work was begun"))


@pytest.mark.usefixtures("idle")
def test_a_folder_where_a_file_is_to_be_is_refused_before_any_work(
    short: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The folder is named with the remedy, and left as it is."""
    (tmp_path / "out" / "map.npz").mkdir(parents=True)
    assert main(["run", str(short), "--out", str(tmp_path / "out")]) == 2
    assert "map.npz is a folder where a file is to be: remove it or give another --out" in capsys.readouterr().err
    assert [path.name for path in (tmp_path / "out").rglob("*")] == ["map.npz"]


@pytest.mark.usefixtures("idle")
def test_a_full_disk_is_found_before_any_work(
    short: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A folder that is there but takes no file: the reason and the remedy, and nothing of the try stays."""

    def full(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(tempfile, "NamedTemporaryFile", full)
    assert main(["run", str(short), "--out", str(tmp_path / "out")]) == 2
    assert "out cannot be written to (No space left on device): give another --out" in capsys.readouterr().err
    assert not list((tmp_path / "out").iterdir())


@pytest.mark.usefixtures("idle")
@pytest.mark.skipif(not Path("/proc/self").is_dir(), reason="no folder is known that takes no file")
def test_a_folder_that_takes_no_file_is_refused_before_any_work(
    short: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """It is there, and still of no use."""
    assert main(["run", str(short), "--out", "/proc/self"]) == 2
    assert "/proc/self cannot be written to" in capsys.readouterr().err
