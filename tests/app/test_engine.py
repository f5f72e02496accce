import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest

from app.engine import Engine
from app.examiner import examined
from app.feeder import Feeder
from app.runner import run_headless
from app.settings import Change, Settings
from app.simulation import SceneOptions, Simulation
from app.snapshot import (
    Command,
    Configure,
    Pause,
    Play,
    PlayPause,
    Restart,
    Seek,
    SetSpeed,
    Snapshot,
    StepScan,
)
from app.sources import Item, Source, SourceOptions
from slam_core.config import SlamConfig, with_value
from slam_core.measurements import Imu, LaserScan
from tests.sources import MemoryRecording, MemoryStream

START = Settings(with_value(SlamConfig(), "map.size", 512))
PATIENCE_S = 20.0


@pytest.fixture(scope="module")
def drive() -> list[Item]:
    """Four seconds through the simulated rooms, with inertial data and truth."""
    return list(Simulation("rooms", SceneOptions(duration=4.0, scan_rate=20.0, beams=181)).items())


@pytest.fixture(scope="module")
def reference(drive: list[Item]) -> np.ndarray:
    """The trajectory of the headless run."""
    return run_headless(MemoryRecording(drive), START)[0].trajectory


@contextmanager
def running(source: Source, settings: Settings = START, **options: float) -> Iterator[Engine]:
    """An engine that is stopped in any case."""
    engine = Engine(source, settings, **options)  # type: ignore[arg-type]
    engine.start()
    try:
        yield engine
    finally:
        engine.stop()


def until(engine: Engine, holds: Callable[[Snapshot], bool]) -> Snapshot:
    """The first snapshot for which something holds."""
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        latest = engine.mailbox.latest
        if latest is not None and holds(latest):
            return latest
        engine.mailbox.take(timeout=0.1)
    assert latest is not None
    raise AssertionError(f"never happened; at last {latest.playback}, {latest.report}, {latest.log}")


def state(word: str) -> Callable[[Snapshot], bool]:
    """A condition for `until`."""
    return lambda snapshot: snapshot.playback.state == word


def after(engine: Engine, *commands: Command) -> Snapshot:
    """The snapshot once the commands were obeyed and the engine rests."""
    seen = engine.mailbox.latest
    assert seen is not None
    for command in commands:
        engine.send(command)
    resting = ("paused", "ended", "failed")
    return until(engine, lambda now: now.sequence > seen.sequence and now.playback.state in resting)


def scan_times(items: list[Item]) -> list[int]:
    """Stamps of the scans."""
    return [item.stamp_ns for item in items if isinstance(item, LaserScan)]


# ------------------------------------------------------------------------------------------- recordings


def test_the_page_runs_what_the_headless_run_runs(drive: list[Item], reference: np.ndarray):
    """As fast as it goes, the trajectory is the headless one to the last bit."""
    with running(MemoryRecording(drive), speed=math.inf) as engine:
        ended = until(engine, state("ended"))
    assert ended.trajectory.tobytes() == reference.tobytes()
    assert ended.scans == len(reference) > 40
    assert ended.playback.end_ns == max(item.stamp_ns for item in drive)
    assert any("ended" in entry.text for entry in ended.log)


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
    """Three blind scans: a warning with the reason when the pose goes, a line when it is back, and counts."""
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
    assert "degraded: 0% of the known endpoints on walls" in lines[0][1]
    assert "recovered" in lines[1][1]
    pipeline, _ = run_headless(MemoryRecording(blind), START)
    assert pipeline.states["degraded"] == 3
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
        assert after(engine, SetSpeed(1.0)).playback.state == "paused"
        assert engine.mailbox.latest is None or engine.mailbox.latest.scans <= paused.scans + 1


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


def test_a_seek_beyond_the_ends_is_clamped(drive: list[Item], reference: np.ndarray):
    """Nobody falls off the recording."""
    with running(MemoryRecording(drive), autoplay=False) as engine:
        until(engine, state("paused"))
        ended = after(engine, Seek(10**20))
        assert (ended.playback.state, ended.scans) == ("ended", len(reference))
        first = after(engine, Seek(-5))
        assert first.scans == 0


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
        until(engine, lambda now: now.epoch == 2 and now.playback.state == "ended")


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


# --------------------------------------------------------------------------------------------- settings


def test_a_change_acts_from_the_next_scan_and_is_logged(drive: list[Item], reference: np.ndarray):
    """The past stays, the future differs, and the log says when, what, from what, to what."""
    with running(MemoryRecording(drive), autoplay=False, speed=math.inf) as engine:
        until(engine, state("paused"))
        there = after(engine, Seek(drive[0].stamp_ns + 2 * 10**9))
        changed = after(engine, Configure("fusion.omega", 0.9))
        engine.send(Play())
        ended = until(engine, state("ended"))
    entry = changed.log[-1]
    assert entry.text == f"fusion.omega: {START.start.fusion.omega} → 0.9"
    assert entry.time_ns == there.playback.time_ns
    assert changed.config.fusion.omega == 0.9
    assert ended.trajectory[: there.scans].tobytes() == reference[: there.scans].tobytes()
    assert ended.trajectory[there.scans :].tobytes() != reference[there.scans :].tobytes()


