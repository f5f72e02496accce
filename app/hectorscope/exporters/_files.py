"""Files that are whole or not there at all, and the times in them."""

import io
import os
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

TOGETHER = 4096  # rows
PICTURES = "pictures.zip"  # of the marks


def exact_seconds(start_ns: int, seconds: float) -> str:
    """A time in seconds with all its nanoseconds, which the float of a date could not hold."""
    stamp_ns = start_ns + round(seconds * 1e9)
    return f"{stamp_ns // 10**9}.{stamp_ns % 10**9:09d}"


def lines_of(rows: NDArray[np.float64], line: Callable[[list[float]], str]) -> Iterator[bytes]:
    """A line for each row (n, columns), some thousand at a time: a long run has millions."""
    for begin in range(0, len(rows), TOGETHER):
        yield "".join(map(line, rows[begin : begin + TOGETHER].tolist())).encode()


def write_whole(path: Path, *parts: bytes | Iterable[bytes]) -> None:
    """Write under a temporary name beside `path`, then rename; an older file stays until all is on the disk."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        with temporary.open("wb") as file:
            for part in parts:
                file.writelines([part] if isinstance(part, bytes) else part)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)
    _sync(path.parent)


def unfinished(path: Path) -> Path:
    """The name that a file has while it grows, and that a killed process leaves."""
    return path.with_name(f"{path.stem}.unfinished{path.suffix}")


class GrowingFile(io.BufferedWriter):
    """A file that is written while the run goes on, and at once: a killed process leaves what it had.

    It stands under the name of `unfinished` until it is finished; an older file stays until then.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        super().__init__(io.FileIO(unfinished(path), "wb"))

    def write(self, content: Any, /) -> int:
        """Past this program's own memory; OSError where there is no room."""
        count = super().write(content)
        self.flush()
        return count

    def finish(self) -> None:
        """All is there: the file gets its name."""
        os.fsync(self.fileno())
        self.close()
        unfinished(self._path).replace(self._path)
        _sync(self._path.parent)


def _sync(folder: Path) -> None:
    """The new name is on the disk too, where folders can be asked for that."""
    if sys.platform == "win32":
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
