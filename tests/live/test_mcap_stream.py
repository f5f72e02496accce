"""An MCAP that is written while it is read."""

import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

import pytest

from hectorscope.inputs import SourceError, SourceOptions
from hectorscope.sources import open_source
from tests.live.measurements import GIVE_UP_S, opened, plain, recorded

PIECE = 4096  # bytes
AS_PIPE = """
import sys
from hectorscope.inputs import SourceOptions
from hectorscope.sources import open_source
source = open_source("-", SourceOptions())
print(sum(1 for _ in source.items()), source.report.waiting)
"""


@pytest.fixture
def growing(drive: Path, tmp_path: Path) -> Iterator[Path]:
    """A file to which the recording is appended piece by piece, and which stops before its end."""
    path, stop = tmp_path / "growing.mcap", threading.Event()
    content = drive.read_bytes()
    path.touch()

    def write() -> None:
        with path.open("ab", buffering=0) as file:
            for begin in range(0, len(content), PIECE):
                if stop.is_set():
                    return
                file.write(content[begin : begin + PIECE])
                time.sleep(0)

    thread = threading.Thread(target=write)
    thread.start()
    yield path
    stop.set()
    thread.join()


def test_a_growing_file_gives_the_measurements_of_the_whole(drive: Path, growing: Path) -> None:
    """Every measurement, bit by bit the same and in the same order; the stream ends with the MCAP."""
    with opened(f"file://{growing}") as source:
        received = [plain(item) for item in source.items()]
        assert source.report.waiting == f"{growing} has ended"
    assert received == [plain(item) for item in recorded(drive)]


def test_a_file_that_does_not_grow_is_waited_for(drive: Path, tmp_path: Path) -> None:
    """What is there is read; then the source waits, says so, and ends when it is closed."""
    path = tmp_path / "cut.mcap"
    path.write_bytes(drive.read_bytes()[:-2000])
    with opened(f"file://{path}") as source:
        items = source.items()
        assert len(list(islice(items, 100))) == 100
        rest = threading.Thread(target=lambda: list(items))
        rest.start()
        ends = time.monotonic() + GIVE_UP_S
        while not source.report.waiting and time.monotonic() < ends:
            time.sleep(0.05)
        assert source.report.waiting == f"nothing new comes from {path}: start what writes it"
        source.close()
        rest.join(5.0)
        assert not rest.is_alive()


def test_the_standard_input_is_read_to_its_end(drive: Path) -> None:
    """As behind a pipe."""
    command = [sys.executable, "-c", AS_PIPE]
    result = subprocess.run(command, input=drive.read_bytes(), capture_output=True, check=True)
    count, _, waiting = result.stdout.decode().strip().partition(" ")
    assert int(count) == len(recorded(drive))
    assert waiting == "the standard input has ended"


def test_what_is_no_mcap_is_named(tmp_path: Path) -> None:
    """A missing file and a socket at once, another file when it is read."""
    with pytest.raises(SourceError, match=r"does not exist.*: give an \.mcap"):
        open_source(f"file://{tmp_path / 'none.mcap'}", SourceOptions())
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(str(tmp_path / "socket"))
        with pytest.raises(SourceError, match=r"socket cannot be read \(.*: give an \.mcap"):
            open_source(f"file://{tmp_path / 'socket'}", SourceOptions())
    other = tmp_path / "other.mcap"
    other.write_bytes(b"no mcap at all, but long enough to tell")
    with opened(f"file://{other}") as source, pytest.raises(SourceError, match="is no MCAP or is damaged"):
        list(source.items())
