"""The live source of DDS, against robots on another implementation of DDS (eProsima Fast DDS)."""

import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from itertools import islice
from pathlib import Path
from typing import Any

import pytest

from hectorscope.cli.discovery import Found, look
from hectorscope.inputs import SourceError, SourceOptions
from hectorscope.publishing import PublishError, open_bus
from hectorscope.results.topics import LATCHED
from hectorscope.results.topics import TOPICS as PUBLISHED
from hectorscope.run.headless import run_headless
from hectorscope.run.settings import Settings
from hectorscope.run.warmup import load_everything
from hectorscope.sources import open_source
from slam_core.measurements import Imu, LaserScan
from tests.cases import quick_first
from tests.engines import running, until
from tests.live import fastdds
from tests.live.fastdds import LOOPBACK, Peer, Spoken, reserved_domain
from tests.live.measurements import GIVE_UP_S, TOPICS, opened, plain, poses, recorded, wait_for
from tests.live.test_publishing import check

pytest.importorskip("cyclonedds", reason="no cyclonedds here: install hectorscope[dds]")
SPOKEN = TOPICS[1:]


@pytest.fixture(scope="session")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The robot's, compiled once."""
    return fastdds.built(tmp_path_factory.mktemp("fastdds"))


@pytest.fixture
def domain(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """One for this test alone, on the loopback interface."""
    monkeypatch.setenv("CYCLONEDDS_URI", LOOPBACK)
    with reserved_domain() as number:
        yield number


@pytest.fixture
def robot(program: Path, domain: int, tmp_path: Path) -> Iterator[Callable[[Spoken], Peer]]:
    """A function that starts a robot in that domain, which says something once somebody listens."""
    peers: list[Peer] = []

    def start(spoken: Spoken) -> Peer:
        path = spoken.write(tmp_path / f"spoken{len(peers)}")
        peers.append(Peer(program, "publish", str(domain), str(path)))
        return peers[-1]

    yield start
    for peer in peers:
        peer.kill()


def test_dds_gives_the_measurements_of_the_file(drive: Path, domain: int, robot: Callable[[Spoken], Peer]) -> None:
    """Every scan and inertial sample arrives, bit by bit the same and in the same order."""
    expected = recorded(drive)
    robot(fastdds.recorded(drive, SPOKEN, speed=4.0))
    with opened(f"dds://{domain}") as source:
        received = list(islice(source.items(), len(expected)))
        assert not source.report.skipped
    for kind in (LaserScan, Imu):
        assert [plain(item) for item in received if isinstance(item, kind)] == [
            plain(item) for item in expected if isinstance(item, kind)
        ]


def test_a_live_run_gives_the_trajectory_of_the_file(
    drive: Path, domain: int, robot: Callable[[Spoken], Peer]
) -> None:
    """Mapping by DDS ends in the same poses as mapping from the recording, to the last bit."""
    with opened(drive) as source:
        pipeline, _ = run_headless(source, Settings())
    robot(fastdds.recorded(drive, SPOKEN, speed=2.0))
    with opened(f"dds://{domain}") as source, running(source, Settings()) as engine:
        live = until(engine, lambda now: now.scans >= pipeline.scans - 3, GIVE_UP_S)
    assert live.report.dropped == 0
    rows = min(live.scans, pipeline.scans)
    assert poses(live.playback.start_ns, live.trajectory[:rows]) == poses(
        pipeline.start_ns or 0, pipeline.trajectory[:rows]
    )


@pytest.mark.parametrize("end", quick_first([Peer.kill, Peer.leave]))
def test_a_robot_that_is_gone_is_waited_for(
    drive: Path, domain: int, robot: Callable[[Spoken], Peer], end: Callable[[Peer], None]
) -> None:
    """Killed or stopped in the middle, it is missed; when it is back, the same run goes on."""
    load_everything()
    first = robot(fastdds.recorded(drive, SPOKEN))
    with opened(f"dds://{domain}") as source, running(source, Settings()) as engine:
        before = until(engine, lambda now: now.scans >= 5, GIVE_UP_S)
        end(first)
        waiting = until(engine, lambda now: now.report.connected is False, GIVE_UP_S)
        robot(fastdds.recorded(drive, SPOKEN, begin=3.0))
        after = until(engine, lambda now: now.scans >= waiting.scans + 5, GIVE_UP_S)
    assert f"nobody publishes in DDS domain {domain}: start the robot's nodes" in waiting.playback.detail
    assert after.epoch == before.epoch


def test_a_damaged_message_is_counted_and_skipped(
    drive: Path, domain: int, robot: Callable[[Spoken], Peer]
) -> None:
    """By its topic and the reason; the scans around it are there."""
    spoken = fastdds.recorded(drive, ["/tf_static", "/scan"], speed=8.0)
    scans = [number for number, message in enumerate(spoken.messages) if message[0] == "/scan"]
    topic, after_ns, data = spoken.messages[scans[5]]
    spoken.messages[scans[5]] = topic, after_ns, data[:40]
    robot(spoken)
    with opened(f"dds://{domain}") as source:
        received = list(islice((item for item in source.items() if isinstance(item, LaserScan)), len(scans) - 1))
        skipped = dict(source.report.skipped)
    expected = [item for item in recorded(drive) if isinstance(item, LaserScan)]
    assert [scan.stamp_ns for scan in received] == [scan.stamp_ns for scan in expected if scan is not expected[5]]
    ((reason, count),) = skipped.items()
    assert "/scan" in reason
    assert "bytes that are no sensor_msgs/msg/LaserScan" in reason
    assert count == 1


def test_publishers_of_one_topic_may_offer_different_qualities(
    drive: Path, domain: int, robot: Callable[[Spoken], Peer]
) -> None:
    """Both are heard: of the second one, which offers less, too."""
    spoken = fastdds.recorded(drive, ["/tf_static", "/scan"], speed=8.0)
    middle = len(spoken.messages) // 2
    first = Spoken(spoken.types, {**spoken.kinds, "/scan": fastdds.RELIABLE}, spoken.messages[:middle])
    rest = [(topic, 0, data) for topic, _, data in spoken.messages[middle:]]
    second = Spoken({"/scan": spoken.types["/scan"]}, {"/scan": fastdds.BEST_EFFORT}, rest)
    expected = [item.stamp_ns for item in recorded(drive) if isinstance(item, LaserScan)]
    robot(first)
    with opened(f"dds://{domain}") as source:
        scans = (item.stamp_ns for item in source.items() if isinstance(item, LaserScan))
        received = list(islice(scans, middle - 1))
        robot(second)
        received += islice(scans, len(expected) - len(received))
    assert received == expected


def test_a_type_of_another_ros_is_told_by_its_hash(
    drive: Path, domain: int, robot: Callable[[Spoken], Peer]
) -> None:
    """Robots from ROS 2 Iron on tell it; a hash that no ROS 2 has is refused by name, others are read."""
    spoken = fastdds.recorded(drive, ["/tf_static", "/scan"], speed=8.0)
    spoken.told["/scan"] = f"enclave=/;typehash={fastdds.STORE.hash_rihs01('sensor_msgs/msg/LaserScan')};"
    imu = fastdds.recorded(drive, ["/imu/data_raw"])
    imu.told["/imu/data_raw"] = f"typehash=RIHS01_{'0' * 64};"
    robot(imu)
    with opened(f"dds://{domain}") as source:
        items = source.items()
        robot(spoken)
        received = list(islice(items, 20))
        skipped = list(source.report.skipped)
    assert len(received) == 20
    assert all(isinstance(item, LaserScan) for item in received)
    assert any("/imu/data_raw: its sensor_msgs/msg/Imu is that of no ROS 2" in reason for reason in skipped)


def test_a_domain_without_a_robot_is_waited_for(domain: int) -> None:
    """It is no error: the source says why it waits, and ends when it is closed."""
    with opened(f"dds://{domain}") as source:
        assert f"nobody publishes in DDS domain {domain}" in source.report.waiting
        source.close()
        assert list(source.items()) == []


def test_a_domain_that_cannot_be_joined_is_tried_again(domain: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """The network is missing: the source says so, with the remedy, and ends when it is closed."""
    monkeypatch.setenv("CYCLONEDDS_URI", LOOPBACK.replace("'lo'", "'missing'"))
    with opened(f"dds://{domain}") as source:
        received: list[object] = []
        listener = threading.Thread(target=lambda: received.extend(source.items()))
        listener.start()
        wait_for(lambda: "cannot be joined" in source.report.waiting)
        waiting = source.report.waiting
        source.close()
        listener.join(GIVE_UP_S)
    assert f"DDS domain {domain} cannot be joined: check the network" in waiting
    assert not listener.is_alive()
    assert received == []


@pytest.mark.parametrize("uri", ["dds://", "dds://x", "dds://300", "dds://-1", "dds://0/1", "dds://robot:7400"])
def test_a_bad_address_is_refused_with_the_form_of_a_good_one(uri: str) -> None:
    """The domain is a number that leaves room for its ports."""
    with pytest.raises(SourceError, match=r"give dds://DOMAIN, a number from 0 to 232, such as dds://0"):
        open_source(uri, SourceOptions())


def test_a_missing_extra_is_named_in_one_line() -> None:
    """The command ends with 2, and says what to install."""
    without = (
        "import sys; sys.modules['cyclonedds'] = None; from hectorscope.cli.main import main; sys.exit(main())"
    )
    command = [sys.executable, "-c", without, "live", "dds://0"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=GIVE_UP_S, check=False)
    assert done.returncode == 2
    assert "install hectorscope[dds]" in done.stderr
    assert "Traceback" not in done.stderr


def test_robots_are_found_by_their_topics(drive: Path, domain: int, robot: Callable[[Spoken], Peer]) -> None:
    """With their scans; a domain where nobody publishes is none."""
    address = f"dds://{domain}"
    assert look([address]) == []
    robot(fastdds.recorded(drive, SPOKEN))
    assert look([address]) == [Found(address, len(SPOKEN), ("/scan",))]


def test_results_are_heard_in_the_robots_own_domain(
    drive: Path, program: Path, domain: int, robot: Callable[[Spoken], Peer]
) -> None:
    """Each by its type; the map is kept for who comes later."""
    load_everything()
    robot(fastdds.recorded(drive, SPOKEN))
    address = f"dds://{domain}"
    node = subprocess.Popen([sys.executable, "-m", "hectorscope.cli.main", "serve", address, "--publish", address])
    words = [
        word
        for topic, msgtype in PUBLISHED.items()
        for word in (f"rt{topic}", fastdds.dds_type(msgtype), "L" if topic in LATCHED else "R")
    ]
    listener = Peer(program, "listen", str(domain), *words)
    try:
        check(heard(listener))
        late = Peer(program, "listen", str(domain), "rt/map", fastdds.dds_type(PUBLISHED["/map"]), "L")
        assert late.line().startswith("rt/map ")
        late.kill()
    finally:
        listener.kill()
        node.kill()
        node.wait()


def heard(listener: Peer) -> dict[str, Any]:
    """A message of every topic that is published."""
    found: dict[str, Any] = {}
    while len(found) < len(PUBLISHED):
        name, _, digits = listener.line().partition(" ")
        topic = name.removeprefix("rt")
        found[topic] = fastdds.STORE.deserialize_cdr(bytes.fromhex(digits), PUBLISHED[topic])
    return found


def test_results_cannot_be_published_in_a_domain_that_is_none() -> None:
    """The form of a good address is told."""
    with pytest.raises(PublishError, match=r"give dds://DOMAIN, a number from 0 to 232, such as dds://0"):
        open_bus("dds://300")


def test_results_cannot_be_published_in_a_domain_that_cannot_be_joined(monkeypatch: pytest.MonkeyPatch) -> None:
    """As with a network interface that is not there: the remedy is told."""
    monkeypatch.setenv("CYCLONEDDS_URI", LOOPBACK.replace("'lo'", "'missing'"))
    with pytest.raises(PublishError, match="dds://29 cannot be joined: check the network, and CYCLONEDDS_URI"):
        open_bus("dds://29")
