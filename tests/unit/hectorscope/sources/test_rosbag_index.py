"""The index of a ROS 1 bag: the same messages as by the library, in little memory."""

import struct
import tracemalloc
from pathlib import Path

import pytest
from rosbags import rosbag1

from hectorscope.sources._recording import Channel
from hectorscope.sources._rosbag_index import BagIndex
from hectorscope.sources._rosbag_scan import read_sized
from tests.bags import kinds, messages_for, open_run
from tests.ros_messages import START, Messages

TOPICS = ("/scan", "/imu", "//scan", "/empty")


def bag(path: Path, messages: int, chunk: int = 2_000) -> Path:
    """Short messages of three connections, two of one topic; chunks overlap, and some messages are of one time."""
    ros = Messages("ros1")
    writer = rosbag1.Writer(path)
    writer.set_compression(rosbag1.Writer.CompressionFormat.LZ4)
    writer.chunk_threshold = chunk
    with writer:
        connections = [
            writer.add_connection(topic, "std_msgs/msg/Header", typestore=ros.store, callerid=str(number))
            for number, topic in enumerate(TOPICS)
        ]
        for i in range(messages):
            data = ros.store.serialize_ros1(ros.header(i, ""), "std_msgs/msg/Header")
            writer.write(connections[i % 3], START + i - 7 * (i % 5), data)
    return path


@pytest.mark.parametrize("topics", [("/scan",), ("/imu", "/scan")])
def test_messages_are_those_of_the_library_by_time(tmp_path: Path, topics: tuple[str, ...]) -> None:
    """Also of a topic with two connections; those of one time in the order of the connections."""
    path = bag(tmp_path / "run.bag", 1000)
    index = BagIndex(path)
    with rosbag1.Reader(path) as reader:
        wanted = [connection for connection in reader.connections if connection.topic in topics]
        entries = [entry for c in wanted for entry in reader.messages([c])]
        assert index.span_ns == (reader.start_time, reader.end_time - 1)
    found = [(raw.channel.topic, raw.log_ns, raw.data) for raw in index.messages(channels(index, topics))]
    entries.sort(key=lambda entry: entry[1])
    assert found == [(connection.topic, time_ns, bytes(data)) for connection, time_ns, data in entries]


def channels(index: BagIndex, topics: tuple[str, ...]) -> list[Channel]:
    """Those of some topics."""
    return [channel for channel, _ in index.connections if channel.topic in topics]


def test_the_index_of_a_long_recording_is_small(tmp_path: Path) -> None:
    """It takes tens of bytes a message: two hours of a robot are millions."""
    path, messages = bag(tmp_path / "run.bag", 50_000, 100_000), 50_000
    tracemalloc.start()
    try:
        index = BagIndex(path)
        kept, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert sum(len(places) for _, places in index.connections) == messages
    assert kept < 24 * messages
    assert most < 64 * messages


def test_an_index_that_names_a_chunk_again_and_again_is_not_believed(tmp_path: Path) -> None:
    """Small records that stand for the same large index fill no memory: the file is read from front to back."""
    path = tmp_path / "run.bag"
    ros = messages_for("run.bag")
    with rosbag1.Writer(path) as writer:
        connection = writer.add_connection("/scan", "sensor_msgs/msg/LaserScan", typestore=ros.store)
        for i in range(50):
            writer.write(connection, START + i, ros.store.serialize_ros1(ros.scan(i), connection.msgtype))
    data, times = bytearray(path.read_bytes()), 200
    at = data.index(b"index_pos=") + len(b"index_pos=")
    with path.open("rb") as file:
        file.seek(int.from_bytes(data[at : at + 8], "little"))
        for _ in ("connection", "its data"):
            read_sized(file)
        record = file.read()
    count = data.index(b"chunk_count=") + len(b"chunk_count=")
    data[count : count + 4] = struct.pack("<I", times)
    path.write_bytes(data + record * (times - 1))
    source = open_run(path)
    assert sum(kinds(source).values()) == 50
    assert "more entries than there is room for" in source.report.notes[0]
