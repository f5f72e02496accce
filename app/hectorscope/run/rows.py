"""Rows that only ever grow: what was handed out stays as it was."""

import numpy as np
from numpy.typing import NDArray

Rows = NDArray[np.float64]


class GrowingRows:
    """Append-only (n, columns) float64 in amortised constant time."""

    def __init__(self, columns: int) -> None:
        self._rows: Rows = np.empty((1024, columns))
        self._count = 0

    def __len__(self) -> int:
        return self._count

    def append(self, row: tuple[float, ...]) -> None:
        """One more row; views taken before keep their length and their values."""
        self._make_room(self._count + 1)
        self._rows[self._count] = row
        self._count += 1

    def extend(self, rows: Rows) -> None:
        """More rows (n, columns)."""
        end = self._count + len(rows)
        self._make_room(end)
        self._rows[self._count : end] = rows
        self._count = end

    def _make_room(self, count: int) -> None:
        if count > len(self._rows):
            grown = np.empty((2 * count, self._rows.shape[1]))
            grown[: self._count] = self._rows[: self._count]
            self._rows = grown

    @property
    def view(self) -> Rows:
        """(n, columns), read-only; no copy."""
        rows = self._rows[: self._count]
        rows.flags.writeable = False
        return rows
