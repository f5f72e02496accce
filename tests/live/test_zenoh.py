"""The live source of rmw_zenoh, against a Zenoh session that stands in for a robot's router."""

from collections.abc import Callable
from itertools import islice
from pathlib import Path

import pytest

from hectorscope.inputs import SourceError, SourceOptions
from hectorscope.run.settings import Settings
from hectorscope.run.warmup import load_everything
from hectorscope.sources import open_source
from slam_core.measurements import Imu, LaserScan
from tests.engines import running, until
from tests.live.conftest import Replay
from tests.live.measurements import GIVE_UP_S, TOPICS, opened, plain, recorded

pytest.importorskip("zenoh", reason="no eclipse-zenoh here: install hectorscope[zenoh]")


def test_zenoh_gives_the_measurements_of_the_file(drive: Path, replay: Callable[..., Replay]) -> None:
    """Every scan and inertial sample arrives, bit by bit the same and in the same order."""
    expected = recorded(drive)
    with opened(replay(drive, *TOPICS, "--speed", "4", scheme="zenoh").uri) as source:
        received = list(islice(source.items(), len(expected)))
        assert not source.report.skipped
    for kind in (LaserScan, Imu):
        assert [plain(item) for item in received if isinstance(item, kind)] == [
            plain(item) for item in expected if isinstance(item, kind)
        ]


def test_a_killed_router_is_waited_for(drive: Path, replay: Callable[..., Replay]) -> None:
    """When the router dies in the middle and another one takes its place, the same run goes on."""
    load_everything()  # six seconds of driving are over before the kernels are compiled
    first = replay(drive, *TOPICS, scheme="zenoh")
    with opened(first.uri) as source, running(source, Settings()) as engine:
        before = until(engine, lambda now: now.scans >= 5, GIVE_UP_S)
        first.kill()
        waiting = until(engine, lambda now: now.report.connected is False, GIVE_UP_S)
        replay(drive, *TOPICS, "--port", str(first.port), "--begin", "3", scheme="zenoh")
        after = until(engine, lambda now: now.scans >= waiting.scans + 5, GIVE_UP_S)
    assert "start it there (rmw_zenohd)" in waiting.playback.detail
    assert after.epoch == before.epoch


def test_an_absent_router_is_waited_for() -> None:
    """It is no error: the source says why it waits, and ends when it is closed."""
    with opened("zenoh://127.0.0.1:1/0") as source:
        assert "no Zenoh router answers at zenoh://127.0.0.1:1/0" in source.report.waiting
        source.close()
        assert list(source.items()) == []


@pytest.mark.parametrize("uri", ["zenoh://", "zenoh://robot:port", "zenoh://robot:7447/a", "zenoh://a b"])
def test_a_bad_address_is_refused_with_the_form_of_a_good_one(uri: str) -> None:
    """The domain is a number, 0 if it is left out."""
    with pytest.raises(SourceError, match=r"give zenoh://HOST:PORT/DOMAIN"):
        open_source(uri, SourceOptions())
