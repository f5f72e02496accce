"""A recording is examined beside its run."""

import threading
from pathlib import Path

import pytest

from hectorscope.inputs import Finding, SourceOptions
from hectorscope.session.commands import Examine
from hectorscope.sources import open_source
from tests.bags import messages_for, small_run
from tests.engines import PATIENCE_S, running, until
from tests.ros_messages import SECOND, write_bag
from tests.sources import MemoryStream

GAP = range(20, 30)


def test_the_run_goes_on_while_the_recording_is_examined(tmp_path: Path) -> None:
    """The findings come with the time of the run at which they begin; the log says how many there are."""
    entries = [entry for entry in small_run(messages_for("run.bag")) if entry[2] // (SECOND // 10) not in GAP]
    source = open_source(str(write_bag(tmp_path / "run.bag", entries)), SourceOptions())
    with running(source, speed=float("inf")) as engine:
        engine.send(Examine())
        snapshot = until(engine, lambda now: now.examined is not None and now.playback.state == "ended", 60.0)
        said = until(engine, lambda now: any("Examined the whole" in entry.text for entry in now.log))
    assert snapshot.examined is not None
    gaps = [found for found in snapshot.examined if "/scan has a gap of 1.10 s" in found.fact]
    assert [found.time_ns for found in gaps] == [snapshot.playback.start_ns + 19 * SECOND // 10]
    assert not [entry for entry in said.log if entry.level == "error"]


def test_a_second_examination_is_told_to_wait(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever recording it is asked of: there is one at a time, and the first one ends as it would."""
    begun, go_on = threading.Event(), threading.Event()

    def slow(_: object) -> list[Finding]:
        begun.set()
        assert go_on.wait(PATIENCE_S)
        return []

    monkeypatch.setattr("hectorscope.session.examiner.examine", slow)
    source = open_source(str(write_bag(tmp_path / "run.bag", small_run(messages_for("run.bag")))), SourceOptions())
    with running(source, speed=float("inf")) as engine:
        engine.send(Examine())
        assert begun.wait(PATIENCE_S)
        engine.send(Examine())
        until(engine, lambda now: any("A recording is being examined already" in each.text for each in now.log))
        go_on.set()
        until(engine, lambda now: now.examined == ())


def test_a_stream_cannot_be_examined() -> None:
    """It says so, and the run goes on."""
    with running(MemoryStream()) as engine:
        engine.send(Examine())
        snapshot = until(engine, lambda now: any("can be examined" in entry.text for entry in now.log))
    assert snapshot.examined is None
