"""Opens whatever a person calls a bag: .bag, .mcap, .db3, or a folder of the last two."""

import re
from collections import Counter
from collections.abc import Collection, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import Any

from rosbags.interfaces import Connection, MessageDefinitionFormat

from hectorscope.common.paths import absence, exists
from hectorscope.inputs import SourceError
from hectorscope.ros.stream_recorder import PART
from hectorscope.sources._mcap_scan import scan_mcap
from hectorscope.sources._recording import NOTHING, Channel, Passed, Raw, Recording, by_scanning, joined
from hectorscope.sources._rosbag_index import BagIndex
from hectorscope.sources._rosbag_scan import scan_rosbag
from hectorscope.sources._sqlite_scan import scan_sqlite
from hectorscope.sources._unpacking import check_overlap, temporary_folder, unpack_file, unpacked

SUFFIXES = (".bag", ".active", ".mcap", ".db3")
_KINDS = {
    ".bag": ("ROS 1 bag", b"#ROSBAG V2.0"),
    ".active": ("ROS 1 bag", b"#ROSBAG V2.0"),
    ".mcap": ("MCAP file", b"\x89MCAP0\r\n"),
    ".db3": ("rosbag2 SQLite file", b"SQLite format 3\0"),
}
ROS1_SUFFIXES = (".bag", ".active")
LONGEST_METADATA = 2**21  # bytes; hundreds of topics take some 100 KB
ANCHOR = re.compile(rb"[\s,\[{]&\w")
# Our own recordings of a stream, and folders that a browser sent (web/uploads.py).
WITHOUT_METADATA = re.compile(r"stream_\d{4,}\.mcap|sent_\d{4}\.(mcap|db3)")
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
    """A rosbag2 folder; packed, or without a usable metadata.yaml, the files in it."""
    if packed := _files(path, ".zstd"):
        return _open_packed(path, packed)
    damage = "its metadata.yaml is missing"
    if exists(path / "metadata.yaml"):
        try:
            _check_metadata(path / "metadata.yaml")
            return _indexed(path, "rosbag2 folder")
        except Exception as error:  # as in _open_file
            damage = _reason(error)
    files = [file for file in _files(path, ".mcap", ".db3") if not is_just_begun(file)]
    if not files:
        raise SourceError(f"{path} is no rosbag2 folder ({damage}, no .mcap or .db3 file): give a recording")
    if not exists(path / "metadata.yaml") and all(WITHOUT_METADATA.fullmatch(file.name) for file in files):
        damage = ""
    return joined(path, [_open_file(file) for file in files], damage)


def _open_packed(path: Path, packed: list[Path]) -> Recording:
    """A folder whose files are packed: they are unpacked elsewhere for as long as the recording is open."""
    with ExitStack() as stack:
        folder = Path(stack.enter_context(temporary_folder()))
        for file in packed:
            unpack_file(file, folder / file.stem)
        plain = [file for file in _files(path, ".mcap", ".db3") if not exists(folder / file.name)]
        files = sorted([*_files(folder, ".mcap", ".db3"), *plain], key=_natural)
        if not files:
            raise SourceError(f"{path} is no rosbag2 folder (no .mcap.zstd or .db3.zstd file): give a recording")
        try:
            recording = joined(path, [_open_file(file) for file in files], "")
        except SourceError as error:
            raise SourceError(str(error).replace(str(folder), str(path))) from error
        stack.callback(recording.close)
        return replace(recording, container="rosbag2 folder", close=stack.pop_all().close)


def _files(folder: Path, *suffixes: str) -> list[Path]:
    """The files of a folder that end so, part 10 behind part 9."""
    found = [file for suffix in suffixes for file in folder.glob(f"*{suffix}")]
    return sorted(filter(Path.is_file, found), key=_natural)


def is_just_begun(file: Path) -> bool:
    """Whether it is a file of our own recorder into which nothing was written before it was killed."""
    return PART.fullmatch(file.name) is not None and file.stat().st_size < len(_KINDS[".mcap"][1])


def _check_metadata(path: Path) -> None:
    """ValueError for a description that may stand for much more than it is long."""
    if path.stat().st_size > LONGEST_METADATA:
        raise ValueError(f"its metadata.yaml has more than {LONGEST_METADATA} bytes")
    if ANCHOR.search(path.read_bytes()):
        raise ValueError("its metadata.yaml repeats itself by anchors")


