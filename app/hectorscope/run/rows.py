"""Rows that only ever grow: what was handed out stays as it was."""

from collections.abc import Collection

import numpy as np
from numpy.typing import NDArray

Rows = NDArray[np.float64]


class _Store:
    """The array that several `GrowingRows` share, and how many of its rows were written."""

    def __init__(self, rows: Rows, used: int) -> None:
        self.rows, self.used = rows, used


class GrowingRows:
    """Append-only (n, columns) float64 in amortised constant time.

    Copies share what they have in common, also what one of them appended and another one appends after it: a run
    that goes the same way again writes nothing. besides: columns of which this does not depend, as they are
    measured anew each time; the first values stay.
    """

    def __init__(self, columns: int, besides: Collection[int] = ()) -> None:
        self._store = _Store(np.empty((1024, columns)), 0)
        self._count = 0
        self._compared = [column for column in range(columns) if column not in besides]

    def __len__(self) -> int:
        return self._count

    def share(self) -> "GrowingRows":
        """An independent copy; the rows so far are in memory once."""
        other = GrowingRows.__new__(GrowingRows)
        other._store, other._count, other._compared = self._store, self._count, self._compared
        return other

    def __getstate__(self) -> tuple[Rows, list[int]]:
        """For a file: the rows alone, without the room for more."""
        return self.view.copy(), self._compared

    def __setstate__(self, state: tuple[Rows, list[int]]) -> None:
        """Rows from a file."""
        rows, self._compared = state
        self._store, self._count = _Store(rows, len(rows)), len(rows)

    def append(self, row: tuple[float, ...]) -> None:
        """One more row; views taken before keep their length and their values."""
        self.extend(np.array([row]))

    def extend(self, rows: Rows) -> None:
        """More rows (n, columns)."""
        end = self._count + len(rows)
        if not self._are_there(rows):
            self._make_room(end)[self._count : end] = rows
            self._store.used = end
        self._count = end

    def _are_there(self, rows: Rows) -> bool:
        """Whether a copy has appended the same."""
        end = self._count + len(rows)
        if not self._count < end <= self._store.used:
            return end == self._count
        there = self._store.rows[self._count : end]
        return np.array_equal(there[:, self._compared], rows[:, self._compared], equal_nan=True)

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
