"""The live source of rosbridge, against a server of its own process that follows the protocol."""

from collections.abc import Callable
from itertools import islice
from pathlib import Path

import pytest

from hectorscope.inputs import SourceError, SourceOptions
from hectorscope.run.headless import run_headless
from hectorscope.run.settings import Settings
from hectorscope.sources import open_source
from slam_core.measurements import Imu
from tests.engines import running, until
from tests.live.conftest import Replay
from tests.live.measurements import GIVE_UP_S, TOPICS, opened, plain, recorded


@pytest.mark.parametrize("drive", ["ros1.bag", "ros2.mcap"], indirect=True)
def test_a_rosbridge_gives_the_measurements_of_the_file(drive: Path, replay: Callable[..., Replay]) -> None:
    """Every measurement of either generation of ROS arrives, bit by bit the same and in the same order."""
    expected = recorded(drive)
    with opened(replay(drive, *TOPICS, "--speed", "6", scheme="rosbridge").uri) as source:
        received = list(islice(source.items(), len(expected)))
        assert [plain(item) for item in received] == [plain(item) for item in expected]
        assert not source.report.skipped


def test_a_topic_that_comes_later_is_found(drive: Path, replay: Callable[..., Replay]) -> None:
    """The bridge tells of new topics only when it is asked again."""
    server = replay(drive, *TOPICS, "--late", "/imu/data_raw", "--speed", "6", scheme="rosbridge")
    with opened(server.uri) as source:
        assert any(isinstance(item, Imu) for item in source.items())


def test_a_killed_bridge_is_waited_for(drive: Path, replay: Callable[..., Replay]) -> None:
    """When the bridge dies in the middle and another one takes its place, the same run goes on."""
    first = replay(drive, *TOPICS, scheme="rosbridge")
    with opened(first.uri) as source, running(source, Settings()) as engine:
        before = until(engine, lambda now: now.scans >= 5, GIVE_UP_S)
        first.kill()
        waiting = until(engine, lambda now: now.report.connected is False, GIVE_UP_S)
        replay(drive, *TOPICS, "--port", str(first.port), "--begin", "3", scheme="rosbridge")
        after = until(engine, lambda now: now.scans >= waiting.scans + 5, GIVE_UP_S)
    assert first.uri in waiting.playback.detail
    assert after.epoch == before.epoch


def test_a_run_from_a_rosbridge_is_that_of_the_file(drive: Path, replay: Callable[..., Replay]) -> None:
    """The poses are the same to the last bit."""
    with opened(drive) as source:
        whole, _ = run_headless(source, Settings())
    server = replay(drive, *TOPICS, "--speed", "2", scheme="rosbridge")
    with opened(server.uri) as source, running(source, Settings()) as engine:
        live = until(engine, lambda now: now.scans >= whole.scans - 3, GIVE_UP_S)
    assert live.report.dropped == 0
    rows = min(live.scans, whole.scans)
    assert live.trajectory[:rows, 1:].tobytes() == whole.trajectory[:rows, 1:].tobytes()


def test_a_server_that_is_no_rosbridge_is_named(scripted: Callable[..., object]) -> None:
    """Nobody there, or another protocol: the address with the remedy."""
    with pytest.raises(SourceError, match=r"names no possible host: give rosbridge://HOST:PORT"):
        open_source("rosbridge://robot..local:9090", SourceOptions())
