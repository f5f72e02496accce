"""Recordings that are cut, damaged or hopeless, and messages in them that are wrong."""

import math
import re
import sqlite3
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from rosbags import rosbag1

from hectorscope.inputs import SourceError, SourceOptions
from hectorscope.ros.recorder import Recorder
from hectorscope.sources import _rosbag_index, _rosbag_scan, _unpacking
from hectorscope.sources.bag import open_bag
from slam_core.measurements import Imu, LaserScan
from tests.bags import CONTAINERS, TENTH, kinds, messages_for, open_run, small_run
from tests.ros_messages import SECOND, START, Messages, write_bag

MCAP_MESSAGE, MCAP_DATA_END = 0x05, 0x0F

LZ4 = b"\x04\x22\x4d\x18"  # how a frame of it begins


def cut(path: Path, keep: float) -> Path:
    """The first part of a file, as a full disk leaves it."""
    data = path.read_bytes()
    path.write_bytes(data[: int(len(data) * keep)])
    return path


@pytest.mark.parametrize("packing", [None, *rosbag1.Writer.CompressionFormat])
@pytest.mark.parametrize("keep", [0.5, 0.95])
def test_a_cut_rosbag_gives_what_is_left(
    tmp_path: Path, packing: rosbag1.Writer.CompressionFormat | None, keep: float
) -> None:
    """Chunks are read without an index, the cut one as far as it goes; the report warns."""
    ros = Messages("ros1")
    rng = np.random.default_rng(1)
    writer = rosbag1.Writer(tmp_path / "run.bag")
    if packing is not None:
        writer.set_compression(packing)
    with writer:
        connection = writer.add_connection("/scan", "sensor_msgs/msg/LaserScan", typestore=ros.store)
        for i in range(1000):
            message = ros.scan(i, ranges=rng.uniform(1.0, 9.0, 1000), angle_increment=0.001)
            writer.write(connection, START + i, ros.store.serialize_ros1(message, connection.msgtype))
    source = open_run(cut(tmp_path / "run.bag", keep))
    scans = list(source.items())
    assert len(scans) > 1000 * (keep - 0.3)
    assert [scan.stamp_ns - START for scan in scans] == list(range(len(scans)))
    assert source.span_ns == (START, scans[-1].stamp_ns)
    assert "run.bag is cut off or damaged" in source.report.notes[0]
    assert not source.report.skipped


def test_a_cut_mcap_gives_what_is_left(tmp_path: Path) -> None:
    """Whole chunks before the cut are read; the report warns."""
    ros = Messages()
    path = tmp_path / "run.mcap"
    with path.open("wb") as file:
        writer = McapWriter(file, chunk_size=10_000, compression=CompressionType.LZ4)
        writer.start(profile="ros2")
        schema = writer.register_schema("sensor_msgs/msg/LaserScan", "", b"")
        channel = writer.register_channel("/scan", "cdr", schema)
        for i in range(500):
            scan = ros.scan(i, ranges=np.ones(100), angle_increment=0.01)
            data = bytes(ros.store.serialize_cdr(scan, "sensor_msgs/msg/LaserScan"))
            writer.add_message(channel, log_time=START + i, data=data, publish_time=START + i)
        writer.finish()
    source = open_run(cut(path, 0.5))
    scans = list(source.items())
    assert 200 < len(scans) < 400
    assert [scan.stamp_ns - START for scan in scans] == list(range(len(scans)))
    assert "run.mcap is cut off or damaged" in source.report.notes[0]
    assert not source.report.skipped


@pytest.mark.parametrize("packing", list(rosbag1.Writer.CompressionFormat))
@pytest.mark.parametrize("keep", [0.9, 1.0], ids=["cut", "whole"])
def test_a_chunk_unpacks_to_its_limit_only(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, packing: rosbag1.Writer.CompressionFormat, keep: float
) -> None:
    """A small file may hold zeros without end: they are left out, and the report warns."""
    ros = Messages("ros1")
    writer = rosbag1.Writer(tmp_path / "run.bag")
    writer.set_compression(packing)
    with writer:
        connection = writer.add_connection("/scan", "sensor_msgs/msg/LaserScan", typestore=ros.store)
        for i, beams in enumerate((100, 100, 1_000_000)):
            message = ros.scan(i, ranges=np.ones(beams), angle_increment=1e-6)
            writer.write(connection, START + i, ros.store.serialize_ros1(message, connection.msgtype))
    path = tmp_path / "run.bag" if keep == 1.0 else cut(tmp_path / "run.bag", keep)
    monkeypatch.setattr(_unpacking, "LARGEST_CHUNK", 100_000)
    sizes: list[int] = []
    unpacked = _unpacking.unpacked

    def noted(*arguments: Any) -> bytes:
        content = unpacked(*arguments)
        sizes.append(len(content))
        return content

    monkeypatch.setattr(_rosbag_scan, "unpacked", noted)
    monkeypatch.setattr(_rosbag_index, "unpacked", noted)
    source = open_run(path)
    assert kinds(source) == {LaserScan: 2}
    assert 0 < max(sizes) <= 100_000
    assert "run.bag is cut off or damaged" in source.report.notes[0]


