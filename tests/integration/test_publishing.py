"""What a run publishes, whatever the protocol."""

import math
from pathlib import Path

import numpy as np
import pytest
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

from hectorscope.inputs import SourceOptions
from hectorscope.publishing import PublishError, open_bus
from hectorscope.publishing.publishing import MAP_NS, Publishing
from hectorscope.results.topics import DIAGNOSTICS, MAP, PATH, POSE, TF, Message
from hectorscope.run.headless import run_headless
from hectorscope.run.settings import Settings
from hectorscope.simulation import SimulateOptions, simulate
from hectorscope.sources import open_source
from slam_core import geometry
from slam_core.measurements import Transform
from tests.ros_messages import SECOND, START, Messages, write_bag

TENTH = SECOND // 10


class Heard:
    """A bus that keeps what it gets. deaf: topics that nobody hears."""

    def __init__(self, *deaf: str) -> None:
        self.messages: list[Message] = []
        self.deaf = deaf

    def wants(self, topic: str) -> bool:
        """Whether it is heard."""
        return topic not in self.deaf

    def publish(self, message: Message) -> None:
        """Keep it."""
        assert len(message.content) > 4
        self.messages.append(message)

    def close(self) -> None:
        """Nothing to let go of."""

    def of(self, topic: str) -> list[Message]:
        """In order."""
        return [message for message in self.messages if message.topic == topic]


class Full(Heard):
    """A bus that fails."""

    def publish(self, message: Message) -> None:
        """Not today."""
        raise OSError("the buffer is full")


@pytest.fixture(scope="module")
def drive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Five seconds through the arena, whose tf knows nothing above the base."""
    path = tmp_path_factory.mktemp("drive") / "drive.mcap"
    simulate(SimulateOptions(scenario="arena", duration=5.0, scan_rate=10.0, beams=181, out=path))
    return path


@pytest.fixture(scope="module")
def with_odometry(drive: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same with a robot that says where its base is in odom, and with somebody's odom in map."""
    ros, entries = Messages(), []
    with AnyReader([drive], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
        for connection, time_ns, data in reader.messages():
            entries.append((connection.topic, reader.deserialize(data, connection.msgtype), time_ns - START))
        begin = reader.start_time - START
    for tick in range(100):
        at = begin + tick * TENTH // 2
        x, yaw = odometry(at * 1e-9)
        turned = ros.quaternion(math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2))
        entries.append(("/tf", ros.tf(at, "odom", "base_link", (x, 0.0, 0.0), turned), at))
        entries.append(("/tf", ros.tf(at, "map", "odom", (9.0, 9.0, 0.0)), at))
    path = tmp_path_factory.mktemp("odometry") / "drive.mcap"
    return write_bag(path, sorted(entries, key=lambda entry: entry[2]))


def odometry(seconds: float) -> tuple[float, float]:
    """X [m] and yaw [rad] of the base in odom."""
    return 3.0 + 0.1 * seconds, 0.05 * seconds


def published(path: Path, *buses: Heard) -> None:
    """Follow a file as the stream of a robot, to its end; a plain loop gives up no scan."""
    source = open_source(f"file://{path}", SourceOptions(own_frame="map"))
    publishing = Publishing(buses, source)
    run_headless(source, Settings(), observe=publishing.add)
    publishing.close()


def placed(message: Message) -> tuple[str, str, Transform]:
    """Parent, child and T_parent_child of a transform."""
    (stamped,) = message.value.transforms
    t, q = stamped.transform.translation, stamped.transform.rotation
    T = Transform(np.array([t.x, t.y, t.z]), np.array([q.w, q.x, q.y, q.z]))
    return stamped.header.frame_id, stamped.child_frame_id, T


def test_every_scan_has_a_pose_and_a_transform_and_the_map_comes_now_and_then(drive: Path) -> None:
    """The pose is that of the transform, as no other frame is above the base; path and map are those so far."""
    heard = Heard()
    published(drive, heard)
    poses, transforms = heard.of(POSE), heard.of(TF)
    assert len(poses) == len(transforms) > 2
    for pose, transform in zip(poses, transforms, strict=True):
        parent, child, T = placed(transform)
        position = pose.value.pose.pose.position
        assert (parent, child) == ("map", "base_link")
        np.testing.assert_array_equal(T.translation, [position.x, position.y, position.z])
    maps = [message.stamp_ns for message in heard.of(MAP)]
    assert maps == [message.stamp_ns for message in heard.of(PATH)]
    assert len(maps) > 1
    assert np.diff(maps).min() >= MAP_NS
    assert 100 in heard.of(MAP)[-1].value.data
    assert len(heard.of(DIAGNOSTICS)) > 1


def test_the_frame_above_the_base_is_placed_in_the_map(with_odometry: Path) -> None:
    """A robot's base has odom as its parent: odom is placed in the map, so that both together give the pose.

    What tf says of the map itself comes from here, and is not taken for the robot's.
    """
    heard = Heard()
    published(with_odometry, heard)
    assert len(heard.of(TF)) == len(heard.of(POSE)) > 2
    for pose, transform in zip(heard.of(POSE), heard.of(TF), strict=True):
        parent, child, T_map_odom = placed(transform)
        assert (parent, child) == ("map", "odom")
        x, yaw = odometry((pose.stamp_ns - START) * 1e-9)
        T_odom_base = Transform(
            np.array([x, 0.0, 0.0]), np.array([math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)])
        )
        position = pose.value.pose.pose.position
        np.testing.assert_allclose(
            geometry.chain(T_map_odom, T_odom_base).translation,
            [position.x, position.y, position.z],
            atol=0.03,
        )


def test_what_nobody_hears_is_not_made(drive: Path) -> None:
    """A map takes time to make."""
    heard = Heard(MAP, PATH)
    published(drive, heard)
    assert not heard.of(MAP)
    assert not heard.of(PATH)
    assert heard.of(POSE)


def test_a_bus_that_fails_is_told_once_and_the_run_goes_on(drive: Path, caplog: pytest.LogCaptureFixture) -> None:
    """The run ends as without it, and others hear everything."""
    heard = Heard()
    published(drive, Full(), heard)
    assert heard.of(POSE)
    assert [record.message for record in caplog.records] == [
        "the results of a scan were not published: the buffer is full"
    ]


@pytest.mark.parametrize(
    ("address", "why"),
    [
        ("robot", "give dds://DOMAIN or ws://127.0.0.1:PORT or zenoh://HOST:PORT/DOMAIN"),
        ("http://127.0.0.1:80", "results cannot be published at http://127.0.0.1:80"),
        ("ws://0.0.0.0:8766", "open to the network"),
        ("ws://robot.local:8766", "open to the network"),
        ("ws://127.0.0.1", "such as ws://127.0.0.1:8766"),
        ("ws://127.0.0.1:99999", "such as ws://127.0.0.1:8766"),
        ("zenoh://a b", "such as zenoh://robot:7447/0"),
        ("zenoh://127.0.0.1:1", "no Zenoh router answers at zenoh://127.0.0.1:1"),
    ],
)
def test_an_address_that_is_of_no_use_is_told_with_the_remedy(address: str, why: str) -> None:
    """Without a token nothing is served to the network."""
    with pytest.raises(PublishError, match=why):
        open_bus(address)
