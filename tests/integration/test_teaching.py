"""What lessons, the comparison with the paper and a driven robot ask of the engine."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from hectorscope.cli.opening import demos as shipped
from hectorscope.inputs import SourceOptions
from hectorscope.page.lessons import lessons_in
from hectorscope.panels.lessons import facts
from hectorscope.run.settings import Settings
from hectorscope.session.commands import ComparePaper, Drive, SetUp
from hectorscope.session.engine import Engine
from hectorscope.session.library import Library
from hectorscope.simulation import SimulateOptions, simulate
from hectorscope.simulation.drive_source import DriveSource
from hectorscope.sources import open_source
from hectorscope.steering import PutBox, Steer
from slam_core.config import SlamConfig, preset, with_value
from tests.conftest import ROOT
from tests.engines import START, after, running, until

PATIENCE_S = 60.0
ONE_LEVEL = Settings(with_value(START.start, "map.levels", 1))


@pytest.fixture(scope="module")
def demos(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """A short recording in the place of one that comes with the program."""
    path = tmp_path_factory.mktemp("demos") / "arena.bag"
    simulate(SimulateOptions(scenario="rooms", out=path, duration=6.0, scan_rate=10.0, beams=181))
    return {"arena": path}


@pytest.fixture
def school(demos: dict[str, Path]) -> Iterator[Engine]:
    """An engine that has nothing open, and can open the recordings of lessons."""
    engine = Engine(None, START, speed=float("inf"))
    engine.offer(Library(lambda path, _: open_source(str(path), SourceOptions()), demos=demos))
    engine.start()
    yield engine
    engine.stop()


def second(now) -> float:
    """Of the recording, at which it stands."""
    return (now.playback.time_ns - now.playback.start_ns) / 1e9


def test_a_lesson_opens_its_recording_at_its_time_with_its_settings(school: Engine):
    """And it rests there, in a run that has the title of the lesson."""
    now = after(school, SetUp("arena", 4_000_000_000, ONE_LEVEL, "One level"))
    assert second(now) == pytest.approx(4.0, abs=0.2)
    assert now.config == ONE_LEVEL.start
    assert [run.name for run in now.runs] == ["One level"]


def test_the_next_lesson_leaves_the_run_of_the_one_before(school: Engine):
    """It is in the list, and only the settings of the next lesson hold."""
    after(school, SetUp("arena", 4_000_000_000, ONE_LEVEL, "One level"))
    now = after(school, SetUp("arena", 3_000_000_000, START, "Three levels"))
    assert second(now) == pytest.approx(3.0, abs=0.2)
    assert now.config == START.start
    assert [run.name for run in now.runs] == ["One level", "Three levels"]


def test_a_recording_that_is_not_there_is_named(school: Engine):
    """Nothing else is changed."""
    school.send(SetUp("moon", 0, START, "Moon"))
    now = until(school, lambda now: now.log and now.obeyed == school.sent)
    assert "The recording moon is not there" in now.log[-1].text
    assert now.playback.state == "empty"


def test_the_paper_is_compared_at_the_same_time(school: Engine):
    """Its settings are those of the preset; asked again, there is no second run of it."""
    after(school, SetUp("arena", 5_000_000_000, START, "Today"))
    for _ in range(2):
        school.send(ComparePaper())
        now = until(
            school, lambda now: now.obeyed == school.sent and now.compared and now.compared.whole, PATIENCE_S
        )
        assert now.compared.settings.start == preset("paper") == SlamConfig.paper()
        assert [run.name for run in now.runs] == ["Today", "the paper"]
    assert now.config == START.start


def test_a_driven_robot_moves_by_command_and_stops_without_a_word():
    """The engine passes on what is asked, and refuses in the log what cannot be."""
    source = DriveSource("corridor")
    with running(source) as engine:
        until(engine, lambda now: second(now) > 3.0, PATIENCE_S)
        engine.send(Drive(PutBox(0, (0.0, 0.0))))
        now = until(engine, lambda now: any("drive away" in line.text for line in now.log), PATIENCE_S)
        assert now.drive is not None and now.drive.boxes == (None, None)
        engine.send(Drive(Steer(1.0, 0.0)))
        moved = until(engine, lambda now: now.result and now.result.planar[0] > 0.1, PATIENCE_S)
        at = second(moved)
        rests = until(
            engine,
            lambda now: second(now) > at + 1.0 and abs(now.result.navigation.velocity[0]) < 0.05,
            PATIENCE_S,
        )
        assert rests.result.planar[0] < 1.5


def test_a_recording_is_not_driven(school: Engine):
    """The command is ignored, and there is no robot to show."""
    after(school, SetUp("arena", 3_000_000_000, START, "Today"))
    now = after(school, Drive(Steer(1.0, 0.0)))
    assert now.drive is None
    assert now.playback.state == "paused"


def test_a_lesson_asks_before_a_stream_is_left(demos: dict[str, Path]):
    """The map of the driven robot would be lost."""
    engine = Engine(DriveSource("corridor"), START)
    engine.offer(Library(lambda path, _: open_source(str(path), SourceOptions()), demos=demos))
    engine.start()
    try:
        until(engine, lambda now: now.scans > 5, PATIENCE_S)
        engine.send(SetUp("arena", 0, START, "Lesson"))
        now = until(engine, lambda now: now.question, PATIENCE_S)
        assert now.question.text.startswith("A lesson shows a recording")
    finally:
        engine.stop()


@pytest.mark.parametrize(("levels", "holds"), [(3, True), (1, False)])
def test_the_lesson_of_the_pyramid_loses_without_it(levels: int, holds: bool):
    """The same scans from the same poor starts: the coarse levels find the way, the finest alone does not."""
    (lesson,) = (each for each in lessons_in(ROOT / "static" / "lessons") if each.key == "4-pyramid")
    settings = Settings(with_value(lesson.settings.start, "map.levels", levels))
    engine = Engine(None, ahead_after=None, speed=float("inf"))
    engine.offer(Library(lambda path, _: open_source(str(path), SourceOptions()), demos=shipped()))
    engine.start()
    try:
        now = after(engine, SetUp(lesson.demo, lesson.offset_ns, settings, lesson.title))
    finally:
        engine.stop()
    error = facts(now, {})["error"]
    assert (error < 0.1) if holds else (error > 2.0)