def test_messages_that_the_index_promises_are_missed(tmp_path: Path) -> None:
    """A record in the middle that became another one: fewer messages than the index counts are told."""
    ros, path = Messages(), tmp_path / "run.mcap"
    with path.open("wb") as file:
        writer = McapWriter(file, use_chunking=False)
        writer.start(profile="ros2")
        schema = writer.register_schema("sensor_msgs/msg/LaserScan", "", b"")
        channel = writer.register_channel("/scan", "cdr", schema)
        for i in range(90):
            scan = ros.scan(i, ranges=np.ones(100), angle_increment=0.01)
            data = bytes(ros.store.serialize_cdr(scan, "sensor_msgs/msg/LaserScan"))
            writer.add_message(channel, log_time=START + i, data=data, publish_time=START + i)
        writer.finish()
    damaged, at, messages = bytearray(path.read_bytes()), 8, 0
    while messages < 27:  # a record has its kind and its length in front
        messages += damaged[at] == MCAP_MESSAGE
        last, at = at, at + 9 + int.from_bytes(damaged[at + 1 : at + 9], "little")
    damaged[last] = MCAP_DATA_END
    path.write_bytes(damaged)
    source = open_run(path)
    assert kinds(source) == {LaserScan: 89}
    assert any("89 of 90 messages of /scan are there" in note for note in source.report.notes)


def test_a_cut_database_is_read_as_far_as_it_goes(tmp_path: Path) -> None:
    """SQLite refuses a cut file as a whole: its rows are read up to the cut, alone and in its folder."""
    folder = write_bag(tmp_path / "run", small_run(Messages(), 500))
    database = cut(next(folder.glob("*.db3")), 0.5)
    for path in (database, folder):
        source = open_run(path)
        assert 200 < kinds(source)[LaserScan] < 300
        assert "is cut off or damaged" in source.report.notes[0]


def test_a_database_that_is_cut_before_its_messages_holds_none(tmp_path: Path) -> None:
    """The message says why, and what to do."""
    database = next(write_bag(tmp_path / "run", small_run(Messages())).glob("*.db3"))
    database.write_bytes(database.read_bytes()[:1000])
    assert "run.db3 holds no messages (" in refusal(database)


def test_damage_in_the_middle_ends_the_reading_with_a_warning(tmp_path: Path) -> None:
    """A packed chunk that cannot be unpacked is found out while reading, behind a sound index: no crash."""
    ros = Messages("ros1")
    with Recorder(tmp_path / "run.bag") as recorder:
        for topic, message, time_ns in small_run(ros):
            recorder.write(topic, message, START + time_ns)
    data = bytearray((tmp_path / "run.bag").read_bytes())
    begin = data.index(LZ4) + 10
    data[begin : begin + 100] = bytes(100)
    (tmp_path / "run.bag").write_bytes(data)
    source = open_bag(tmp_path / "run.bag", SourceOptions())
    assert not list(source.items())
    assert "run.bag is cut off or damaged" in source.report.notes[0]
    assert "no scan of /scan can be read" in refusal(tmp_path / "run.bag")


def test_garbled_messages_are_counted(tmp_path: Path) -> None:
    """Bytes that are no scan are skipped by name, those around them are used."""
    database = next(write_bag(tmp_path / "run", small_run(Messages())).glob("*.db3"))
    with sqlite3.connect(database) as connection:
        connection.execute("UPDATE messages SET data = x'00010203' WHERE id IN (4, 7)")
    source = open_run(database)
    assert kinds(source)[LaserScan] == 48
    assert source.report.skipped == {"/scan: bytes that are no sensor_msgs/msg/LaserScan": 2}


# -------------------------------------------------------------------------------------------- bad input


def refusal(path: Path, **options: Any) -> str:
    """The message with which a recording is refused."""
    with pytest.raises(SourceError) as error:
        open_run(path, **options)
    return str(error.value)


@pytest.mark.parametrize("name", ["none.bag", "none.mcap", "none.db3", "none"])
def test_a_missing_file(tmp_path: Path, name: str) -> None:
    """The message names the path."""
    assert refusal(tmp_path / name) == f"{tmp_path / name} does not exist: check the path"


