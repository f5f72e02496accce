"""What an operator does with a stream: marks, the pose by hand, a pause of mapping, the way back."""

import json
import zipfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from hectorscope.inputs import Item, SourceOptions
from hectorscope.session.commands import Configure, Fork, Restart, Save, Seek, ShowRun, Undo
from hectorscope.session.engine import Engine
from hectorscope.session.library import Library
from hectorscope.session.station import Station
from hectorscope.session.station_commands import (
    EditMark,
    PutMark,
    PutPicture,
    Record,
    RemoveMark,
    SetPose,
    ShowReturn,
)
from hectorscope.sources import open_source
from tests.conftest import ROOT
from tests.engines import START, after, running, until
from tests.pictures import picture_bytes
from tests.sources import MemoryRecording, MemoryStream
from tests.streams import Robot


@pytest.fixture(scope="module")
def drive() -> list[Item]:
    """The first 14 seconds of a recording that comes with the program."""
    source = open_source(str(ROOT / "demo_bags" / "arena.bag"), SourceOptions())
    items = []
    for item in source.items():
        items.append(item)
        if item.stamp_ns - items[0].stamp_ns > 14e9:
            break
    source.close()
    return items


@pytest.fixture
def robot(drive: list[Item], tmp_path: Path) -> Iterator[Robot]:
    """A stream whose results can be saved."""
    stream = MemoryStream()
    (tmp_path / "out").mkdir()
    with running(stream, out=tmp_path / "out") as engine:  # type: ignore[arg-type]
        yield Robot(engine, stream, drive)
        stream.close()


def test_marks_are_kept_edited_and_taken_back(robot: Robot, tmp_path: Path) -> None:
    """With number, time, pose and text; undo brings each change back; they are saved with the figures."""
    robot.drive_on(6.0)
    put = robot.after(PutMark("victim", 1.0, 2.0, "two people"), PutMark("hazard", 3.0, 4.0))
    first, second = put.station.annotations
    assert (first.number, first.kind, first.text, first.x, first.y) == (1, "victim", "two people", 1.0, 2.0)
    assert put.result is not None
    assert np.allclose(first.pose, put.result.fused.mean, atol=0.1)  # a scan may have come since
    assert 0 < first.time_ns <= put.playback.time_ns
    gone = robot.after(EditMark(1, "note", "gone"), RemoveMark(2))
    assert [(mark.number, mark.kind) for mark in gone.station.annotations] == [(1, "note")]
    assert robot.after(Undo()).station.annotations[1] == second
    assert robot.after(Undo()).station.annotations == (first, second)
    robot.after(Save())
    robot.until(lambda now: any(entry.text.startswith("Saved") for entry in now.log))
    figures = json.loads((tmp_path / "out" / "metrics.json").read_text(encoding="utf-8"))
    assert [(mark["number"], mark["kind"], mark["text"]) for mark in figures["marks"]] == [
        (1, "victim", "two people"),
        (2, "hazard", ""),
    ]


def test_a_mark_with_a_picture_comes_back_by_undo(robot: Robot, tmp_path: Path) -> None:
    """What is no picture is refused with the reason; a removed mark has its picture again; both are saved."""
    robot.drive_on(4.0)
    refused = robot.after(PutMark("victim", 1.0, 2.0), PutPicture(1, b"/etc/passwd"))
    assert "cannot be read as a picture" in refused.log[-1].text
    assert refused.station.annotations[0].picture is None
    shown = robot.after(PutPicture(1, picture_bytes())).station.annotations
    assert shown[0].picture is not None
    assert robot.after(RemoveMark(1)).station.annotations == ()
    assert robot.after(Undo()).station.annotations == shown
    robot.after(Save())
    robot.until(lambda now: any(entry.text.startswith("Saved") for entry in now.log))
    with zipfile.ZipFile(tmp_path / "out" / "pictures.zip") as archive:
        assert archive.read("mark_1.jpg") == shown[0].picture.content
    figures = json.loads((tmp_path / "out" / "metrics.json").read_text(encoding="utf-8"))
    assert figures["marks"][0]["picture"] == "mark_1.jpg"


def test_a_mark_that_cannot_be_is_refused(robot: Robot) -> None:
    """The page is told why, and nothing changes."""
    assert "wait for the first scan" in robot.after(PutMark("note", 0.0, 0.0)).log[-1].text
    robot.drive_on(4.0)
    now = robot.after(RemoveMark(7))
    assert "no mark 7" in now.log[-1].text
    assert now.log[-1].answer


