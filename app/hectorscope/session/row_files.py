"""The rows of a run beside its checkpoint: each one appends what is new, so that none of it is written twice."""

import hashlib
import os
from pathlib import Path
from typing import NamedTuple

import numpy as np

from hectorscope.run.rows import GrowingRows
from hectorscope.session.journal_files import ROWS, JournalError

PIECE = 1 << 14  # rows that are copied at a time


class KeptRows(NamedTuple):
    """What a checkpoint knows of rows: their file, how many, what `GrowingRows` compares, and their SHA-256."""

    name: str
    shape: tuple[int, int]
    compared: tuple[int, ...]
    sha256: str


class _RowFile:
    """A file of rows that only grows."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.rows: GrowingRows | None = None
        self._sum = hashlib.sha256()

    def append(self, rows: GrowingRows) -> KeptRows:
        """What is new of rows that continue those before; on the disk then. OSError if there is no room."""
        view = rows.view
        with self.path.open("ab") as file:
            for begin in range(len(self.rows or ()), len(view), PIECE):
                piece = view[begin : begin + PIECE].tobytes()
                file.write(piece)
                self._sum.update(piece)
            file.flush()
            os.fsync(file.fileno())
        self.rows = rows.share()
        return KeptRows(self.path.name, view.shape, tuple(rows.compared), self._sum.hexdigest())


class RowFiles:
    """Those of one journal, which is written by one thread. A run that was begun anew gets new files."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._files: dict[int, _RowFile] = {}
        self._made = 0

    def append(self, number: int, rows: GrowingRows) -> KeptRows:
        """The rows that a checkpoint has at a number of its own."""
        file = self._files.pop(number, None)  # a failure may leave half of a row in it
        if file is None or not rows.continues(file.rows):
            self._made += 1
            file = _RowFile(self._folder / ROWS.format(self._made))
            file.path.unlink(missing_ok=True)
        kept = file.append(rows)
        self._files[number] = file
        return kept

    def tidy(self) -> None:
        """Remove the files that the newest checkpoint does not name."""
        named = {file.path for file in self._files.values()}
        for path in self._folder.glob(ROWS.format("*")):
            if path not in named:
                path.unlink(missing_ok=True)


def read_rows(folder: Path, kept: KeptRows) -> GrowingRows:
    """Rows as a checkpoint had them; JournalError if the file is damaged or gone."""
    path = folder / Path(kept.name).name
    try:
        with path.open("rb") as file:
            content = file.read(8 * kept.shape[0] * kept.shape[1])
    except OSError as error:
        raise JournalError(
            f"{path} cannot be read ({error.strerror}): the run is made again from its messages"
        ) from error
    if hashlib.sha256(content).hexdigest() != kept.sha256:
        raise JournalError(f"{path} is damaged: the run is made again from its messages")
    return GrowingRows.of(np.frombuffer(content).reshape(kept.shape), kept.compared)