def _open_file(path: Path) -> Recording:
    container = _recognise(path)
    try:
        return _indexed(path, container)
    except Exception as error:  # the parser's ways to stumble over a damaged file are many
        reason = _reason(error)
    if path.suffix == ".db3":
        return by_scanning(path, container, lambda: scan_sqlite(path), reason)
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
        raise SourceError(f"{path} is not a {container}: it begins with {begin!r} in place of {magic!r}: give one")
    return container


def _indexed(path: Path, container: str) -> Recording:
    """By the container's own index."""
    return _rosbag(path, container) if path.suffix in ROS1_SUFFIXES else _rosbag2(path, container)


def _rosbag(path: Path, container: str) -> Recording:
    index = BagIndex(path)
    messages: Counter[Channel] = Counter()
    for channel, places in index.connections:
        messages[channel] += len(places)
    return Recording(path, container, messages, index.span_ns, index.messages)


def _rosbag2(path: Path, container: str) -> Recording:
    readers = _Readers(path)
    with readers.one() as reader:
        messages: Counter[Channel] = Counter()
        for connection in reader.connections:
            messages[_channel(connection)] += connection.msgcount
        span_ns = (reader.start_time, reader.end_time - 1)
        if messages.total() and any(
            type(time_ns) is not int or not 0 <= time_ns < LATEST_NS for time_ns in span_ns
        ):
            raise ValueError("its first or last time is none")

    def read(channels: Collection[Channel], passed: Passed = NOTHING) -> Iterator[Raw]:
        with readers.one() as reader:
            yield from _messages(reader, channels, passed, packed=readers.packed)

    return Recording(path, container, messages, span_ns, read, close=readers.close)


class _Readers:
    """Open readers of one recording, each for one reading at a time. packed: each message by itself, by zstd."""

    def __init__(self, path: Path) -> None:
        self.packed = False
        self._path = path
        self._idle: list[Any] = []
        self._closed = False

    @contextmanager
    def one(self) -> Iterator[Any]:
        """One that nobody else has."""
        try:
            reader = self._idle.pop()  # in one go, as two threads may want one
        except IndexError:
            reader = self._opened()
        try:
            yield reader
        finally:
            self._idle.append(reader)
            if self._closed:
                self.close()

    def _opened(self) -> Any:
        from hectorscope.sources._limited_readers import LimitedReader  # noqa: PLC0415

        reader = LimitedReader(self._path)
        reader.open()
        for storage in getattr(reader.storage, "storages", [reader.storage]):
            check_overlap(getattr(storage, "chunks", []))
        if reader.compression_mode == "message":  # the library would unpack it whatever becomes of it
            self.packed = True
            reader.storage.metadata = reader.storage.metadata._replace(compression_mode=None)
        return reader

    def close(self) -> None:
        """Close those that are not in use, and from now on each that has been used."""
        self._closed = True
        while self._idle:
            self._idle.pop().close()


def _messages(reader: Any, channels: Collection[Channel], passed: Passed, *, packed: bool) -> Iterator[Raw]:
    """Those of some channels, behind those passed. packed: each message by itself."""
    known = {connection.id: _channel(connection) for connection in reader.connections}
    wanted = [connection for connection in reader.connections if known[connection.id] in channels]
    if wanted:
        start = passed.time_ns if passed.same else None  # they come by time, and those of one time as ever
        for connection, log_ns, data in islice(reader.messages(wanted, start), passed.same, None):
            yield Raw(known[connection.id], log_ns, _message(data) if packed else data)


def _message(data: Any) -> Any:
    """What a packed message holds; what is none stays as it is, to be counted as such."""
    try:
        return unpacked("zstd", data)
    except (RuntimeError, TypeError):
        return data


def _channel(connection: Connection) -> Channel:
    definition, form = connection.msgdef.data, connection.msgdef.format
    is_idl = form == MessageDefinitionFormat.IDL
    return Channel(connection.topic, connection.msgtype, "ros2", definition, "idl" if is_idl else "msg")


def _reason(error: Exception) -> str:
    """The parser's words, without the nested error that some carry behind."""
    text = str(error) or type(error).__name__
    return re.sub(r": \(.*\)$", "", text.splitlines()[0]).rstrip(".")


def _natural(path: Path) -> list[tuple[int, str]]:
    """Sorts part 10 behind part 9."""
    return [(int(part or 0), "") if part.isdigit() else (-1, part) for part in re.split(r"(\d+)", path.name)]
