"""Runs by name: forked, shown again, compared, renamed, removed and kept; each is what a straight run would be."""

import random
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import pytest

from hectorscope.inputs import Item, OptionValue, Source
from hectorscope.run.map_difference import share_that_differs
from hectorscope.run.map_images import map_images
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.run_file import FILE
from hectorscope.run.settings import Settings
from hectorscope.session.commands import (
    ComparePaper,
    CompareRun,
    Configure,
    Fork,
    KeepRun,
    ListRecordings,
    Open,
    Pause,
    RemoveRun,
    RenameRun,
    Seek,
    ShowRun,
    Undo,
)
from hectorscope.session.engine import Engine
from hectorscope.session.kept_runs import KeptRuns
from hectorscope.session.library import Library
from hectorscope.session.snapshot import Snapshot
from hectorscope.session.station_commands import PutMark
from slam_core.measurements import LaserScan
from tests.cases import quick_first
from tests.engines import START, after, state, until
from tests.sources import MemoryRecording, MemoryStream

SECOND = 1_000_000_000


class Shelf:
    """Two recordings in memory, each behind a file of its own, and a folder for runs."""

    def __init__(self, folder: Path, drive: list[Item]) -> None:
        self.drive, self.bags, self.runs = drive, folder / "bags", folder / "runs"
        self.bags.mkdir()
        self.items = {"long.bag": drive, "short.bag": drive[: 2 * len(drive) // 3]}
        for name in self.items:
            (self.bags / name).write_text(name)

    def open(self, path: Path, _: Mapping[str, OptionValue]) -> Source:
        """By its name."""
        source = MemoryRecording(self.items[path.name])
        source.name = path.name
        return source

    @contextmanager
    def session(self, name: str = "long.bag") -> Iterator[Engine]:
        """A session with a library of its own, paused at the beginning; nothing is open without a name."""
        library = Library(self.open, [self.bags], kept=KeptRuns(self.runs))
        path = self.bags / name if name else None
        source = self.open(path, {}) if path else None
        engine = Engine(source, START, autoplay=False)
        library.shown = path
        engine.offer(library)
        engine.start()
        try:
            yield engine
        finally:
            engine.stop()

    def at(self, seconds: float) -> Seek:
        """A jump there."""
        return Seek(self.drive[0].stamp_ns + round(seconds * SECOND))

    def check(self, shown: Snapshot, settings: Settings) -> None:
        """Rows and every level are those of a straight run up to as many scans."""
        expected = straight(self.items[shown.source], settings, shown.scans)
        assert shown.ahead.settings == settings
        assert shown.playback.time_ns == expected.time_ns
        assert shown.trajectory.tobytes() == expected.trajectory.tobytes()
        pictures = [image.cells.tobytes() for image in map_images(expected.slam.map)]
        assert [image.cells.tobytes() for image in shown.maps] == pictures


def straight(items: list[Item], settings: Settings, scans: int) -> Pipeline:
    """A run from the beginning up to so many results."""
    pipeline = Pipeline(settings, min(item.stamp_ns for item in items))
    for item in items:
        for measurement in pipeline.admit(item):
            if pipeline.scans == scans and isinstance(measurement, LaserScan):
                return pipeline
            pipeline.step(measurement)
    for measurement in pipeline.flush():
        pipeline.step(measurement)
    return pipeline


@pytest.fixture
def shelf(tmp_path: Path, drive: list[Item]) -> Shelf:
    return Shelf(tmp_path, drive)


def names(shown: Snapshot) -> list[str]:
    return [run.name for run in shown.runs]


def changed(shown: Snapshot, settings: Settings, value: float) -> tuple[Configure, Settings]:
    """A change at the scan that is shown, and the settings with it."""
    return Configure("fusion.omega", value), settings.changed(shown.playback.time_ns, "fusion.omega", value)


def test_a_fork_leaves_the_original_as_it_was(shelf: Shelf) -> None:
    """Settings that change after it are of the new run; both are shown in turn, each as a straight run is."""
    with shelf.session() as engine:
        begun = after(engine, shelf.at(2.0))
        forked = after(engine, Fork("with another omega"))
        command, other = changed(forked, START, 0.2)
        after(engine, command)
        later = after(engine, shelf.at(3.5))
        first = after(engine, ShowRun(begun.shown_run))
        back = after(engine, ShowRun(forked.shown_run))
    assert names(later) == ["run 1", "with another omega"]
    shelf.check(later, other)
    shelf.check(first, START)
    assert first.playback.time_ns == forked.playback.time_ns
    shelf.check(back, other)
    assert back.trajectory.tobytes() == later.trajectory.tobytes()


@pytest.mark.parametrize("seed", quick_first(range(3)))
def test_seeks_with_forks_give_the_bytes_of_a_straight_run(shelf: Shelf, seed: int) -> None:
    """At random instants: jumps, forks, changes of settings, and changes of the run that is shown."""
    chance, known, now = random.Random(seed), {1: START}, 1
    with shelf.session() as engine:
        for turn in range(14):
            shown = after(engine, shelf.at(chance.uniform(1.0, 3.8)))
            if turn % 4 == 1:
                now = after(engine, Fork()).shown_run
                known[now] = shown.ahead.settings
            if turn % 3 == 2:
                command, known[now] = changed(shown, known[now], round(chance.uniform(0.1, 0.9), 6))
                shown = after(engine, command)
            if turn % 5 == 4:
                now = chance.choice(sorted(known))
                shown = after(engine, ShowRun(now), shelf.at(chance.uniform(1.0, 3.8)))
            shelf.check(shown, known[now])


def test_the_compared_run_is_at_the_time_of_the_shown_one(shelf: Shelf) -> None:
    """After jumps both ways its rows and its finest level are those of a straight run of its own settings."""
    with shelf.session() as engine:
        begun = after(engine, shelf.at(1.5))
        forked = after(engine, Fork())
        command, other = changed(forked, START, 0.2)
        after(engine, command, CompareRun(begun.shown_run))
        for seconds in (3.0, 1.2, 3.6, 0.9):
            engine.send(shelf.at(seconds))
            shown = until(engine, lambda now: now.obeyed == engine.sent and is_compared(now))
            assert shown.compared is not None and shown.compared.map is not None
            expected = straight(shelf.drive, START, shown.scans)
            assert shown.compared.trajectory.tobytes() == expected.trajectory.tobytes()
            assert shown.compared.map.cells.tobytes() == map_images(expected.slam.map)[0].cells.tobytes()
            when, share = shown.compared.map_apart[-1]
            assert when == shown.trajectory[-1, 0]
            assert share == share_that_differs(shown.maps[0], shown.compared.map)
            assert share == 0.0 or shown.playback.time_ns >= forked.playback.time_ns
            shelf.check(
                shown, other if shown.playback.time_ns >= forked.playback.time_ns else shown.ahead.settings
            )
        ended = after(engine, CompareRun(0))
    assert ended.compared is None


def is_compared(shown: Snapshot) -> bool:
    """Whether the compared run has come to the shown time, and nothing moves."""
    rests, compared = shown.playback.state == "paused", shown.compared
    return rests and compared is not None and compared.whole and len(compared.trajectory) == shown.scans


def test_runs_are_renamed_and_removed_and_a_removal_is_undone(shelf: Shelf) -> None:
    """A name that is taken or empty, and the run that is shown, are refused in words."""
    with shelf.session() as engine:
        after(engine, shelf.at(1.0), Fork(), RenameRun(1, "  the <first>\n one "))
        refused = after(engine, RenameRun(2, "the <first> one"), RenameRun(2, " "), RemoveRun(2), ShowRun(99))
        removed = after(engine, RemoveRun(1))
        back = after(engine, Undo())
    assert [entry.text for entry in refused.log if entry.answer] == [
        "There is a run the <first> one already: choose another name",
        "A run needs a name: give a letter at least",
        "The run that is shown cannot be removed: show another one first",
        "This run is no longer there",
    ]
    assert names(refused) == names(back) == ["the <first> one", "run 2"]
    assert names(removed) == ["run 2"]
    assert removed.undo is not None and removed.undo.what == "removing the <first> one"


def test_runs_of_several_recordings_are_shown_in_turn(shelf: Shelf) -> None:
    """The list is the session's: a run of another recording opens that."""
    with shelf.session() as engine:
        first = after(engine, shelf.at(2.0))
        key = next(each.key for each in first.library if each.name == "short.bag")
        after(engine, Open(key), Pause())
        other = after(engine, shelf.at(1.0))
        back = after(engine, ShowRun(1))
    assert other.source == "short.bag"
    assert [(run.name, run.source) for run in back.runs] == [("run 1", "long.bag"), ("run 2", "short.bag")]
    assert back.trajectory.tobytes() == first.trajectory.tobytes()


def test_the_paper_has_one_run_of_each_recording(shelf: Shelf) -> None:
    """However often it is compared with; before the first scan that is refused, and no run is made."""
    with shelf.session() as engine:
        refused = after(engine, ComparePaper())
        after(engine, shelf.at(1.0))
        after(engine, ComparePaper())
        key = next(each.key for each in refused.library if each.name == "short.bag")
        after(engine, Open(key), Pause())
        after(engine, shelf.at(1.0))
        shown = after(engine, ComparePaper(), ComparePaper())
    assert "cannot be compared" in refused.log[-1].text
    assert names(refused) == ["run 1"]
    assert names(shown) == ["run 1", "the paper", "run 3", "the paper (2)"]
    assert shown.compared is not None and shown.compared.number == 4


def test_a_kept_run_is_opened_again_to_the_same_bytes(shelf: Shelf) -> None:
    """By another program: its RUN.toml has recording, settings with changes, time, marks, and what came out."""
    with shelf.session() as engine:
        shown = after(engine, shelf.at(1.5))
        command, settings = changed(shown, START, 0.2)
        after(engine, command, RenameRun(1, "../../Kitchen, again"))
        after(engine, shelf.at(3.0), PutMark("door", 1.0, 2.0, "the kitchen's"))
        kept = after(engine, KeepRun())
    assert [path.parent.name for path in shelf.runs.glob(f"*/{FILE}")] == ["kitchen-again"]
    with shelf.session(name="") as engine:
        key = next(each.key for each in after_state(engine, "empty").library if each.name == "kitchen-again")
        again = after(engine, Open(key))
    shelf.check(again, settings)
    assert again.trajectory.tobytes() == kept.trajectory.tobytes()
    assert [run.name for run in again.runs if run.number == again.shown_run] == ["../../Kitchen, again"]
    assert any("the same trajectory to the byte" in entry.text for entry in again.log)
    assert [mark.text for mark in again.station.annotations] == ["the kitchen's"]
    assert again.station.annotations == kept.station.annotations


def test_a_kept_run_that_comes_out_otherwise_says_so(shelf: Shelf) -> None:
    """As after another version of the program; a damaged file is refused by its name."""
    with shelf.session() as engine:
        after(engine, shelf.at(1.5))
        after(engine, KeepRun())
        (file,) = shelf.runs.glob(f"*/{FILE}")
        text = file.read_text()
        file.write_text(text.replace("scans = ", "scans = 1"))
        (shelf.runs / "bad").mkdir()
        (shelf.runs / "bad" / FILE).write_text(text.replace("[fusion]", "[fusion"))
        listed = after(engine, ListRecordings()).library
        for name in ("run-1", "bad"):
            engine.send(Open(next(each.key for each in listed if each.name == name)))
        shown = after(engine)
    answers = [entry.text for entry in shown.log if entry.answer]
    assert any("differs from when it was kept" in text for text in answers)
    assert any(text.startswith("bad/RUN.toml is no run (") for text in answers)


def test_a_stream_has_no_runs_to_choose_from(drive: list[Item]) -> None:
    """It cannot be run again: the reason is an answer."""
    stream = MemoryStream()
    engine = Engine(stream, START)
    engine.start()
    try:
        stream.send(drive[: len(drive) // 4])
        until(engine, lambda now: now.scans > 3)
        engine.send(Fork())
        shown = until(engine, lambda now: now.obeyed == engine.sent)
    finally:
        engine.stop()
    assert any(entry.answer and "a stream cannot be run again" in entry.text for entry in shown.log)


def after_state(engine: Engine, word: str) -> Snapshot:
    return until(engine, state(word))
