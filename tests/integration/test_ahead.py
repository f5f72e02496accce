"""A recording is run ahead of what is shown: to its end, and without a trace in what is shown."""

import math
from dataclasses import replace

import numpy as np

from hectorscope.inputs import Item, SourceError
from hectorscope.run.headless import run_headless
from hectorscope.run.series import SERIES_FIELDS
from hectorscope.run.settings import Settings
from hectorscope.session.commands import Configure, Play, Restart, Seek, SetSpeed, Undo
from hectorscope.session.snapshot import Snapshot
from slam_core.measurements import LaserScan
from tests.engines import START, after, running, state, until
from tests.sources import MemoryRecording, MemoryStream

SECOND = 10**9
MEASURED = [name for name in SERIES_FIELDS if not name.endswith("_ms")]  # all but the time it took


def is_whole(now: Snapshot) -> bool:
    return now.ahead.whole


def check_rows(now: Snapshot, drive: list[Item], settings: Settings = START) -> None:
    """What is known of the run are the rows of a straight one."""
    rows = run_headless(MemoryRecording(drive), settings)[0].series
    for name in MEASURED:
        np.testing.assert_array_equal(now.ahead.series[name], rows[:, SERIES_FIELDS.index(name)])


def test_a_recording_at_rest_is_run_to_its_end(drive: list[Item]):
    """Nothing of it is shown; the rows are those of a straight run, and its time is that of the last scan."""
    with running(MemoryRecording(drive), autoplay=False) as engine:
        now = until(engine, is_whole)
    assert (now.scans, now.playback.state) == (0, "paused")
    assert now.ahead.time_ns == max(item.stamp_ns for item in drive if isinstance(item, LaserScan))
    check_rows(now, drive)


def test_what_is_shown_meanwhile_is_the_same_to_the_last_bit(drive: list[Item], reference: np.ndarray):
    """The run is paced, the time between its scans goes to the other one."""
    with running(MemoryRecording(drive), speed=1.0) as engine:
        ahead = until(engine, is_whole)
        assert ahead.playback.state == "playing"
        assert ahead.scans < len(reference)
        ended = until(engine, state("ended"))
    assert ended.trajectory.tobytes() == reference.tobytes()
    assert ended.ahead.lineage == ahead.ahead.lineage
    assert ended.epoch == 0


def test_a_time_that_was_never_shown_is_near(drive: list[Item], reference: np.ndarray):
    """A jump far ahead goes on from a checkpoint that nobody has seen: most scans are not stepped again."""
    with running(MemoryRecording(drive), autoplay=False) as engine:
        until(engine, is_whole)
        there = after(engine, Seek(drive[-1].stamp_ns - SECOND // 10))
    assert there.epoch == 1
    assert there.trajectory.tobytes() == reference[: there.scans].tobytes()


def test_settings_changed_at_a_time_are_run_again_from_there(drive: list[Item]):
    """What is known before the change stays, what is behind it is that of a run with the change."""
    with running(MemoryRecording(drive), autoplay=False) as engine:
        before = until(engine, is_whole)
        there = after(engine, Seek(drive[0].stamp_ns + 2 * SECOND))
        engine.send(Configure("fusion.omega", 0.2))
        now = until(engine, lambda now: now.obeyed == engine.sent and now.ahead.whole)
    assert now.ahead.lineage != before.ahead.lineage
    assert now.ahead.settings.changes
    check_rows(now, drive, START.changed(there.playback.time_ns, "fusion.omega", 0.2))


def test_a_run_that_is_begun_again_and_brought_back_is_known_again(drive: list[Item]):
    """Each of them is run to its end."""
    with running(MemoryRecording(drive), speed=math.inf) as engine:
        first = until(engine, is_whole)
        engine.send(SetSpeed(0.1))
        engine.send(Restart())
        second = until(engine, lambda now: now.ahead.lineage != first.ahead.lineage and now.ahead.whole)
        check_rows(second, drive)
        engine.send(Undo())
        check_rows(until(engine, lambda now: now.ahead.lineage == first.ahead.lineage and now.ahead.whole), drive)


def test_what_is_shown_may_be_ahead_and_is_caught_up_with(drive: list[Item]):
    """At the highest speed there is no time to spare: the head takes over from the last checkpoint at the end."""
    with running(MemoryRecording(drive), speed=math.inf) as engine:
        until(engine, state("ended"))
        check_rows(until(engine, is_whole), drive)


def test_nothing_is_run_ahead_where_nobody_wants_it_or_there_is_nothing(drive: list[Item]):
    """What is known is what was shown: switched off, and of a stream."""
    with running(MemoryRecording(drive), ahead_after=None, speed=math.inf) as engine:
        ended = until(engine, state("ended"))
        assert (ended.ahead.whole, len(ended.ahead.series)) == (False, ended.scans)
        back = after(engine, Seek(drive[0].stamp_ns + 2 * SECOND))
        assert (back.ahead.whole, len(back.ahead.series)) == (False, back.scans)
    stream = MemoryStream()
    with running(stream) as engine:
        stream.send(drive)
        now = until(engine, lambda now: now.scans > 5)
        assert (now.ahead.whole, len(now.ahead.series)) == (False, now.scans)


def test_a_recording_may_be_run_ahead_later(drive: list[Item]):
    """At rest, too."""
    with running(MemoryRecording(drive), autoplay=False, ahead_after=2.0) as engine:
        first = until(engine, lambda now: now.playback.state == "paused")
        assert (first.ahead.whole, len(first.ahead.series)) == (False, 0)
        check_rows(until(engine, is_whole), drive)


def test_a_recording_that_cannot_be_read_ends_the_pass_and_not_the_run(drive: list[Item]):
    """What was known by then stays known; the shown run tells the reason when it comes there."""
    broken = MemoryRecording(drive, error=SourceError("it is torn"), fail_at=len(drive) // 2)
    with running(broken, autoplay=False) as engine:
        ahead = until(engine, is_whole)
        assert 0 < len(ahead.ahead.series) < sum(isinstance(item, LaserScan) for item in drive)
        assert ahead.playback.state == "paused"
        engine.send(SetSpeed(math.inf))
        engine.send(Play())
        assert "torn" in until(engine, state("failed")).playback.detail


def test_a_source_without_a_second_reading_is_shown_without_a_pass(drive: list[Item], reference: np.ndarray):
    """A recording that can be read at one place only."""

    class Single(MemoryRecording):
        def again(self):  # type: ignore[no-untyped-def]
            return None

    with running(Single(drive), replace(START), speed=math.inf) as engine:
        ended = until(engine, state("ended"))
    assert ended.trajectory.tobytes() == reference.tobytes()