def test_a_run_with_changes_can_be_repeated_headless(drive: list[Item]):
    """The logged change, planned at its time, gives the same trajectory without a hand."""
    with running(MemoryRecording(drive), autoplay=False, speed=math.inf) as engine:
        until(engine, state("paused"))
        there = after(engine, Seek(drive[0].stamp_ns + 2 * 10**9))
        after(engine, Configure("fusion.omega", 0.9))
        engine.send(Play())
        ended = until(engine, state("ended"))
    planned = replace(START, changes=(Change(there.playback.time_ns + 1, "fusion.omega", 0.9),))
    repeated, _ = run_headless(MemoryRecording(drive), planned)
    assert repeated.trajectory.tobytes() == ended.trajectory.tobytes()


def test_a_new_run_takes_the_present_values_throughout(drive: list[Item]):
    """After a slider was moved, going back runs with its value from the first scan on."""
    with running(MemoryRecording(drive), autoplay=False, speed=math.inf) as engine:
        until(engine, state("paused"))
        after(engine, Seek(drive[0].stamp_ns + 2 * 10**9))
        after(engine, Configure("fusion.omega", 0.9))
        after(engine, Seek(drive[0].stamp_ns + 10**9))
        engine.send(Play())
        ended = until(engine, state("ended"))
    throughout = Settings(with_value(START.start, "fusion.omega", 0.9))
    expected, _ = run_headless(MemoryRecording(drive), throughout)
    assert ended.trajectory.tobytes() == expected.trajectory.tobytes()


def test_a_setting_of_the_map_runs_again_to_the_same_instant(drive: list[Item]):
    """The number of levels changes by a re-run up to here, as if it had been so from the start."""
    with running(MemoryRecording(drive), autoplay=False) as engine:
        until(engine, state("paused"))
        there = after(engine, Seek(drive[0].stamp_ns + 2 * 10**9))
        engine.send(Configure("map.levels", 2))
        again = until(engine, lambda now: now.epoch == 1 and now.playback.state == "paused")
    assert len(again.maps) == 2
    assert again.playback.time_ns == there.playback.time_ns
    assert again.scans == there.scans
    assert f"map.levels: {START.start.map.levels} → 2" in [entry.text for entry in again.log]


@pytest.mark.parametrize(("name", "value"), [("fusion.omega", 7.0), ("no.such", 1), ("matcher.sigma", math.nan)])
def test_a_bad_setting_is_a_line_in_the_log(drive: list[Item], name: str, value: float):
    """Nonsense from a browser changes nothing and stops nothing."""
    with running(MemoryRecording(drive), autoplay=False) as engine:
        until(engine, state("paused"))
        refused = after(engine, Configure(name, value))
        assert refused.log[-1].level == "warning"
        assert name in refused.log[-1].text
        assert refused.config == START.start
        assert after(engine, Seek(10**20)).playback.state == "ended"


def test_a_bad_speed_is_refused(drive: list[Item]):
    """Not a number, zero and negative speeds change nothing."""
    with running(MemoryRecording(drive), autoplay=False, speed=2.0) as engine:
        until(engine, state("paused"))
        for speed in (math.nan, 0.0, -1.0):
            refused = after(engine, SetSpeed(speed))
            assert refused.playback.speed == 2.0
            assert refused.log[-1].level == "warning"


# --------------------------------------------------------------------------------------------- failures