@pytest.mark.parametrize("suffix", [".bag", ".mcap", ""])
def test_a_name_that_no_file_can_have(tmp_path: Path, suffix: str) -> None:
    """The message gives the reason."""
    path = tmp_path / ("x" * 300 + suffix)
    assert refusal(path) == f"{path} cannot be reached (File name too long): check the path"


@pytest.mark.parametrize("name", ["text.bag", "text.mcap", "text.db3"])
def test_a_file_that_is_not_a_bag(tmp_path: Path, name: str) -> None:
    """The message says how the file begins, how such a file should begin, and what to give."""
    (tmp_path / name).write_text("hello, world, this is text")
    assert "it begins with b'hello" in refusal(tmp_path / name)
    assert refusal(tmp_path / name).endswith(": give one")


def test_a_file_of_another_kind(tmp_path: Path) -> None:
    """A suffix that no source knows is told with what is accepted."""
    (tmp_path / "notes.txt").write_text("hello")
    assert refusal(tmp_path / "notes.txt").endswith("give a bag, a CARMEN log or ws://HOST:PORT")
    (tmp_path / "notes").write_text("hello")
    assert "is no recording: give one that ends in .bag" in refusal(tmp_path / "notes")


def test_an_empty_file_and_an_empty_folder(tmp_path: Path) -> None:
    """Neither is mistaken for a bag without messages."""
    (tmp_path / "empty.bag").touch()
    assert refusal(tmp_path / "empty.bag").endswith("empty.bag is an empty file: record it again")
    (tmp_path / "folder").mkdir()
    assert "is no rosbag2 folder" in refusal(tmp_path / "folder")


@pytest.mark.parametrize("name", CONTAINERS)
def test_an_empty_bag(tmp_path: Path, name: str) -> None:
    """A recording without a message is told as such."""
    assert "holds no messages" in refusal(write_bag(tmp_path / name, []))


def test_a_bag_cut_within_its_header(tmp_path: Path) -> None:
    """Nothing to recover: one line that says so."""
    path = cut(write_bag(tmp_path / "run.bag", small_run(Messages("ros1"))), 0.01)
    assert "holds no messages" in refusal(path)


@pytest.mark.parametrize("name", CONTAINERS)
def test_a_bag_without_a_scan(tmp_path: Path, name: str) -> None:
    """The message lists what the bag holds instead."""
    path = write_bag(tmp_path / name, [("/imu", messages_for(name).imu(0), 0)])
    assert refusal(path) == (
        f"{path} has no laser scan (sensor_msgs/LaserScan): it holds /imu (sensor_msgs/msg/Imu)"
    )


def test_a_scan_whose_definition_is_refused_is_named(tmp_path: Path) -> None:
    """The message has the reason why it is not used, where no other scan is there."""
    ros, path = Messages(), tmp_path / "run.mcap"
    definition, _ = ros.store.generate_msgdef("sensor_msgs/msg/LaserScan")
    with path.open("wb") as file:
        writer = McapWriter(file)
        writer.start(profile="ros2")
        spoilt = definition.replace("float32 angle_min", "string angle_min").encode()
        schema = writer.register_schema("sensor_msgs/msg/LaserScan", "ros2msg", spoilt)
        channel = writer.register_channel("/scan", "cdr", schema)
        writer.add_message(channel, log_time=START, data=bytes(20), publish_time=START)
        writer.finish()
    assert refusal(path) == (
        f"{path} has no laser scan (sensor_msgs/LaserScan): it holds nothing of use; /scan is not used: "
        "its definition of sensor_msgs/msg/LaserScan has angle_min of another kind"
    )


def test_an_unknown_topic(tmp_path: Path) -> None:
    """The message lists the topics that would do."""
    path = write_bag(tmp_path / "run.mcap", small_run(Messages()))
    assert refusal(path, scan_topic="/laser") == (
        "there is no topic '/laser': --scan-topic takes one of sensor_msgs/LaserScan (/scan)"
    )
    assert "--truth-topic takes one of" in refusal(path, truth_topic="/scan")


