"""Files that are whole or not there at all, and the times in them."""

import io
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hectorscope.common.paths import sync_folder

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
        sync_folder(self._path.parent)
