"""Rows that only ever grow: what was handed out stays as it was."""

import mmap
import os
import tempfile
from collections.abc import Callable, Collection, Iterable
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

Rows = NDArray[np.float64]

ROOM = 1024
# From this size on rows lie in a file.
LARGE = 4 << 20


class _Store:
    """The array that several `GrowingRows` share, and how many of its rows were written.

    A large one is a file without a name, mapped for reading: the system takes the memory of its rows when it is
    short of it, so a run of many hours does not need memory for each of its scans. Without room on the disk rows
    stay in memory.
    """

    def __init__(self, columns: int) -> None:
        self.rows: Rows = np.empty((ROOM, columns))
        self.used = 0
        self._file: BinaryIO | None = None
        self._disk_fails = False

    def write(self, rows: Rows) -> None:
        """Rows (n, columns) behind those that were written."""
        end = self.used + len(rows)
        try:
            if end > len(self.rows):
                self._make_room(end)
            if self._file is not None:
                _put(self._file, rows, self.used)
        except OSError:
            self._disk_fails = True
            self._take_to_memory(end)
        if self._file is None:
            self.rows[self.used : end] = rows
        self.used = end

    def _make_room(self, count: int) -> None:
        """For so many rows; arrays that were handed out keep theirs. OSError if the disk has none."""
        row = self.rows.shape[1] * self.rows.itemsize
        if row * count < LARGE or self._disk_fails:
            self._take_to_memory(count)
            return
        if self._file is None:
            self._file = _unnamed_file()
            _put(self._file, self.rows[: self.used], 0)
        room = count + LARGE // row
        self._file.truncate(room * row)
        mapped = mmap.mmap(self._file.fileno(), room * row, access=mmap.ACCESS_READ)
        self.rows = np.frombuffer(mapped, np.float64).reshape(room, -1)

    def _take_to_memory(self, count: int) -> None:
        """With room for twice so many."""
        grown = np.empty((max(2 * count, ROOM), self.rows.shape[1]))
        grown[: self.used] = self.rows[: self.used]
        self.rows, self._file = grown, None


def _unnamed_file() -> BinaryIO:
    """Where large temporary files belong: /tmp is often memory itself. OSError without such a place."""
    usual = Path("/var/tmp")
    return tempfile.TemporaryFile(buffering=0, dir=os.environ.get("TMPDIR") or (usual if usual.is_dir() else None))


def _put(file: BinaryIO, rows: Rows, before: int) -> None:
    """Rows into a file, behind so many others. OSError if they do not all get there."""
    told = np.ascontiguousarray(rows, np.float64).tobytes()
    file.seek(rows.shape[1] * rows.itemsize * before)
    if file.write(told) != len(told):
        raise OSError("no room for all rows")


class GrowingRows:
    """Append-only (n, columns) float64 in amortised constant time.

    Copies share what they have in common, also what one of them appended and another one appends after it: a run
    that goes the same way again writes nothing. besides: columns of which this does not depend, as they are
    measured anew each time; the first values stay. compared: the others.
    """

    def __init__(self, columns: int, besides: Collection[int] = ()) -> None:
        self._store = _Store(columns)
        self._count = 0
        self.compared = [column for column in range(columns) if column not in besides]

    def __len__(self) -> int:
        return self._count

    @classmethod
    def of(cls, rows: Rows, compared: Iterable[int]) -> "GrowingRows":
        """Rows (n, columns) from a file, and the columns that are compared."""
        other = cls(rows.shape[1])
        other.compared = list(compared)
        other.extend(rows)
        return other

    def share(self) -> "GrowingRows":
        """An independent copy; the rows so far are in memory once."""
        other = GrowingRows.__new__(GrowingRows)
        other._store, other._count, other.compared = self._store, self._count, self.compared
        return other

    def continues(self, earlier: "GrowingRows | None") -> bool:
        """Whether these begin with all rows of another one, of which they were a copy."""
        return earlier is not None and earlier._store is self._store and len(earlier) <= len(self)

    def __reduce__(self) -> tuple[Callable[[Rows, Iterable[int]], "GrowingRows"], tuple[Rows, list[int]]]:
        """For another process: the rows alone, without the room for more."""
        return GrowingRows.of, (self.view.copy(), self.compared)

    def append(self, row: tuple[float, ...]) -> None:
        """One more row; views taken before keep their length and their values."""
        self.extend(np.array([row]))

    def extend(self, rows: Rows) -> None:
        """More rows (n, columns)."""
        if not self._are_there(rows):
            if self._store.used > self._count:
                self._part()
            self._store.write(rows)
        self._count += len(rows)

    def _are_there(self, rows: Rows) -> bool:
        """Whether a copy has appended the same."""
        end = self._count + len(rows)
        if not self._count < end <= self._store.used:
            return end == self._count
        there = self._store.rows[self._count : end]
        return np.array_equal(there[:, self.compared], rows[:, self.compared], equal_nan=True)

    def _part(self) -> None:
        """Go on apart from a copy that has gone another way."""
        known = self.view
        self._store = _Store(known.shape[1])
        self._store.write(known)

    @property
    def view(self) -> Rows:
        """(n, columns), read-only; no copy."""
        rows = self._store.rows[: self._count]
        rows.flags.writeable = False
        return rows
