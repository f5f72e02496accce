"""Recordings in the engine: the same outcome however they are played, sought and begun again."""

import math
import threading
from dataclasses import replace

import numpy as np

from hectorscope.inputs import Item
from hectorscope.run.headless import run_headless
from hectorscope.session.commands import Pause, Play, PlayPause, Restart, Seek, SetSpeed, StepScan
from hectorscope.session.engine import Engine
from slam_core.measurements import LaserScan
from tests.engines import START, after, running, scan_times, state, until
from tests.sources import MemoryRecording

SECOND = 10**9


def test_the_page_runs_what_the_headless_run_runs(drive: list[Item], reference: np.ndarray):
    """As fast as it goes, the trajectory is the headless one to the last bit."""
    with running(MemoryRecording(drive), speed=math.inf) as engine:
        ended = until(engine, state("ended"))
    assert ended.trajectory.tobytes() == reference.tobytes()
    assert ended.scans == len(reference) > 40
    assert ended.playback.end_ns == max(item.stamp_ns for item in drive)
    assert any("ended" in entry.text for entry in ended.log)


def test_the_page_is_told_how_far_the_preparation_is(drive: list[Item]):
    """A loading run shows the words of who prepares it, and no more once it plays."""
    engine = Engine(MemoryRecording(drive), START)
    ready = threading.Event()
    engine.start(prepare=lambda tell: (tell("3 of 5"), ready.wait(20.0)))
    try:
        waiting = until(engine, lambda now: now.playback.preparing == "3 of 5")
        ready.set()
        playing = until(engine, state("playing"))
    finally:
        ready.set()
        engine.stop()
    assert waiting.playback.state == "loading"
    assert playing.playback.preparing == ""


def test_pauses_steps_and_speeds_do_not_change_the_outcome(drive: list[Item], reference: np.ndarray):
    """However it is played, the trajectory is the same to the last bit."""
    with running(MemoryRecording(drive), autoplay=False, speed=8.0) as engine:
        until(engine, state("paused"))
        for _ in range(5):
            after(engine, StepScan())
        engine.send(Play())
        until(engine, lambda now: now.scans > 10)
        after(engine, Pause())
        engine.send(SetSpeed(math.inf))
        engine.send(Play())
        ended = until(engine, state("ended"))
    assert ended.trajectory.tobytes() == reference.tobytes()


def test_each_change_of_the_tracking_is_logged_once(drive: list[Item]):
    """Three covered scans: a warning with the reason when the pose goes, a line when it is back, and counts."""
    times = scan_times(drive)[40:43]
    blind = [
        replace(item, ranges=np.full_like(item.ranges, 0.7))
        if isinstance(item, LaserScan) and item.stamp_ns in times
        else item
        for item in drive
    ]
    with running(MemoryRecording(blind), speed=math.inf) as engine:
        ended = until(engine, state("ended"))
    lines = [(entry.level, entry.text) for entry in ended.log if entry.text.startswith("The pose is")]
    assert [level for level, _ in lines] == ["warning", "info"]
    assert "degraded: something near the laser hides walls of the map" in lines[0][1]
    assert "recovered" in lines[1][1]
    pipeline, _ = run_headless(MemoryRecording(blind), START)
    assert pipeline.states["degraded"] == 3  # they tell nothing against the prediction
    assert sum(pipeline.states.values()) == pipeline.scans


def test_without_autoplay_nothing_is_processed(drive: list[Item]):
    """The engine waits for the first command, with a snapshot to show."""
    with running(MemoryRecording(drive), autoplay=False) as engine:
        paused = until(engine, state("paused"))
        assert paused.scans == 0
        assert paused.source == "memory"
        assert paused.playback.start_ns == min(item.stamp_ns for item in drive)


