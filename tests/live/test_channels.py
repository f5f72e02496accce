"""What the live source asks for and how it takes what it gets, on a server that says what the test tells it."""

import json
import struct
from collections.abc import Callable
from itertools import islice
from typing import Any

import numpy as np
import pytest
from rosbags.typesys import Stores, get_typestore

from hectorscope.inputs import SourceOptions
from hectorscope.sources import open_source
from hectorscope.sources._live import LiveSource
from slam_core.measurements import Imu, LaserScan

STORE = get_typestore(Stores.ROS2_HUMBLE)
HELLO = json.dumps({"op": "serverInfo", "name": "test", "capabilities": []})


def header(stamp_ns: int, frame: str) -> Any:
    stamp = STORE.types["builtin_interfaces/msg/Time"](stamp_ns // 10**9, stamp_ns % 10**9)
    return STORE.types["std_msgs/msg/Header"](stamp, frame)


def scan_bytes(stamp_ns: int) -> bytes:
    ranges, none = np.full(5, 2.0, np.float32), np.empty(0, np.float32)
    name = "sensor_msgs/msg/LaserScan"
    message = STORE.types[name](header(stamp_ns, "laser"), -1.0, 1.0, 0.5, 0.0, 0.1, 0.1, 30.0, ranges, none)
    return bytes(STORE.serialize_cdr(message, name))


def imu_bytes(stamp_ns: int) -> bytes:
    vector, quaternion = STORE.types["geometry_msgs/msg/Vector3"], STORE.types["geometry_msgs/msg/Quaternion"]
    unknown, name = np.zeros(9), "sensor_msgs/msg/Imu"
    message = STORE.types[name](
        header(stamp_ns, "imu"),
        quaternion(0.0, 0.0, 0.0, 1.0),
        unknown,
        vector(0.0, 0.0, 0.1),
        unknown,
        vector(0.0, 0.0, 9.8),
        unknown,
    )
    return bytes(STORE.serialize_cdr(message, name))


def offer(channel: int, topic: str, msgtype: str = "sensor_msgs/msg/LaserScan", **changes: Any) -> dict[str, Any]:
    text = STORE.generate_msgdef(msgtype, ros_version=2)[0]
    fields = {"id": channel, "topic": topic, "encoding": "cdr", "schemaName": msgtype, "schema": text}
    return fields | changes


def advertise(*offers: dict[str, Any]) -> str:
    return json.dumps({"op": "advertise", "channels": list(offers)})


def unadvertise(channel: int) -> str:
    return json.dumps({"op": "unadvertise", "channelIds": [channel]})


def data(channel: int, message: bytes) -> bytes:
    return b"\x01" + struct.pack("<IQ", channel, 1) + message


def asks_for(channel: int) -> str:
    return f'"channelId": {channel}}}'


def test_imu_and_scan_of_an_old_bridge_are_taken(scripted: Callable[..., Any]) -> None:
    """A server of the first protocol name is subscribed to by type, and its messages become measurements."""
    server = scripted(
        [HELLO, advertise(offer(3, "/scan"), offer(4, "/imu", "sensor_msgs/msg/Imu"))],
        protocol="foxglove.websocket.v1",
        answers={asks_for(3): [data(4, imu_bytes(5)), data(3, scan_bytes(100_000_007))]},
    )
    source = open_source(server.uri, SourceOptions())
    imu, scan = islice(source.items(), 2)
    source.close()
    assert isinstance(imu, Imu)
    assert imu.stamp_ns == 5
    np.testing.assert_array_equal(imu.angular_velocity, [0.0, 0.0, 0.1])
    assert isinstance(scan, LaserScan)
    assert scan.stamp_ns == 100_000_007
    np.testing.assert_array_equal(scan.ranges, np.full(5, 2.0, np.float32))
    assert source.report.read == {"/imu": 1, "/scan": 1}
    assert not source.report.skipped


def test_definitions_are_not_needed_for_standard_types(scripted: Callable[..., Any]) -> None:
    """A bridge that finds no definitions sends empty ones; the published ones are used."""
    server = scripted(
        [HELLO, advertise(offer(3, "/scan", schema=""))], answers={asks_for(3): [data(3, scan_bytes(7))]}
    )
    source = open_source(server.uri, SourceOptions())
    (scan,) = islice(source.items(), 1)
    source.close()
    assert scan.stamp_ns == 7


def test_only_what_is_used_is_subscribed(scripted: Callable[..., Any]) -> None:
    """Topics of other types, of unknown encodings, and second scanners stay where they are."""
    server = scripted(
        [
            HELLO,
            advertise(
                offer(1, "/camera", "sensor_msgs/msg/Image"),
                offer(2, "/scan_json", encoding="json"),
                offer(3, "/scan_rear"),
                offer(4, "/scan_front"),
            ),
        ],
        answers={asks_for(4): [data(4, scan_bytes(7))]},
    )
    source = open_source(server.uri, SourceOptions())
    list(islice(source.items(), 1))
    source.close()
    assert [json.loads(request)["subscriptions"] for request in server.asked] == [[{"id": 4, "channelId": 4}]]


def test_a_person_chooses_the_scanner(scripted: Callable[..., Any]) -> None:
    """--scan-topic takes another scanner, even if it is advertised after the one that would be taken."""
    server = scripted(
        [HELLO, advertise(offer(4, "/scan_front")), advertise(offer(3, "/scan_rear"))],
        answers={asks_for(3): [data(3, scan_bytes(7))]},
    )
    source = open_source(server.uri, SourceOptions(scan_topic="/scan_rear"))
    list(islice(source.items(), 1))
    source.close()
    assert source.report.read == {"/scan_rear": 1}


def test_topics_come_late_go_and_come_back(scripted: Callable[..., Any]) -> None:
    """A topic is subscribed whenever it appears, under whatever number, and keeps its part meanwhile."""
    server = scripted(
        [HELLO, advertise(), advertise(offer(3, "/scan"))],
        answers={
            asks_for(3): [
                data(3, scan_bytes(7)),
                unadvertise(3),
                advertise(offer(5, "/other_scan")),
                advertise(offer(9, "/scan")),
            ],
            asks_for(9): [data(9, scan_bytes(8))],
        },
    )
    source = open_source(server.uri, SourceOptions())
    assert [item.stamp_ns for item in islice(source.items(), 2)] == [7, 8]
    source.close()
    assert not any(asks_for(5) in request for request in server.asked)


def test_broken_frames_and_messages_are_counted_and_passed_over(scripted: Callable[..., Any]) -> None:
    """What cannot be read is named with its topic or address, and the stream goes on."""
    cut, alien = data(3, scan_bytes(7)[:20]), data(99, b"")
    server = scripted(
        [HELLO, "no json", advertise(offer(3, "/scan"))],
        answers={asks_for(3): [b"\x01", cut, alien, data(3, scan_bytes(8))]},
    )
    source = open_source(server.uri, SourceOptions())
    (scan,) = islice(source.items(), 1)
    source.close()
    assert scan.stamp_ns == 8
    assert source.report.skipped == {
        f"{server.uri}: text frame that is not JSON": 1,
        f"{server.uri}: message frame shorter than its head": 1,
        f"{server.uri}: message of a channel that was not asked for": 1,
        "/scan: bytes that are no sensor_msgs/msg/LaserScan": 1,
    }


@pytest.mark.parametrize(
    ("definition", "reason"),
    [
        ("float32 x\n" * 50_000, "its definition of sensor_msgs/msg/LaserScan is too long to be one"),
        (f"{'=' * 80}\nMSG: 1a/2b\nfloat32 x", "its definition of sensor_msgs/msg/LaserScan cannot be read"),
        ("float32 ranges", "its definition of sensor_msgs/msg/LaserScan has no header"),
    ],
)
def test_a_definition_that_is_none_does_no_harm(
    scripted: Callable[..., Any], definition: str, reason: str
) -> None:
    """A channel whose definition is nonsense is skipped by name; the others go on."""
    imu = offer(4, "/imu", "sensor_msgs/msg/Imu")
    server = scripted(
        [HELLO, advertise(offer(3, "/scan", schema=definition), imu)],
        answers={asks_for(4): [data(4, imu_bytes(5))]},
    )
    source = open_source(server.uri, SourceOptions())
    (item,) = islice(source.items(), 1)
    source.close()
    assert isinstance(item, Imu)
    assert source.report.skipped == {f"/scan: {reason}": 1}


def test_a_good_channel_takes_the_part_of_a_refused_one(scripted: Callable[..., Any]) -> None:
    """The refused one is named, and the next that is offered is asked for, on the same topic or on another one."""
    for topic in ("/scan", "/zscan"):
        bad = offer(3, "/scan", schema=STORE.generate_msgdef("sensor_msgs/msg/LaserScan")[0].replace("[]", ""))
        server = scripted(
            [HELLO, advertise(bad), advertise(offer(5, topic))], answers={asks_for(5): [data(5, scan_bytes(7))]}
        )
        source = open_source(server.uri, SourceOptions())
        (scan,) = islice(source.items(), 1)
        source.close()
        assert scan.stamp_ns == 7
        assert source.report.read == {topic: 1}
        assert source.report.skipped == {
            "/scan: its definition of sensor_msgs/msg/LaserScan has ranges of another kind": 1
        }


def test_a_refused_channel_keeps_no_part_for_another_type(scripted: Callable[..., Any]) -> None:
    """Its topic plays another part in another type: the laser's is free all the same."""
    bad = offer(3, "/data", schema=STORE.generate_msgdef("sensor_msgs/msg/LaserScan")[0].replace("[]", ""))
    imu = offer(4, "/data", "sensor_msgs/msg/Imu")
    server = scripted(
        [HELLO, advertise(bad, imu), advertise(offer(5, "/scan"))], answers={asks_for(5): [data(5, scan_bytes(7))]}
    )
    source = open_source(server.uri, SourceOptions())
    (scan,) = islice(source.items(), 1)
    source.close()
    assert isinstance(scan, LaserScan)


def test_a_topic_that_changes_its_type_gives_each_its_part(scripted: Callable[..., Any]) -> None:
    """A bridge may advertise it again with another type: every message goes where its channel's type belongs."""
    server = scripted(
        [HELLO, advertise(offer(3, "/data")), advertise(offer(4, "/data", "sensor_msgs/msg/Imu"))],
        answers={
            asks_for(3): [data(3, scan_bytes(7))],
            asks_for(4): [data(4, imu_bytes(8)), data(3, scan_bytes(9))],
        },
    )
    source = open_source(server.uri, SourceOptions())
    items = list(islice(source.items(), 3))
    source.close()
    assert sorted((type(item).__name__, item.stamp_ns) for item in items) == [
        ("Imu", 8),
        ("LaserScan", 7),
        ("LaserScan", 9),
    ]


def test_names_that_are_no_names_never_reach_the_code_generator(scripted: Callable[..., Any]) -> None:
    """A type's name is a name of a package and of a message, or the channel is not one of ours."""
    evil = "sensor_msgs/msg/LaserScan\nfloat32 x"
    server = scripted(
        [HELLO, advertise(offer(3, "/scan", schemaName=evil), offer(4, "/good"))],
        answers={asks_for(4): [data(4, scan_bytes(5))]},
    )
    source = open_source(server.uri, SourceOptions())
    list(islice(source.items(), 1))
    source.close()
    assert not any(asks_for(3) in request for request in server.asked)


def test_what_is_missing_is_said_with_the_remedy(scripted: Callable[..., Any]) -> None:
    """A connection without a laser, or without the topic asked for, waits and says for what."""
    server = scripted([HELLO, advertise(offer(4, "/imu", "sensor_msgs/msg/Imu"))])
    server.answers[asks_for(4)] = [data(4, imu_bytes(5))]
    for options, text in [
        (SourceOptions(), "none of the 1 topics is a LaserScan: start the laser's driver"),
        (SourceOptions(scan_topic="/rear"), "there is no topic '/rear': --scan-topic takes one of"),
    ]:
        source = open_source(server.uri, options)
        list(islice(source.items(), 1))
        assert text in source.report.waiting
        source.close()


def test_an_address_opens_the_live_source(scripted: Callable[..., Any]) -> None:
    """Addresses are told from paths by their form."""
    source = open_source(scripted([]).uri, SourceOptions())
    source.close()
    assert isinstance(source, LiveSource)
    assert source.live
    assert source.span_ns is None
