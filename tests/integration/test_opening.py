"""Another recording in the same session: what is shown, what is kept, what is refused."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from hectorscope.inputs import Item, OptionValue, Source, SourceError
from hectorscope.run.fingerprint import identity
from hectorscope.run.headless import run_headless
from hectorscope.run.permalink import Permalink
from hectorscope.run.settings import Settings
from hectorscope.session.commands import (
    Agree,
    Configure,
    Decline,
    Follow,
    Fork,
    ListRecordings,
    Open,
    OpenUploaded,
    Pause,
    Play,
    Restart,
    Seek,
    SetSpeed,
    StepScan,
    Undo,
)
from hectorscope.session.engine import Engine
from hectorscope.session.journal import Journal
from hectorscope.session.library import Library
from hectorscope.session.runs import MOST
from hectorscope.session.station import Station
from hectorscope.session.station_commands import Resume
from tests.engines import START, after, state, until
from tests.live.journals import left
from tests.sources import MemoryRecording, MemoryStream

FAST = float("inf")


class Shelf:
    """A folder of recordings that are in memory; opened: every one, in order."""

    def __init__(self, folder: Path, items: list[Item]) -> None:
        self.folder, self.opened = folder, list[MemoryRecording]()
        self._items = {"long.bag": items, "short.bag": items[: len(items) // 2], "bad.bag": None}
        for name in self._items:
            (folder / name).touch()
        self.library = Library(self.open, [folder])

    def open(self, path: Path, _: Mapping[str, OptionValue]) -> Source:
        """By its name."""
        if (items := self._items.get(path.name, [])) is None:
            raise SourceError(f"{path} is no recording: record it again")
        self.opened.append(MemoryRecording(items))
        self.opened[-1].name = path.name
        return self.opened[-1]

    def key(self, name: str) -> str:
        """Of the recording with this name."""
        return next(each.key for each in self.library.listed if each.name == name)


@pytest.fixture
def shelf(tmp_path: Path, drive: list[Item]) -> Shelf:
    return Shelf(tmp_path, drive)


@contextmanager
def session(shelf: Shelf, source: Source | None = None) -> Iterator[Engine]:
    """An engine that goes as fast as it can."""
    engine = Engine(source, START, speed=FAST)
    engine.offer(shelf.library)
    engine.start()
    try:
        yield engine
    finally:
        engine.stop()


def trajectory(items: list[Item], settings: Settings = START) -> bytes:
    """Of the headless run."""
    return run_headless(MemoryRecording(items), settings)[0].trajectory.tobytes()


def test_nothing_is_open_until_something_is(shelf: Shelf, reference: np.ndarray) -> None:
    """What needs a recording is refused; then one is opened, and gives what it always gives."""
    with session(shelf) as engine:
        begun = until(engine, state("empty"))
        for command in (Play(), StepScan(), Restart(), Seek(0), SetSpeed(FAST)):
            engine.send(command)
        refused = until(engine, lambda now: now.obeyed == engine.sent)
        engine.send(Open(shelf.key("long.bag")))
        ended = until(engine, state("ended"))
    assert [each.name for each in begun.library] == ["bad.bag", "long.bag", "short.bag"]
    assert refused.playback.state == "empty"
    assert [entry.text for entry in refused.log] == ["No recording is open: open one first"] * 3
    assert ended.source == "long.bag"
    assert ended.undo is None
    assert ended.trajectory.tobytes() == reference.tobytes()


def test_another_recording_takes_the_place_of_the_present_one(
    shelf: Shelf, drive: list[Item], reference: np.ndarray
) -> None:
    """With the settings of now, its own log and its own result; an undo brings the first one back and goes on."""
    with session(shelf) as engine:
        engine.send(Open(shelf.key("long.bag")))
        until(engine, lambda now: now.scans > 10)
        paused = after(engine, Pause())
        engine.send(Open(shelf.key("short.bag")))
        engine.send(Play())
        other = until(engine, lambda now: now.source == "short.bag" and now.playback.state == "ended")
        engine.send(Undo())
        back = until(engine, lambda now: now.source == "long.bag" and now.playback.state == "ended")
        kept = [source.closed for source in shelf.opened]
    assert other.trajectory.tobytes() == trajectory(drive[: len(drive) // 2])
    assert other.undo is not None and other.undo.what == "opening short.bag"
    assert other.epoch > paused.epoch
    assert all(entry.text.startswith("The recording ended") or "memory" in entry.text for entry in other.log)
    assert back.trajectory.tobytes() == reference.tobytes()
    assert set(paused.log) <= set(back.log)
    assert kept == [False, True]
    assert all(source.closed for source in shelf.opened)


def test_changed_settings_go_along(shelf: Shelf, drive: list[Item]) -> None:
    """They hold from the start of the next recording; changes over time belong to the last one."""
    with session(shelf) as engine:
        engine.send(Open(shelf.key("long.bag")))
        until(engine, lambda now: now.scans > 10)
        engine.send(Configure("matcher.iterations_fine", 3))
        engine.send(Open(shelf.key("short.bag")))
        ended = until(engine, lambda now: now.source == "short.bag" and now.playback.state == "ended")
    changed = Settings(START.changed_all(None, {"matcher.iterations_fine": 3}).start)
    assert ended.config == changed.start
    assert ended.trajectory.tobytes() == trajectory(drive[: len(drive) // 2], changed)


def test_a_recording_that_cannot_be_read_changes_nothing(shelf: Shelf) -> None:
    """Nor does a key of nobody: the reason is an answer in the log, and the run is as it was."""
    with session(shelf) as engine:
        engine.send(Open(shelf.key("long.bag")))
        before = until(engine, state("ended"))
        refused = after(engine, Open(shelf.key("bad.bag")), Open("../long.bag"))
    answers = [entry.text for entry in refused.log if entry.answer]
    assert answers == [
        "bad.bag is no recording: record it again",
        "This recording is not in the list: open the list again",
    ]
    assert (refused.epoch, refused.source, refused.scans) == (before.epoch, before.source, before.scans)


def test_a_recording_that_finds_no_place_in_the_list_of_runs_is_closed(shelf: Shelf) -> None:
    """Whether it is opened by hand or by a link; the run is as it was."""
    with session(shelf) as engine:
        engine.send(Open(shelf.key("long.bag")))
        until(engine, state("ended"))
        after(engine, *[Fork() for _ in range(MOST - 1)])
        (shelf.folder / "short.bag").write_text("another content")
        link = Permalink(identity(shelf.folder / "short.bag"), 0, START)
        refused = after(engine, Open(shelf.key("short.bag")), Follow(link))
        closed = [source.closed for source in shelf.opened]
    answers = [entry.text for entry in refused.log if entry.answer]
    assert answers == [f"There are {MOST} runs already: remove one"] * 2
    assert refused.source == "long.bag"
    assert closed == [False, True, True]


def test_an_uploaded_recording_is_opened_under_its_label(shelf: Shelf, tmp_path: Path) -> None:
    """And stays in the list."""
    path = tmp_path / "0.bag"
    path.touch()
    shelf._items["0.bag"] = shelf._items["long.bag"]
    with session(shelf) as engine:
        engine.send(OpenUploaded(path, "kitchen.bag"))
        ended = until(engine, state("ended"))
    assert ended.source == "kitchen.bag"
    assert "kitchen.bag" in [each.name for each in ended.library]


def test_the_list_is_made_anew_on_demand(shelf: Shelf) -> None:
    """A recording that was put into the folder meanwhile."""
    with session(shelf) as engine:
        until(engine, state("empty"))
        (shelf.folder / "new.bag").touch()
        engine.send(ListRecordings())
        listed = until(engine, lambda now: now.obeyed == 1).library
    assert "new.bag" in [each.name for each in listed]


def test_a_stream_asks_before_it_is_left(shelf: Shelf, drive: list[Item]) -> None:
    """Its map would be lost: without a yes it stays; after a yes it is kept for a minute, and comes back."""
    stream = MemoryStream()
    with session(shelf, stream) as engine:
        stream.send(drive[: len(drive) // 4])
        before = until(engine, lambda now: now.scans > 3)
        engine.send(Open(shelf.key("short.bag")))
        asked = until(engine, lambda now: now.question).question
        assert asked is not None and "To open a recording is to leave the stream" in asked.text
        engine.send(Decline(asked.number))
        declined = until(engine, lambda now: now.obeyed == engine.sent and not now.question)
        engine.send(Open(shelf.key("short.bag")))
        asked = until(engine, lambda now: now.question).question
        assert asked is not None
        engine.send(Agree(asked.number))
        opened = until(engine, lambda now: now.source == "short.bag" and now.playback.state == "ended")
        engine.send(Undo())
        back = until(engine, lambda now: now.source == "stream")
        stream.send(drive[len(drive) // 4 : len(drive) // 2])
        until(engine, lambda now: now.scans > back.scans)
    assert declined.source == "stream"
    assert not opened.playback.live
    assert back.playback.live
    assert back.trajectory[: before.scans].tobytes() == before.trajectory.tobytes()


def test_only_results_of_the_stream_are_published(shelf: Shelf, drive: list[Item]) -> None:
    """An observer gets none of a recording that is opened meanwhile, and those of the stream again later."""
    stream, observed, quarter = MemoryStream(), list[int](), len(drive) // 4
    engine = Engine(stream, START, speed=FAST)
    engine.offer(shelf.library)
    engine.observe(lambda _, result: observed.append(result.stamp_ns))
    engine.start()
    try:
        stream.send(drive[:quarter])
        until(engine, lambda now: now.scans > 3)
        engine.send(Open(shelf.key("short.bag")))
        asked = until(engine, lambda now: now.question).question
        assert asked is not None
        engine.send(Agree(asked.number))
        until(engine, lambda now: now.source == "short.bag" and now.playback.state == "ended")
        assert max(observed) <= drive[quarter].stamp_ns
        engine.send(Undo())
        until(engine, lambda now: now.source == "stream")
        stream.send(drive[quarter : 2 * quarter])
        until(engine, lambda _: max(observed) > drive[quarter].stamp_ns)
    finally:
        engine.stop()
    assert observed == sorted(set(observed))


def test_the_run_before_is_not_put_onto_a_recording(shelf: Shelf, tmp_path: Path, reference: np.ndarray) -> None:
    """The question is withdrawn once a recording is shown, and a command that comes late is refused."""
    root = tmp_path / "journals"
    root.mkdir()
    left(root, "20200101T000000Z-1")
    engine = Engine(MemoryStream(), START, speed=FAST)
    engine.offer(shelf.library)
    engine.attach(Station(journal=Journal(root, "a", lambda _: MemoryRecording(shelf._items["short.bag"] or []))))
    engine.start()
    try:
        asked = until(engine, lambda now: now.question)
        engine.send(Open(shelf.key("long.bag")))
        opened = until(engine, state("ended"))
        refused = after(engine, Resume())
    finally:
        engine.stop()
    assert asked.station.past
    assert opened.question is None
    assert not opened.station.past
    assert refused.log[-1].text == "Only a stream can go on with the run before: go back to it first"
    assert refused.trajectory.tobytes() == reference.tobytes()