def test_a_failing_source_is_named_and_the_engine_survives(drive: list[Item], reference: np.ndarray):
    """What was read is processed and shown with the reason; a restart reads again."""
    source = MemoryRecording(drive, error=OSError("the disk is gone"), fail_at=len(drive) // 2)
    with running(source, speed=math.inf) as engine:
        failed = until(engine, state("failed"))
        assert "memory" in failed.playback.detail
        assert "the disk is gone" in failed.playback.detail
        assert 0 < failed.scans < len(reference)
        assert failed.log[-1].level == "error"
        engine.send(Restart())
        ended = until(engine, state("ended"))
    assert ended.trajectory.tobytes() == reference.tobytes()


def test_an_error_in_the_core_does_not_end_the_engine(drive: list[Item]):
    """A measurement that the core chokes on is reported; the engine still obeys."""
    broken = LaserScan(drive[0].stamp_ns, None, 0.0, 0.1)  # type: ignore[arg-type]
    with running(MemoryRecording([broken, *drive]), speed=math.inf) as engine:
        failed = until(engine, state("failed"))
        assert "TypeError" in failed.playback.detail
        engine.send(Restart())
        until(engine, lambda now: now.epoch == 1 and now.playback.state == "failed")


def test_a_recording_without_a_usable_scan_says_so(drive: list[Item]):
    """An empty outcome is a failure with its reason, not a silent end."""
    no_scans = [item for item in drive if not isinstance(item, LaserScan)]
    with running(MemoryRecording(no_scans), speed=math.inf) as engine:
        failed = until(engine, state("failed"))
    assert "memory: no scan could be used" in failed.playback.detail


# ------------------------------------------------------------------------------------------------- live


def test_a_stream_whose_devices_lie_fails_with_the_remedy():
    """Ten seconds of a gyroscope in degrees: the page says what it is and which flag repairs it."""
    options = SceneOptions(duration=10.0, scan_rate=10.0, beams=181)
    stream = MemoryStream()
    stream.send(
        [
            replace(item, angular_velocity=np.degrees(item.angular_velocity)) if isinstance(item, Imu) else item
            for item in Simulation("rooms", options).items()
        ]
    )
    with running(examined(stream, SourceOptions())) as engine:
        failed = until(engine, state("failed"))
    assert "so in degrees a second" in failed.playback.detail
    assert "--imu-gyro-unit deg/s" in failed.playback.detail


def test_a_stream_gives_what_the_recording_gives(drive: list[Item], reference: np.ndarray):
    """Nothing dropped, same scans: the same trajectory to the last bit."""
    stream = MemoryStream()
    with running(stream) as engine:
        sent = 0
        for item in drive:
            stream.send([item])
            sent += isinstance(item, LaserScan)
            if sent and sent % 4 == 0 and isinstance(item, LaserScan):
                until(engine, lambda now, sent=sent: now.scans + sum(now.report.skipped.values()) >= sent - 4)
        last = len(reference) - 1
        now = until(engine, lambda now: now.scans >= last)
    assert now.report.dropped == 0
    assert now.playback.live
    assert now.playback.end_ns is None
    rows = slice(0, last)
    np.testing.assert_array_equal(now.trajectory[rows, 1:], reference[rows, 1:])


def test_a_slow_pipeline_loses_the_oldest_scans_and_no_inertial_data(drive: list[Item]):
    """While nobody takes anything, only old scans are given up, and they are counted."""
    stream = MemoryStream()
    stream.send(drive)
    stream.close()
    feeder = Feeder(stream)
    deadline = time.monotonic() + PATIENCE_S
    while feeder.reading and time.monotonic() < deadline:
        time.sleep(0.01)
    got = []
    while (item := feeder.get(0.0)) is not None:
        got.append(item)
    feeder.close()
    scans = [item for item in got if isinstance(item, LaserScan)]
    assert 0 < len(scans) < 20
    assert feeder.dropped == len(scan_times(drive)) - len(scans)
    assert [scan.stamp_ns for scan in scans] == scan_times(drive)[-len(scans) :]
    others = [item for item in drive if not isinstance(item, LaserScan)]
    assert [item for item in got if not isinstance(item, LaserScan)] == others


def test_a_paused_stream_flows_on(drive: list[Item]):
    """Scans that pass by during a pause are counted; play goes on with the newest."""
    stream = MemoryStream()
    half = len(drive) // 2
    with running(stream, autoplay=False) as engine:
        until(engine, state("paused"))
        stream.send(drive[:half])
        paused = until(engine, lambda now: now.report.skipped.get("scan while the stream was paused", 0) > 3)
        assert paused.scans == 0
        engine.send(Play())
        stream.send(drive[half:])
        assert until(engine, lambda now: now.scans > 1).playback.state != "paused"


def test_a_stream_restarts_with_an_empty_map_and_cannot_seek(drive: list[Item]):
    """Restart keeps the stream and drops the map; a seek is refused in the log."""
    stream = MemoryStream()
    half = len(drive) // 2
    with running(stream) as engine:
        stream.send(drive[:half])
        until(engine, lambda now: now.scans > 1)
        engine.send(Seek(0))
        until(engine, lambda now: any("nothing was sought" in entry.text for entry in now.log))
        engine.send(Configure("map.levels", 2))
        until(engine, lambda now: now.epoch == 1)
        stream.send(drive[half:])
        fresh = until(engine, lambda now: now.scans > 1 and now.maps != ())
        assert fresh.epoch == 1
        assert len(fresh.maps) == 2
        assert any("new map" in entry.text for entry in fresh.log)


def test_a_silent_stream_is_waited_for(drive: list[Item]):
    """Nothing comes: the state says waiting, and the engine obeys."""
    with running(MemoryStream()) as engine:
        until(engine, state("waiting"))
        engine.send(Pause())
        until(engine, state("paused"))