@pytest.mark.parametrize("name", CONTAINERS)
def test_a_bag_full_of_mistakes_is_read_to_its_end(tmp_path: Path, name: str) -> None:
    """No beams, NaN angles, all-NaN ranges, backward time, NaN inertia: skipped by name; the rest is used."""
    ros = messages_for(name)
    entries = [
        ("/scan", ros.scan(0), 0),
        ("/scan", ros.scan(1, ranges=[]), 1),
        ("/scan", ros.scan(2, angle_min=math.nan), 2),
        ("/scan", ros.scan(3, ranges=[math.nan] * 3), 3),
        ("/scan", ros.scan(1), 4),
        ("/imu", ros.imu(4, forces=(math.nan, 0.0, 0.0)), 4),
        ("/scan", ros.scan(5, ranges=[1.0, 2.0]), 5),
        ("/imu", ros.imu(6), 6),
    ]
    source = open_run(write_bag(tmp_path / name, entries))
    assert kinds(source) == {LaserScan: 2, Imu: 1}
    assert sorted(source.report.skipped.items()) == [
        ("/imu: IMU message with NaN or infinite values", 1),
        ("/scan: scan whose angle_min or angle_increment is not a number", 1),
        ("/scan: scan with nothing but NaN ranges", 1),
        ("/scan: scan without beams", 1),
        ("/scan: time runs backwards: stamped before the message ahead of it", 1),
    ]
    assert "/scan: the number of beams varies" in source.report.notes


@pytest.mark.parametrize("name", CONTAINERS)
def test_a_bag_with_a_stamp_in_the_future_or_a_clock_that_was_set(tmp_path: Path, name: str) -> None:
    """A lone leap costs one message, a clock set back by an hour two; a pause of the robot costs none."""
    ros, hour, tenth = messages_for(name), 3600 * SECOND, SECOND // 10

    def read(off: dict[int, int], topic: str, make: Callable[[int], Any]) -> tuple[int, list[tuple[str, int]]]:
        entries = [(topic, make(i * tenth + off.get(i, 0)), i * tenth) for i in range(20)]
        entries += [("/scan", ros.scan(i * tenth), i * tenth) for i in range(20) if topic != "/scan"]
        path = tmp_path / f"{topic[1:]}_{len(off)}_{name}"
        source = open_run(write_bag(path, sorted(entries, key=lambda entry: entry[2])))
        return kinds(source)[LaserScan if topic == "/scan" else Imu], sorted(source.report.skipped.items())

    leap = "time leaps ahead: stamped far beyond the message ahead of it"
    back = "time runs backwards: stamped before the message ahead of it"
    assert read({5: 30 * SECOND}, "/scan", ros.scan) == (19, [(f"/scan: {leap}", 1)])
    assert read({7: 10**5 * hour}, "/imu", ros.imu) == (19, [(f"/imu: {leap}", 1)])
    set_back = dict.fromkeys(range(10, 20), -hour)
    assert read(set_back, "/scan", ros.scan) == (18, [(f"/scan: {back}", 2)])
    paused = [("/scan", ros.scan(ns), ns) for ns in (0, tenth, hour, hour + tenth)]
    source = open_run(write_bag(tmp_path / f"paused_{name}", paused))
    assert kinds(source) == {LaserScan: 4}
    assert not source.report.skipped


# A copy of a table has none of its constraints.
UNBOUND = "CREATE TABLE copy AS SELECT * FROM messages; DROP TABLE messages; ALTER TABLE copy RENAME TO messages;"


@pytest.mark.parametrize("value", ["NULL", "'text'", "1.5"])
@pytest.mark.parametrize("column", ["data", "timestamp"])
def test_database_entries_without_time_or_data_are_counted(tmp_path: Path, column: str, value: str) -> None:
    """A column may hold anything; the messages around them are read."""
    folder = write_bag(tmp_path / "run", small_run(messages_for("run")))
    (database,) = folder.glob("*.db3")
    with sqlite3.connect(database) as connection:
        connection.executescript(UNBOUND)
        connection.execute(f"UPDATE messages SET {column} = {value} WHERE id % 7 = 3")
    source = open_run(folder)
    read = sum(kinds(source).values())
    counted = {reason for reason in source.report.skipped if reason.endswith("entry whose time or data is none")}
    assert counted
    assert read + sum(source.report.skipped[reason] for reason in counted) >= 149


@pytest.mark.parametrize("start", ["1700000000000000000.5", "soon", "-99999999999999999999999", "1e40"])
def test_a_folder_whose_metadata_has_no_usable_time(tmp_path: Path, start: str) -> None:
    """Its files are read instead, and a note says why."""
    folder = write_bag(tmp_path / "run", small_run(messages_for("run")))
    metadata = folder / "metadata.yaml"
    text = re.sub(r"(nanoseconds_since_epoch: )\d+", rf"\g<1>{start}", metadata.read_text())
    metadata.write_text(text)
    source = open_run(folder)
    assert kinds(source)[LaserScan] == 50
    assert source.span_ns == (START, START + 50 * TENTH)
    assert any("damaged" in note for note in source.report.notes)
