"""Earlier times of a stream are shown again while its run goes on."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest

from hectorscope.inputs import Item
from hectorscope.run.headless import run_headless
from hectorscope.session.commands import (
    Configure,
    GoLive,
    Pause,
    Play,
    Restart,
    Seek,
    SetSpeed,
    StepBack,
    StepScan,
)
from hectorscope.simulation import SceneOptions, Simulation
from slam_core.measurements import LaserScan
from tests.engines import START, running, until
from tests.sources import MemoryRecording, MemoryStream
from tests.streams import Robot

SECOND = 10**9


@pytest.fixture(scope="module")
def drive() -> list[Item]:
    """Fifteen seconds with three hundred scans."""
    return list(Simulation("rooms", SceneOptions(duration=15.0, scan_rate=20.0, beams=91)).items())


@pytest.fixture(scope="module")
def straight(drive: list[Item]) -> np.ndarray:
    """The trajectory of all of it."""
    return run_headless(MemoryRecording(drive), START)[0].trajectory


@contextmanager
def robot_of(drive: list[Item], **options: float) -> Iterator[Robot]:
    stream = MemoryStream()
    with running(stream, **options) as engine:
        yield Robot(engine, stream, drive)


def test_an_earlier_time_is_shown_as_it_was_while_the_run_goes_on(drive: list[Item], straight: np.ndarray):
    """To the byte, at rest and stepped, while new scans come; back at now nothing is missing."""
    with robot_of(drive) as robot:
        robot.drive_on(10.0)
        there = robot.after(Seek(robot.start_ns + 6 * SECOND))
        assert there.playback.state == "paused"
        assert there.playback.time_ns - robot.start_ns == pytest.approx(6 * SECOND, abs=SECOND // 10)
        assert there.playback.lag == pytest.approx(4.0, abs=0.2)
        assert "behind by 4 s" in there.playback.detail
        assert there.trajectory.tobytes() == straight[: there.scans].tobytes()
        on = robot.drive_on(13.0)
        assert on.scans == there.scans
        assert on.playback.lag == pytest.approx(7.0, abs=0.2)
        assert len(on.ahead.series) > there.scans + 100
        for command, more in ((StepScan(), 1), (StepScan(), 2), (StepBack(), 1)):
            stepped = robot.after(command)
            stepped = robot.until(lambda now, more=more: now.scans == there.scans + more)
            assert stepped.trajectory.tobytes() == straight[: stepped.scans].tobytes()
        now = robot.after(GoLive())
        assert (now.playback.lag, now.playback.state) == (None, "playing")
        ended = robot.drive_on(20.0)
        assert ended.trajectory.tobytes() == straight[: ended.scans].tobytes()
        assert ended.scans >= len(straight) - 1
        assert ended.report.dropped == 0


def test_what_is_played_again_catches_up_with_now(drive: list[Item]):
    """Faster than it came: at its end the run is shown as it is now."""
    with robot_of(drive) as robot:
        robot.drive_on(8.0)
        robot.after(Seek(robot.start_ns + 5 * SECOND), SetSpeed(np.inf))
        robot.engine.send(Play())
        now = robot.until(lambda now: now.playback.lag is None)
        assert now.scans == len(now.ahead.series)


def test_a_time_near_now_is_now_and_times_are_clamped(drive: list[Item]):
    """Nothing older than the first checkpoint can be shown, and nothing that has not come."""
    with robot_of(drive) as robot:
        newest = robot.drive_on(8.0)
        kept = newest.playback.kept_ns
        assert kept is not None
        assert robot.after(Seek(10**20)).playback.lag is None
        first = robot.after(Seek(-5))
        assert first.playback.lag is not None
        assert first.playback.time_ns - kept[0] == pytest.approx(0, abs=SECOND // 10)
        assert robot.after(Seek(kept[1])).playback.lag is None


@pytest.mark.parametrize("command", [Configure("fusion.omega", 0.4), Restart(), Pause()])
def test_what_is_done_to_the_run_is_done_now(drive: list[Item], command: object):
    """A setting acts on the run as it is now, and a restart asks; only a pause is about what is shown."""
    with robot_of(drive) as robot:
        robot.drive_on(8.0)
        robot.after(Seek(robot.start_ns + 5 * SECOND))
        now = robot.after(command)
        assert (now.playback.lag is None) == (command != Pause())
        assert (now.question is not None) == (command == Restart())
        if isinstance(command, Configure):
            assert now.ahead.settings.changes[0].time_ns > robot.start_ns + 7 * SECOND


def test_a_failure_while_an_earlier_time_is_shown_is_told_and_ends_that(drive: list[Item]):
    """What is no measurement is named in the log; the run goes on, and is shown as it is now."""
    with robot_of(drive) as robot:
        robot.drive_on(8.0)
        robot.after(Seek(robot.start_ns + 5 * SECOND))
        robot.stream.send([object()])  # type: ignore[list-item]
        now = robot.until(lambda now: now.playback.lag is None)
        assert any(entry.level == "error" for entry in now.log)
        assert robot.drive_on(9.0).playback.state == "playing"


def test_what_is_too_old_is_given_up(drive: list[Item]):
    """Two seconds are kept of twelve; what is shown longer than that leads back to now."""
    with robot_of(drive, look_back=2.0) as robot:
        newest = robot.drive_on(8.0)
        kept = newest.playback.kept_ns
        assert kept is not None
        assert 0 <= newest.ahead.time_ns - kept[0] <= 2.2 * SECOND
        robot.after(Seek(-5))
        robot.drive_on(12.0)
        robot.engine.send(Play())
        robot.until(lambda now: now.playback.lag is None)


def test_a_stream_of_which_nothing_is_kept_has_no_earlier_times(drive: list[Item]):
    """It says so."""
    with robot_of(drive, look_back=0.0) as robot:
        newest = robot.drive_on(6.0)
        assert newest.playback.kept_ns is None
        there = robot.after(Seek(robot.start_ns))
        assert there.playback.lag is None
        assert "Nothing of the stream is kept" in there.log[-1].text


def test_a_pause_of_a_stream_ends_what_can_be_shown(drive: list[Item]):
    """Its scans went by unused: no run leads over them."""
    with robot_of(drive) as robot:
        robot.drive_on(5.0)
        robot.after(Pause())
        unused = [item for item in drive if 5 * SECOND < item.stamp_ns - robot.start_ns < 5.4 * SECOND]
        robot.stream.send(unused)
        until(robot.engine, lambda now: now.report.skipped and now.playback.kept_ns is None)


def test_items_are_kept_by_age_and_by_size(drive: list[Item], monkeypatch: pytest.MonkeyPatch):
    """By whichever is reached first; numbers stay those of the first count."""
    from hectorscope.session import look_back  # noqa: PLC0415

    scans = [item for item in drive if isinstance(item, LaserScan)]
    kept = look_back.KeptItems(2.0)
    for scan in scans:
        kept.add(scan)
    assert kept.end == len(scans)
    assert kept.at(kept.begin) is scans[kept.begin]
    assert kept.at(kept.begin - 1) is kept.at(kept.end) is None
    assert scans[-1].stamp_ns - scans[kept.begin].stamp_ns <= 2 * SECOND
    monkeypatch.setattr(look_back, "MOST_BYTES", 10 * (look_back.OVERHEAD + scans[0].ranges.nbytes))
    kept.add(replace(scans[-1]))
    assert kept.end - kept.begin == 10
