"""Rows that only ever grow: what was handed out stays as it was."""

import numpy as np
from numpy.typing import NDArray

Rows = NDArray[np.float64]


class _Store:
    """The array that several `GrowingRows` share, and how many of its rows were written."""

    def __init__(self, rows: Rows, used: int) -> None:
        self.rows, self.used = rows, used


class GrowingRows:
    """Append-only (n, columns) float64 in amortised constant time."""

    def __init__(self, columns: int) -> None:
        self._store = _Store(np.empty((1024, columns)), 0)
        self._count = 0

    def __len__(self) -> int:
        return self._count

    def share(self) -> "GrowingRows":
        """An independent copy; the rows so far are in memory once."""
        other = GrowingRows.__new__(GrowingRows)
        other._store, other._count = self._store, self._count
        return other

    def __getstate__(self) -> Rows:
        """For a file: the rows alone, without the room for more."""
        return self.view.copy()

    def __setstate__(self, rows: Rows) -> None:
        """Rows from a file."""
        self._store, self._count = _Store(rows, len(rows)), len(rows)

    def append(self, row: tuple[float, ...]) -> None:
        """One more row; views taken before keep their length and their values."""
        rows = self._make_room(self._count + 1)
        rows[self._count] = row
        self._count = self._store.used = self._count + 1

    def extend(self, rows: Rows) -> None:
        """More rows (n, columns)."""
        end = self._count + len(rows)
        self._make_room(end)[self._count : end] = rows
        self._count = self._store.used = end

    def _make_room(self, count: int) -> Rows:
        """The array with room for so many rows: another one if it is full, or if a copy has written further."""
        rows = self._store.rows
        if count > len(rows) or self._store.used > self._count:
            grown = np.empty((max(2 * count, 1024), rows.shape[1]))
            grown[: self._count] = rows[: self._count]
            self._store = _Store(grown, self._count)
        return self._store.rows

    @property
    def view(self) -> Rows:
        """(n, columns), read-only; no copy."""
        rows = self._store.rows[: self._count]
        rows.flags.writeable = False
        return rows
