"""Opens whatever a person calls a bag: .bag, .mcap, .db3, or a folder of the last two."""

import re
from collections import Counter
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rosbags import rosbag1, rosbag2
from rosbags.interfaces import Connection, MessageDefinitionFormat

from hectorscope.common.paths import absence, exists
from hectorscope.inputs import SourceError
from hectorscope.ros.decode import Generation
from hectorscope.sources._mcap_scan import scan_mcap
from hectorscope.sources._recording import Channel, Raw, Recording, by_scanning, joined
from hectorscope.sources._rosbag_index import BagIndex
from hectorscope.sources._rosbag_scan import scan_rosbag

SUFFIXES = (".bag", ".active", ".mcap", ".db3")
_KINDS = {
    ".bag": ("ROS 1 bag", b"#ROSBAG V2.0"),
    ".active": ("ROS 1 bag", b"#ROSBAG V2.0"),
    ".mcap": ("MCAP file", b"\x89MCAP0\r\n"),
    ".db3": ("rosbag2 SQLite file", b"SQLite format 3\0"),
}
LATEST_NS = 2**63  # times are signed numbers of 64 bits


def open_recording(path: Path) -> Recording:
    """The recording at `path`; SourceError if there is none, or nothing in it can be read."""
    if why := absence(path):
        raise SourceError(f"{path} {why}: check the path")
    recording = _open_folder(path) if path.is_dir() else _open_file(path)
    if not recording.messages.total():
        because = f" ({recording.damage})" if recording.damage else ""
        raise SourceError(f"{path} holds no messages{because}: record it again")
    return recording


def _open_folder(path: Path) -> Recording:
    """A rosbag2 folder; without a usable metadata.yaml, the files in it."""
    damage = "its metadata.yaml is missing"
    if exists(path / "metadata.yaml"):
        try:
            return _indexed(path, "rosbag2 folder")
        except Exception as error:  # as in _open_file
            damage = _reason(error)
    within = [file for suffix in (".mcap", ".db3") for file in path.glob(f"*{suffix}")]
    files = sorted(filter(Path.is_file, within), key=_natural)
    if not files:
        raise SourceError(f"{path} is no rosbag2 folder ({damage}, no .mcap or .db3 file): give a recording")
    return joined(path, [_open_file(file) for file in files], damage)


def _open_file(path: Path) -> Recording:
    container = _recognise(path)
    try:
        return _indexed(path, container)
    except Exception as error:  # the parser's ways to stumble over a damaged file are many
        reason = _reason(error)
    if path.suffix == ".db3":
        raise SourceError(f"{path} is damaged ({reason}): recover it with the .recover command of sqlite3")
    if path.suffix == ".mcap":
        damage = "" if "Profile is not ros2" in reason else reason
        return by_scanning(path, container, lambda: scan_mcap(path), damage)
    return by_scanning(path, container, lambda: scan_rosbag(path), reason)


def _recognise(path: Path) -> str:
    """The kind of a file, checked against its first bytes."""
    if path.suffix not in _KINDS:
        raise SourceError(f"{path} is no recording: give one that ends in {', '.join(SUFFIXES)}, or a folder")
    container, magic = _KINDS[path.suffix]
    try:
        with path.open("rb") as file:
            begin = file.read(len(magic))
    except OSError as error:
        raise SourceError(f"{path} cannot be opened ({error.strerror}): check its permissions") from error
    if not begin:
        raise SourceError(f"{path} is an empty file: record it again")
    if begin != magic:
        raise SourceError(f"{path} is not a {container}: it begins with {begin!r} in place of {magic!r}")
    return container


def _indexed(path: Path, container: str) -> Recording:
    """By the container's own index."""
    generation: Generation = "ros1" if path.suffix in (".bag", ".active") else "ros2"
    readers = _Readers(path, rosbag1.Reader if generation == "ros1" else rosbag2.Reader)
    with readers.one() as reader:
        messages: Counter[Channel] = Counter()
        for connection in reader.connections:
            messages[_channel(connection, generation)] += connection.msgcount
        span_ns = (reader.start_time, reader.end_time - 1)
        if messages.total() and any(
            type(time_ns) is not int or not 0 <= time_ns < LATEST_NS for time_ns in span_ns
        ):
            raise ValueError("its first or last time is none")
        index = BagIndex(reader) if generation == "ros1" else None

    def read(channels: Collection[Channel]) -> Iterator[Raw]:
        if index is not None:
            yield from _messages(index, channels, generation)
            return
        with readers.one() as reader:
            yield from _messages(reader, channels, generation)

    return Recording(path, container, messages, span_ns, read, close=readers.close)


class _Readers:
    """Open readers of one recording, each for one reading at a time: to open one may take unpacking all of it."""

    def __init__(self, path: Path, make: Any) -> None:
        self._path, self._make = path, make
        self._idle: list[Any] = []
        self._closed = False

    @contextmanager
    def one(self) -> Iterator[Any]:
        """One that nobody else has."""
        reader = self._idle.pop() if self._idle else self._opened()
        try:
            yield reader
        finally:
            self._idle.append(reader)
            if self._closed:
                self.close()

    def _opened(self) -> Any:
        reader = self._make(self._path)
        reader.open()
        return reader

    def close(self) -> None:
        """Close those that are not in use, and from now on each that has been used."""
        self._closed = True
        while self._idle:
            self._idle.pop().close()


def _messages(container: Any, channels: Collection[Channel], generation: Generation) -> Iterator[Raw]:
    """Those of some channels, by the container's own `connections` and `messages`."""
    known = {connection.id: _channel(connection, generation) for connection in container.connections}
    wanted = [connection for connection in container.connections if known[connection.id] in channels]
    if wanted:
        for connection, log_ns, data in container.messages(wanted):
            yield Raw(known[connection.id], log_ns, data)


def _channel(connection: Connection, generation: Generation) -> Channel:
    definition, form = connection.msgdef.data, connection.msgdef.format
    is_idl = form == MessageDefinitionFormat.IDL
    return Channel(connection.topic, connection.msgtype, generation, definition, "idl" if is_idl else "msg")


def _reason(error: Exception) -> str:
    """The parser's words, without the nested error that some carry behind."""
    text = str(error) or type(error).__name__
    return re.sub(r": \(.*\)$", "", text.splitlines()[0]).rstrip(".")


def _natural(path: Path) -> list[tuple[int, str]]:
    """Sorts part 10 behind part 9."""
    return [(int(part or 0), "") if part.isdigit() else (-1, part) for part in re.split(r"(\d+)", path.name)]
