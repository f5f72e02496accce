"""Readers of rosbag2 recordings by rosbags, with limits that it does not have of its own.

Its storage modules are loaded a second time for this, so that whoever uses rosbags beside us finds it as it is.
"""

from collections.abc import Mapping
from functools import partial
from importlib.util import find_spec, module_from_spec
from types import ModuleType, SimpleNamespace
from typing import Any

from rosbags.rosbag2 import Reader
from rosbags.rosbag2.reader import DirectoryReader

from hectorscope.sources._unpacking import LARGEST_CHUNK, unpacked


def _own_copy(name: str) -> ModuleType:
    """A module of our own, beside the one that others import."""
    spec = find_spec(name)
    assert spec is not None and spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


_mcap = _own_copy("rosbags.rosbag2.storage_mcap")
_mcap.DECOMPRESSORS.update({name: partial(unpacked, name) for name in ("lz4", "zstd")})

_sqlite3 = _own_copy("rosbags.rosbag2.storage_sqlite3")
_apsw = _sqlite3.apsw


def _limited_connection(*args: Any, **options: Any) -> Any:
    """A table may compute a message of a gigabyte from nothing: SQLite refuses it by TooBigError."""
    connection = _apsw.Connection(*args, **options)
    connection.limit(_apsw.SQLITE_LIMIT_LENGTH, LARGEST_CHUNK)
    return connection


_sqlite3.apsw = SimpleNamespace(**{**vars(_apsw), "Connection": _limited_connection})  # type: ignore[attr-defined]


class _LimitedFolder(DirectoryReader):
    STORAGE_PLUGINS: Mapping[str, Any] = {"mcap": _mcap.McapReader, "sqlite3": _sqlite3.Sqlite3Reader}


class LimitedReader(Reader):
    """Reads a folder, an .mcap or a .db3; no chunk and no row of it takes more than LARGEST_CHUNK bytes."""

    STORAGE_PLUGINS: Mapping[str, Any] = {
        "dir": _LimitedFolder,
        ".mcap": _mcap.McapReader,
        ".db3": _sqlite3.Sqlite3Reader,
    }
