"""Packed recordings that unpack to much more than they hold, or find no room."""

import re
import sqlite3
import struct
from pathlib import Path

import lz4.frame
import numpy as np
import pytest
import zstandard
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from rosbags import rosbag2

from hectorscope.inputs import SourceError
from hectorscope.ros.recorder import Recorder
from hectorscope.sources import _unpacking
from slam_core.measurements import LaserScan
from tests.bags import TENTH, kinds, messages_for, open_run, small_run
from tests.ros_messages import START, Messages, write_bag

CHUNK, SCANS, LIMIT = 0x06, 200, 100_000
ZEROS = bytes(10 * LIMIT)


def mcap(path: Path, compression: CompressionType, *, indexed: bool = True) -> Path:
    """Scans in chunks of some ten each."""
    ros = Messages()
    with path.open("wb") as file:
        writer = McapWriter(file, chunk_size=5_000, compression=compression)
        writer.start(profile="ros2")
        schema = writer.register_schema("sensor_msgs/msg/LaserScan", "", b"")
        channel = writer.register_channel("/scan", "cdr", schema)
        for i in range(SCANS):
            scan = ros.scan(i, ranges=np.ones(100), angle_increment=0.01)
            data = bytes(ros.store.serialize_cdr(scan, "sensor_msgs/msg/LaserScan"))
            writer.add_message(channel, log_time=START + i, data=data, publish_time=START + i)
        writer.finish()
    if not indexed:
        path.write_bytes(path.read_bytes()[:-40])
    return path


def with_bomb(path: Path, compression: str, said: int) -> Path:
    """Its second chunk holds zeros; `said` bytes by its own words. What follows the chunks is left out."""
    pack = zstandard.compress if compression == "zstd" else lz4.frame.compress
    whole, at, chunks = path.read_bytes(), 8, 0
    made = bytearray(whole[:at])
    while at < len(whole) - 8 and whole[at] not in (0x0F, 0x02):
        (size,) = struct.unpack_from("<Q", whole, at + 1)
        record, at = whole[at : at + 9 + size], at + 9 + size
        chunks += record[0] == CHUNK
        if record[0] == CHUNK and chunks == 2:
            packed, name = pack(ZEROS), compression.encode()
            times = record[9:25]
            body = times + struct.pack("<QII", said, 0, len(name)) + name + struct.pack("<Q", len(packed)) + packed
            record = bytes([CHUNK]) + struct.pack("<Q", len(body)) + body
        made += record
    path.write_bytes(made)
    return path