def test_one_key_plays_and_pauses(drive: list[Item]):
    """PlayPause is decided by the run itself: pressed twice at once, or right behind a step, it is never lost."""
    with running(MemoryRecording(drive), autoplay=False) as engine:
        until(engine, state("paused"))
        engine.send(StepScan())
        engine.send(PlayPause())
        until(engine, lambda now: now.playback.state == "playing" and now.scans > 2)
        after(engine, PlayPause())
        paused = until(engine, state("paused"))
        engine.send(PlayPause())
        engine.send(PlayPause())
        shown = after(engine, SetSpeed(1.0))
        assert shown.playback.state == "paused"
        assert shown.scans <= paused.scans + 1


def test_a_snapshot_tells_how_many_commands_it_was_made_after(drive: list[Item]):
    """Carried out or refused, each counts; the one that counts all that were sent shows what they did."""
    with running(MemoryRecording(drive), autoplay=False) as engine:
        for sent, speed in enumerate((2.0, -1.0, 3.0), 1):
            engine.send(SetSpeed(speed))
            assert engine.sent == sent
        assert until(engine, lambda now: now.obeyed == 3).playback.speed == 3.0


def test_a_step_is_one_scan(drive: list[Item]):
    """Each StepScan brings one scan and leaves the run paused."""
    with running(MemoryRecording(drive), autoplay=False) as engine:
        until(engine, state("paused"))
        after(engine, Seek(drive[0].stamp_ns + 10**9))
        before = after(engine, Pause())
        for count in (1, 2, 3):
            now = after(engine, StepScan())
            assert now.playback.state == "paused"
            assert now.scans == before.scans + count


def test_a_seek_stops_right_before_the_first_later_scan(drive: list[Item], reference: np.ndarray):
    """All scans up to the time are processed and none after it; forward no map is thrown away."""
    target = drive[0].stamp_ns + 2 * 10**9
    with running(MemoryRecording(drive), autoplay=False) as engine:
        until(engine, state("paused"))
        there = after(engine, Seek(target))
    assert there.playback.time_ns == max(stamp for stamp in scan_times(drive) if stamp <= target)
    assert there.trajectory.tobytes() == reference[: there.scans].tobytes()
    assert there.epoch == 0


def test_a_seek_back_repeats_the_run(drive: list[Item], reference: np.ndarray):
    """Back in time is a new epoch, and what follows is the same to the last bit."""
    with running(MemoryRecording(drive), autoplay=False) as engine:
        until(engine, state("paused"))
        after(engine, Seek(drive[0].stamp_ns + 3 * 10**9))
        back = after(engine, Seek(drive[0].stamp_ns + 10**9))
        assert back.epoch == 1
        assert 0 < back.scans < len(reference)
        engine.send(SetSpeed(math.inf))
        engine.send(Play())
        ended = until(engine, state("ended"))
    assert ended.trajectory.tobytes() == reference.tobytes()


def test_a_jump_from_the_end_stays_there(drive: list[Item]):
    """Whoever looks for where it broke does not want to see the end again."""
    with running(MemoryRecording(drive), speed=math.inf) as engine:
        until(engine, state("ended"))
        there = after(engine, Seek(drive[0].stamp_ns + 2 * 10**9))
        assert there.playback.state == "paused"
        engine.send(Play())
        until(engine, state("ended"))


def test_a_seek_beyond_the_ends_is_clamped(drive: list[Item], reference: np.ndarray):
    """Nobody falls off the recording."""
    with running(MemoryRecording(drive), autoplay=False) as engine:
        until(engine, state("paused"))
        ended = after(engine, Seek(10**20))
        assert (ended.playback.state, ended.scans) == ("ended", len(reference))
        first = after(engine, Seek(-5))
        assert first.scans == 0


def test_a_dragged_timeline_shows_places_on_its_way_and_ends_where_it_was_left(
    drive: list[Item], reference: np.ndarray
):
    """A time wanted while a seek is about to arrive waits; the newest one counts, others are dropped."""
    begin = drive[0].stamp_ns
    with running(MemoryRecording(drive), autoplay=False) as engine:
        until(engine, lambda now: now.ahead.whole)
        before = after(engine, Seek(begin + SECOND)).playback.seeks
        targets = [begin + round(share * SECOND) for share in np.linspace(1.2, 3.4, 40)]
        there = after(engine, *map(Seek, targets))
    assert there.playback.time_ns == max(stamp for stamp in scan_times(drive) if stamp <= targets[-1])
    assert there.trajectory.tobytes() == reference[: there.scans].tobytes()
    assert 2 <= there.playback.seeks - before < len(targets)


