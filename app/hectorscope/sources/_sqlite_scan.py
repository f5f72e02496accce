"""Reads a .db3 from front to back, as far as it goes: SQLite itself refuses a file that was cut."""

from collections.abc import Iterator
from contextlib import closing, suppress
from functools import cache
from pathlib import Path

import apsw

from hectorscope.ros.decode import DefinitionFormat
from hectorscope.sources._recording import Channel, Raw
from hectorscope.sources._unpacking import LARGEST_CHUNK

FORMS: dict[str, DefinitionFormat] = {"ros2msg": "msg", "ros2idl": "idl"}
NAME = "hectorscope-whole-files"
HEADER = 100  # bytes
LARGEST_PAGE = 65536  # bytes, which the header writes as 1
IN_ORDER = "SELECT topic_id, timestamp, data FROM messages NOT INDEXED"  # the index lies anywhere in the file
DEFINITIONS = "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions"


class _WholeFile(apsw.VFSFile):
    """As long as its header says; what is not there reads as zeros, which are no page."""

    def __init__(self, name: str | apsw.URIFilename | None, flags: list[int]) -> None:
        super().__init__("", name, flags)

    def xFileSize(self) -> int:
        header = super().xRead(HEADER, 0)
        page, pages = int.from_bytes(header[16:18], "big"), int.from_bytes(header[28:32], "big")
        return max(super().xFileSize(), pages * (LARGEST_PAGE if page == 1 else page))


class _WholeFiles(apsw.VFS):
    def __init__(self) -> None:
        super().__init__(NAME, "")

    def xOpen(self, name: str | apsw.URIFilename | None, flags: list[int]) -> apsw.VFSFile:
        return _WholeFile(name, flags)


@cache
def _whole_files() -> _WholeFiles:
    """Known to SQLite by NAME from the first file on that needs it."""
    return _WholeFiles()


def scan_sqlite(path: Path) -> Iterator[Raw]:
    """Every message that can still be read, in the order in which they were written."""
    with suppress(Exception), closing(_opened(path)) as database:  # a damaged file raises many kinds of errors
        channels = _channels(database)
        for topic, log_ns, data in database.execute(IN_ORDER):
            if topic in channels and type(log_ns) is int and log_ns >= 0 and isinstance(data, bytes):
                yield Raw(channels[topic], log_ns, data)


def _opened(path: Path) -> apsw.Connection:
    _whole_files()
    flags = apsw.SQLITE_OPEN_READONLY | apsw.SQLITE_OPEN_URI
    database = apsw.Connection(f"{path.absolute().as_uri()}?immutable=1", flags=flags, vfs=NAME)
    database.limit(apsw.SQLITE_LIMIT_LENGTH, LARGEST_CHUNK)
    return database


def _channels(database: apsw.Connection) -> dict[object, Channel]:
    definitions: dict[object, tuple[str, DefinitionFormat]] = {}
    with suppress(apsw.Error):  # recorders of long ago wrote none
        for kind, encoding, text in database.execute(DEFINITIONS):
            if encoding in FORMS:
                definitions[kind] = str(text), FORMS[str(encoding)]
    return {
        number: Channel(str(topic), str(kind), "ros2", *definitions.get(kind, ("", "msg")))
        for number, topic, kind in database.execute("SELECT id, name, type FROM topics")
    }
