"""The live source against the real server: recordings replayed by it are taken as from the file."""

import time
from collections.abc import Callable
from itertools import islice
from pathlib import Path

import pytest

from hectorscope.run.headless import run_headless
from hectorscope.run.settings import Settings
from hectorscope.session.feeder import Feeder
from slam_core.measurements import Imu, LaserScan
from tests.engines import running, state, until
from tests.live.conftest import Replay
from tests.live.measurements import GIVE_UP_S, TOPICS, opened, plain, poses, recorded, wait_for


@pytest.mark.parametrize("drive", ["ros1.bag", "ros2.mcap"], indirect=True)
def test_a_replay_gives_the_measurements_of_the_file(drive: Path, replay: Callable[..., Replay]) -> None:
    """Every measurement arrives, bit by bit the same and in the same order, and nothing was dropped."""
    expected = recorded(drive)
    with opened(replay(drive, *TOPICS, "--speed", "6").uri) as source:
        received = list(islice(source.items(), len(expected)))
        assert [plain(item) for item in received] == [plain(item) for item in expected]
        assert source.report.dropped == 0
        assert not source.report.skipped


@pytest.mark.real
def test_a_real_recording_arrives_as_from_the_file(recordings: Path, replay: Callable[..., Replay]) -> None:
    """Scans, odometry and the mount on /tf of a real robot, without definitions in its recording."""
    bag = recordings / "turtlebot4_rosbag2" / "macfirst_floor_take_2"
    server = replay(bag, "--topics", "/scan", "/odom", "/tf", "/tf_static", "--speed", "8", "--end", "16")
    expected = recorded(bag)
    with opened(server.uri) as source:
        received = list(islice(source.items(), 500))
    assert [plain(item) for item in received] == [plain(item) for item in expected[:500]]


def test_a_slow_consumer_loses_old_scans_only(drive: Path, replay: Callable[..., Replay]) -> None:
    """Whoever looks away finds the newest scans, every other measurement, and the number of scans given up."""
    with opened(drive) as source:
        expected = list(source.items())
        everything = source.report.read
    server = replay(drive, *TOPICS, "--speed", "6")
    with opened(server.uri) as source:
        feeder = Feeder(source)
        wait_for(lambda: source.report.read == everything)
        received = list(iter(lambda: feeder.get(1.0), None))
        source.close()
        feeder.close()
    scans = [item for item in expected if isinstance(item, LaserScan)]
    kept = [item for item in received if isinstance(item, LaserScan)]
    assert 0 < len(kept) < len(scans)
    assert feeder.dropped == len(scans) - len(kept)
    newest = {scan.stamp_ns for scan in scans[-len(kept) :]}
    others = [item for item in expected if not isinstance(item, LaserScan) or item.stamp_ns in newest]
    assert [plain(item) for item in received] == [plain(item) for item in others]


def test_a_killed_server_is_waited_for(drive: Path, replay: Callable[..., Replay]) -> None:
    """When the server dies in the middle and another one takes its place, the stream goes on."""
    first = replay(drive, *TOPICS)
    with opened(first.uri) as source:
        items = source.items()
        before = list(islice(items, 200))
        first.kill()
        replay(drive, *TOPICS, "--port", str(first.port), "--begin", "4")
        resumed_ns = before[0].stamp_ns + 4_000_000_000
        after = next(item for item in items if isinstance(item, Imu) and item.stamp_ns >= resumed_ns)
        assert after.stamp_ns < resumed_ns + 100_000_000
        assert source.report.waiting == ""


def test_a_live_run_gives_the_trajectory_of_the_file(drive: Path, replay: Callable[..., Replay]) -> None:
    """Mapping from the stream ends in the same poses as mapping from the recording, to the last bit."""
    with opened(drive) as source:
        pipeline, _ = run_headless(source, Settings())
    with opened(replay(drive, *TOPICS, "--speed", "2").uri) as source, running(source, Settings()) as engine:
        live = until(engine, lambda now: now.scans >= pipeline.scans - 3, GIVE_UP_S)
    assert live.report.dropped == 0
    rows = min(live.scans, pipeline.scans)
    assert poses(live.playback.start_ns, live.trajectory[:rows]) == poses(
        pipeline.start_ns or 0, pipeline.trajectory[:rows]
    )


def test_the_clock_of_the_robot_may_be_years_off(drive: Path, replay: Callable[..., Replay]) -> None:
    """How far is told, with rate and latency of each topic; the run is not disturbed."""
    with opened(replay(drive, *TOPICS, "--speed", "1").uri) as source, running(source, Settings()) as engine:
        live = until(engine, lambda now: now.scans >= 20, GIVE_UP_S)
        here_s = time.time()
    link = live.report.link
    assert link is not None and link.clock_offset_s is not None
    assert link.clock_offset_s == pytest.approx(live.playback.time_ns / 1e9 - here_s, abs=5.0)
    assert abs(link.clock_offset_s) > 1e6
    assert {"/scan", "/imu/data_raw"} <= set(link.topics)
    assert link.topics["/scan"].rate_hz == pytest.approx(10.0, abs=3.0)
    assert all(topic.latency_s >= 0.0 for topic in link.topics.values())


def test_the_map_survives_a_killed_server(drive: Path, replay: Callable[..., Replay]) -> None:
    """While the server is away the page waits and says so; then the same run goes on with its map."""
    first = replay(drive, *TOPICS)
    with opened(first.uri) as source, running(source, Settings()) as engine:
        until(engine, lambda now: now.scans >= 10, GIVE_UP_S)
        first.kill()
        alone = until(engine, state("waiting"), GIVE_UP_S)
        replay(drive, *TOPICS, "--port", str(first.port), "--begin", "4")
        resumed = until(engine, lambda now: now.scans >= alone.scans + 5, GIVE_UP_S)
    assert first.uri in alone.playback.detail
    assert (alone.report.connected, resumed.report.connected) == (False, True)
    assert alone.report.scan_topic == "/scan"
    assert resumed.epoch == alone.epoch
    assert resumed.map_updates >= alone.map_updates > 0
    assert resumed.trajectory[: alone.scans].tobytes() == alone.trajectory.tobytes()