def test_the_next_button_cancels_a_seek(drive: list[Item], reference: np.ndarray):
    """Pause, sent right behind a seek to the end, leaves the run where it got to."""
    with running(MemoryRecording(drive), autoplay=False) as engine:
        until(engine, state("paused"))
        engine.send(Seek(10**20))
        now = after(engine, Pause())
    assert now.playback.state == "paused"
    assert now.scans < len(reference)


def test_a_seek_shows_its_progress(drive: list[Item]):
    """While it runs up to a time the state is seeking, with words for how far it is."""
    with running(MemoryRecording(drive), autoplay=False) as engine:
        until(engine, state("paused"))
        engine.send(Seek(10**20))
        seeking = until(engine, lambda now: now.playback.state in ("seeking", "ended"))
        if seeking.playback.state == "seeking":
            assert "%" in seeking.playback.detail


def test_restart_begins_again_with_an_empty_map(drive: list[Item], reference: np.ndarray):
    """A new epoch from the first scan on, the same trajectory; also by Play at the end."""
    with running(MemoryRecording(drive), speed=math.inf) as engine:
        until(engine, state("ended"))
        engine.send(Restart())
        again = until(engine, lambda now: now.epoch == 1 and now.playback.state == "ended")
        assert again.trajectory.tobytes() == reference.tobytes()
        engine.send(Play())
        ended = until(engine, lambda now: now.epoch == 2 and now.playback.state == "ended")
        assert sum("The recording ended" in entry.text for entry in ended.log) == 1


def test_a_paused_restart_is_empty(drive: list[Item]):
    """Restart while paused shows nothing of the old run."""
    with running(MemoryRecording(drive), autoplay=False) as engine:
        until(engine, state("paused"))
        after(engine, Seek(10**20))
        after(engine, Pause())
        empty = after(engine, Restart())
        assert (empty.scans, empty.map_updates, empty.result) == (0, 0, None)
        assert empty.maps == ()


def test_what_a_snapshot_shows(drive: list[Item]):
    """Maps, series, truth and counters belong to the run so far."""
    with running(MemoryRecording(drive), speed=math.inf) as engine:
        ended = until(engine, state("ended"))
    assert [image.level for image in ended.maps] == [0, 1, 2]
    assert all(np.any(image.cells == 2) for image in ended.maps)
    assert len(ended.series) == ended.scans
    assert ended.series["map_updates"][-1] == ended.map_updates > 0
    np.testing.assert_array_equal(ended.series["time_s"], ended.trajectory[:, 0])
    assert np.all(ended.series["match_ms"][1:] > 0)
    assert len(ended.truth) > 300
    assert ended.report.read["LaserScan"] == len(scan_times(drive))
    assert [entry.text for entry in ended.log].count("all from memory") == 1
    for array in (ended.trajectory, ended.truth, ended.series):
        assert not array.flags.writeable


def test_truth_is_laid_onto_the_first_pose(drive: list[Item]):
    """truth_in_map puts the true path on the estimated one, to centimetres at the start."""
    with running(MemoryRecording(drive), speed=math.inf) as engine:
        ended = until(engine, state("ended"))
    x, y, z, yaw = ended.truth_in_map
    turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    nearest = np.searchsorted(ended.truth[:, 0], ended.trajectory[5, 0])
    there = turn @ ended.truth[nearest, 1:3] + [x, y]
    assert np.linalg.norm(there - ended.trajectory[5, 1:3]) < 0.05
    assert abs(ended.truth[nearest, 3] + z - ended.trajectory[5, 3]) < 0.5


def test_stopping_closes_the_source(drive: list[Item]):
    """Nothing stays open behind a stopped engine."""
    source = MemoryRecording(drive)
    with running(source, autoplay=False) as engine:
        until(engine, state("paused"))
    assert source.closed
