"""Limits within rosbags' readers."""

import sqlite3
import subprocess
import sys
from pathlib import Path

import lz4.frame
import pytest
import zstandard

from hectorscope.inputs import SourceError
from hectorscope.sources import _limited_readers
from hectorscope.sources._unpacking import LARGEST_CHUNK
from tests.bags import open_run, small_run
from tests.ros_messages import Messages, write_bag

ZEROS = bytes(3_000_000)


@pytest.mark.parametrize("compression", ["zstd", "lz4"])
def test_a_chunk_unpacks_to_the_limit_only(compression: str) -> None:
    """The size in the index bounds it too: what is longer is cut, what claims too much is not unpacked at all."""
    unpack = _limited_readers._mcap.DECOMPRESSORS[compression]
    packed = (zstandard.compress if compression == "zstd" else lz4.frame.compress)(ZEROS)
    assert len(unpack(packed, len(ZEROS))) == len(ZEROS)
    assert len(unpack(packed, 1000)) == 1000
    assert unpack(packed, LARGEST_CHUNK + 1) == b""


def computed(folder: Path, table: str, column: str) -> Path:
    """A database with a column that is computed from nothing, a byte longer than the limit."""
    path = next(write_bag(folder, small_run(Messages())).glob("*.db3"))
    with sqlite3.connect(path) as base:
        base.execute(f"ALTER TABLE {table} RENAME COLUMN {column} TO kept")
        long = f"zeroblob({LARGEST_CHUNK + 1})"
        base.execute(f"ALTER TABLE {table} ADD COLUMN {column} BLOB GENERATED ALWAYS AS ({long}) VIRTUAL")
    base.close()
    return path


@pytest.mark.parametrize(("table", "column"), [("messages", "data"), ("topics", "name")])
def test_a_database_computes_no_more_than_the_limit(tmp_path: Path, table: str, column: str) -> None:
    """A row longer than any message of a robot is an error of the file, in one message."""
    path = computed(tmp_path / "run", table, column)
    with pytest.raises(SourceError, match="too big"):
        open_run(path)


def test_the_library_itself_is_left_as_it_is() -> None:
    """Somebody who uses rosbags beside us gets its own functions."""
    script = """
from rosbags.rosbag2 import Reader, storage_mcap, storage_sqlite3
before = dict(storage_mcap.DECOMPRESSORS), dict(Reader.STORAGE_PLUGINS), storage_sqlite3.apsw
import hectorscope.cli.main, hectorscope.sources.bag
assert before == (storage_mcap.DECOMPRESSORS, Reader.STORAGE_PLUGINS, storage_sqlite3.apsw)
"""
    subprocess.run([sys.executable, "-c", script], check=True)