@pytest.fixture
def sizes(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """What the library's readers and ours have unpacked, in bytes, with a small limit."""
    monkeypatch.setattr(_unpacking, "LARGEST_CHUNK", LIMIT)
    found: list[int] = []
    read = _unpacking._read_zstd

    def noted(data: bytes, most: int) -> bytes:
        content = read(data, most)
        found.append(len(content))
        return content

    monkeypatch.setattr(_unpacking, "_read_zstd", noted)
    return found


@pytest.mark.parametrize("said", [len(ZEROS), 5_000], ids=["honest", "lying"])
def test_a_chunk_of_an_mcap_file_unpacks_to_its_limit_only(tmp_path: Path, sizes: list[int], said: int) -> None:
    """Zeros by the million: the chunk is left out, whatever size it claims, those around it are read."""
    source = open_run(with_bomb(mcap(tmp_path / "run.mcap", CompressionType.ZSTD), "zstd", said))
    assert SCANS - 20 <= kinds(source)[LaserScan] < SCANS
    assert 0 < max(sizes) <= LIMIT
    assert "run.mcap is cut off or damaged" in source.report.notes[0]


def test_chunks_of_one_time_are_not_all_unpacked_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each within its limit, but all of the same times: the file is read from front to back instead."""
    path = mcap(tmp_path / "run.mcap", CompressionType.ZSTD)
    assert not open_run(path).report.notes or "damaged" not in open_run(path).report.notes[0]
    monkeypatch.setattr(_unpacking, "LARGEST_AT_ONCE", 4_000)
    source = open_run(path)
    assert kinds(source) == {LaserScan: SCANS}
    assert "its chunks of one time unpack to 0 MB" in source.report.notes[0]


def packed_folder(path: Path) -> Path:
    """A folder whose database is packed as a whole."""
    with Recorder(path) as recorder:
        for topic, message, time_ns in small_run(messages_for("run")):
            recorder.write(topic, message, START + time_ns)
    return next(path.glob("*.db3.zstd"))


def test_a_packed_database_is_unpacked_once_and_removed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It lies in the folder for temporary files while the recording is open, and nothing is left there after."""
    packed, room = packed_folder(tmp_path / "run"), tmp_path / "tmp"
    room.mkdir()
    monkeypatch.setattr(_unpacking.tempfile, "tempdir", str(room))
    source = open_run(packed.parent)
    assert kinds(source)[LaserScan] == kinds(source)[LaserScan] == 50
    assert source.span_ns == (START, START + 50 * TENTH)
    assert len(list(room.rglob("*.db3"))) == 1
    source.close()
    assert not list(room.iterdir())


def test_a_packed_database_without_end_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What unpacks to hundreds of times its size is no recording; nothing of it stays on the disk."""
    packed, room = packed_folder(tmp_path / "run"), tmp_path / "tmp"
    room.mkdir()
    monkeypatch.setattr(_unpacking.tempfile, "tempdir", str(room))
    monkeypatch.setattr(_unpacking, "SMALL_FILE", LIMIT)
    packed.write_bytes(packed.read_bytes() + zstandard.compress(bytes(300 * packed.stat().st_size)))
    with pytest.raises(SourceError, match=r"run\.db3\.zstd unpacks to over \d+ MB, which no recording does"):
        open_run(packed.parent)
    assert not list(room.iterdir())


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
def test_without_room_the_message_names_the_folder(tmp_path: Path) -> None:
    """As with a TMPDIR that is full."""
    packed = packed_folder(tmp_path / "run")
    with pytest.raises(SourceError, match=r"cannot be unpacked in /dev \(No space left on device\): make room"):
        _unpacking.unpack_file(packed, Path("/dev/full"))


def test_a_cut_packed_database_names_its_own_place(tmp_path: Path) -> None:
    """The message has the path that was given, not that of the temporary file."""
    packed = packed_folder(tmp_path / "run")
    packed.write_bytes(packed.read_bytes()[:5000])
    with pytest.raises(SourceError, match=re.escape(str(packed.with_suffix("")))):
        open_run(packed.parent)


def test_packed_messages_unpack_to_their_limit_only(tmp_path: Path, sizes: list[int]) -> None:
    """Each message is packed by itself: one of zeros and one of nonsense are counted, the others are read."""
    ros = Messages()
    writer = rosbag2.Writer(tmp_path / "run", version=9)
    writer.set_compression(rosbag2.CompressionMode.MESSAGE, rosbag2.CompressionFormat.ZSTD)
    with writer:
        connection = writer.add_connection("/scan", "sensor_msgs/msg/LaserScan", typestore=ros.store)
        for i in range(50):
            scan = ros.scan(i * TENTH, ranges=np.ones(100), angle_increment=0.01)
            data = ros.store.serialize_cdr(scan, connection.msgtype)
            writer.write(connection, START + i * TENTH, data)
    (database,) = (tmp_path / "run").glob("*.db3")
    with sqlite3.connect(database) as opened:
        opened.execute("UPDATE messages SET data = ? WHERE id = 4", (zstandard.compress(ZEROS),))
        opened.execute("UPDATE messages SET data = x'0001' WHERE id = 7")
    source = open_run(tmp_path / "run")
    assert kinds(source) == {LaserScan: 48}
    assert max(sizes) == LIMIT
    assert source.report.skipped == {"/scan: bytes that are no sensor_msgs/msg/LaserScan": 2}


def test_a_description_that_repeats_itself_is_not_read(tmp_path: Path) -> None:
    """Anchors stand for more than there is memory: the files of the folder are read without it."""
    folder = write_bag(tmp_path / "run", small_run(messages_for("run")))
    metadata = folder / "metadata.yaml"
    levels = [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}' if i else 'x'] * 9)}]" for i in range(12)]
    text = metadata.read_text().replace("compression_format: ''", "compression_format: *a11")
    metadata.write_text("\n".join([*levels, text.replace("compression_mode: ''", "compression_mode: FILE")]))
    source = open_run(folder)
    assert kinds(source)[LaserScan] == 50
    assert "its metadata.yaml repeats itself by anchors" in source.report.notes[0]