def test_while_mapping_is_paused_the_map_stays(robot: Robot) -> None:
    """The pose is followed, and the map goes on growing afterwards."""
    robot.drive_on(6.0)
    before = robot.after(Configure("map.update", value=False))
    paused = robot.drive_on(9.0)
    assert paused.map_updates == before.map_updates
    assert paused.scans > before.scans + 20
    assert paused.result is not None
    assert paused.result.tracking == "tracking"
    robot.after(Configure("map.update", value=True))
    assert robot.drive_on(12.0).map_updates > paused.map_updates


def test_the_pose_is_set_by_hand(robot: Robot) -> None:
    """A pose beside the true one is matched back to it; one far away is where the run goes on."""
    robot.drive_on(8.0)
    before = robot.after(Configure("map.update", value=False)).result
    assert before is not None
    x, y, yaw = before.fused.mean.tolist()
    near = robot.after(SetPose(x + 0.15, y - 0.1, yaw + 0.05))
    assert "pose was set" in near.log[-1].text
    result = robot.drive_on(8.3).result
    assert result is not None
    assert np.hypot(*(result.fused.mean[:2] - before.fused.mean[:2])) < 0.6
    assert result.tracking in ("tracking", "recovered")
    robot.after(SetPose(x + 40.0, y, yaw), Configure("tracking.relocalise", value=False))
    far = robot.drive_on(8.6).result
    assert far is not None
    assert far.fused.mean[0] > x + 20.0


def test_the_way_back_leads_to_the_start(robot: Robot) -> None:
    """From where the robot is to where it began; it is hidden again by the same switch."""
    robot.drive_on(10.0)
    robot.after(ShowReturn(on=True))
    now = robot.until(lambda now: now.station.way_back is not None)
    way = now.station.way_back
    assert way is not None
    assert np.allclose(way[-1], now.trajectory[0, 1:3])
    assert np.allclose(way[0], now.trajectory[-1, 1:3], atol=0.5)
    assert robot.after(ShowReturn(on=False)).station.way_back is None


def test_marks_stay_with_a_recording(drive: list[Item]) -> None:
    """When another setting runs it again, when it is restarted, and when another run of it is shown."""
    with running(MemoryRecording(drive), autoplay=False) as engine:
        after(engine, Seek(drive[0].stamp_ns + 6 * 10**9))
        (mark,) = after(engine, PutMark("victim", 1.0, 2.0)).station.annotations
        assert after(engine, Configure("map.resolution", 0.1)).station.annotations == (mark,)
        assert after(engine, Restart()).station.annotations == (mark,)
        forked = after(engine, Fork("b"))
        assert forked.station.annotations == (mark,)


def test_a_removed_mark_comes_back_to_another_run_of_the_recording(drive: list[Item], tmp_path: Path) -> None:
    """Marks belong to the recording: the run that is shown by then has it again."""
    path = tmp_path / "arena.bag"
    path.write_text("for its identity")
    library = Library(lambda *_: MemoryRecording(drive), [tmp_path])
    engine = Engine(MemoryRecording(drive), START, autoplay=False)
    library.shown = path
    engine.offer(library)
    engine.start()
    try:
        after(engine, Seek(drive[0].stamp_ns + 6 * 10**9))
        forked = after(engine, PutMark("victim", 1.0, 2.0), Fork("b"), RemoveMark(1))
        shown = after(engine, ShowRun(forked.runs[0].number))
        back = after(engine, Undo())
    finally:
        engine.stop()
    assert forked.station.annotations == shown.station.annotations == ()
    assert [mark.kind for mark in back.station.annotations] == ["victim"]


def test_a_stream_that_cannot_be_heard_is_not_said_to_be_recorded(tmp_path: Path) -> None:
    """The page is told why, and the switch stays off."""
    stream = MemoryStream()
    with running(stream, station=Station(tmp_path)) as engine:  # type: ignore[arg-type]
        engine.send(Record(on=False))
        engine.send(Record(on=True))
        now = until(engine, lambda now: now.obeyed == 2)
        stream.close()
    assert "Only a stream can be recorded" in now.log[-1].text
    assert now.station.records is False
