"""What a journal holds of a run when other runs or times were shown, or once its stream has ended."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from hectorscope.inputs import Item
from hectorscope.run.headless import run_headless
from hectorscope.session.checkpoint_file import read_checkpoint
from hectorscope.session.commands import Agree, GoLive, Restart, Seek, Undo
from hectorscope.session.journal import Journal, resumed
from hectorscope.session.station import Station
from hectorscope.session.station_commands import PutMark
from hectorscope.simulation import SceneOptions, Simulation
from tests.engines import START, running, until
from tests.sources import MemoryRecording, MemoryStream
from tests.streams import SECOND, Robot


@pytest.fixture(scope="module")
def drive() -> list[Item]:
    """Twelve seconds with 240 scans."""
    return list(Simulation("rooms", SceneOptions(duration=12.0, scan_rate=20.0, beams=91)).items())


@pytest.fixture
def journal(tmp_path: Path) -> Journal:
    """Of a stream that cannot be recorded: it holds the checkpoints."""
    return Journal(tmp_path, "a", MemoryRecording)  # type: ignore[arg-type]


@pytest.fixture
def robot(drive: list[Item], journal: Journal) -> Iterator[Robot]:
    """A stream with that journal."""
    stream = MemoryStream()
    with running(stream, station=Station(journal=journal)) as engine:
        yield Robot(engine, stream, drive)
        stream.close()


def restart_and_undo(robot: Robot) -> None:
    """Another run has what comes meanwhile."""
    asked = robot.after(Restart()).question
    assert asked is not None
    robot.after(Agree(asked.number))
    robot.drive_on(11.0)


def look_back(robot: Robot) -> None:
    """The run itself goes on meanwhile."""
    robot.after(Seek(robot.start_ns + 5 * SECOND))
    robot.drive_on(8.0)


@pytest.mark.parametrize(
    ("leave", "back"), [(restart_and_undo, Undo()), (look_back, GoLive())], ids=["undo", "look back"]
)
def test_a_checkpoint_behind_a_return_to_the_run_leads_on_to_all_of_it(
    robot: Robot,
    journal: Journal,
    drive: list[Item],
    leave: Callable[[Robot], None],
    back: Undo | GoLive,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """With the messages behind it, it gives the poses of a run that was never left, to the last bit."""
    monkeypatch.setattr("hectorscope.session.journal.WANTED_S", 0.0)
    robot.drive_on(7.0)
    leave(robot)
    until(robot.engine, lambda _: written(journal))
    robot.after(back, PutMark("note", 1.0, 2.0))
    until(robot.engine, lambda _: written(journal))
    again = resumed(journal.folder, lambda _: MemoryRecording(drive), START, None).pipeline
    straight, _ = run_headless(MemoryRecording(drive), START)
    assert again.scans >= straight.scans - 1
    assert again.trajectory[:, 1:].tobytes() == straight.trajectory[: again.scans, 1:].tobytes()


def written(journal: Journal) -> bool:
    """Whether its checkpoint has all that one has to hold."""
    return not (journal.wanted or journal._writer.busy)


def test_marks_that_are_set_once_the_stream_has_ended_are_kept(robot: Robot, journal: Journal) -> None:
    """Also two in a row, which one checkpoint follows."""
    robot.drive_on(6.0)
    robot.stream.close()
    until(robot.engine, lambda now: now.playback.state == "ended")
    robot.after(PutMark("victim", 1.0, 2.0), PutMark("hazard", 3.0, 4.0))
    until(robot.engine, lambda _: written(journal))
    saved = read_checkpoint(journal.folder)
    assert saved is not None
    assert [mark.kind for mark in saved.annotations.marks] == ["victim", "hazard"]
