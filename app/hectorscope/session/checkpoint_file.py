"""The checkpoint of a journal as a file: a pickle, so one that others could write is never read."""

import hashlib
import io
import os
import pickle
import stat
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from itertools import count
from pathlib import Path
from typing import Any

from hectorscope.common.kernel_cache import version
from hectorscope.common.paths import write_whole
from hectorscope.inputs import Item
from hectorscope.run.annotations import Annotations
from hectorscope.run.checkpoints import Checkpoint
from hectorscope.run.rows import GrowingRows
from hectorscope.run.settings import Settings
from hectorscope.session.journal_files import CHECKPOINT, JournalError
from hectorscope.session.row_files import KeptRows, RowFiles, read_rows

MAGIC = "hectorscope-checkpoint"


@dataclass(frozen=True, slots=True)
class Position:
    """The last item that a checkpoint has had, by its kind and time: a stream has no numbers."""

    kind: str
    stamp_ns: int

    @classmethod
    def of(cls, item: Item) -> "Position":
        """That of an item."""
        return cls(type(item).__name__, item.stamp_ns)


@dataclass(frozen=True, slots=True)
class Saved:
    """What a checkpoint file holds. paused: whether the scans that came then were let go by."""

    checkpoint: Checkpoint
    settings: Settings
    position: Position
    annotations: Annotations
    paused: bool = False


@cache
def our_version() -> str:
    """That of this program as it was loaded: sources may change on the disk while it runs."""
    return version()


class _Pickler(pickle.Pickler):
    """Leaves out rows, which have files of their own."""

    def __init__(self, file: io.BytesIO, files: RowFiles) -> None:
        super().__init__(file, pickle.HIGHEST_PROTOCOL)
        self._files = files
        self._numbers = count()

    def persistent_id(self, value: Any) -> KeptRows | None:
        """Where the rows are; None for all else."""
        return self._files.append(next(self._numbers), value) if isinstance(value, GrowingRows) else None


class _Unpickler(pickle.Unpickler):
    def __init__(self, folder: Path, content: bytes) -> None:
        super().__init__(io.BytesIO(content))
        self._folder = folder

    def persistent_load(self, kept: KeptRows) -> GrowingRows:
        """The rows that `persistent_id` told of."""
        return read_rows(self._folder, kept)


def write_checkpoint(folder: Path, saved: Saved, files: RowFiles) -> None:
    """OSError if there is no room. files: of this folder, which know what it has of the rows already."""
    file = io.BytesIO()
    _Pickler(file, files).dump(saved)
    content = file.getvalue()
    head = f"{MAGIC} {our_version()} {hashlib.sha256(content).hexdigest()}\n"
    write_whole(folder / CHECKPOINT, head.encode(), content)
    files.tidy()


def read_checkpoint(folder: Path) -> Saved | None:
    """None if there is none. JournalError for one that is damaged, not one's own, or of another version."""
    path = folder / CHECKPOINT
    try:
        for place in (folder, path):
            _check_owner(place)
        head, _, content = path.read_bytes().partition(b"\n")
    except FileNotFoundError:
        return None
    except OSError as error:
        raise JournalError(f"{path} cannot be read ({error.strerror}): check its permissions") from error
    magic, made_by, digest = (*head.decode("ascii", "replace").split(), "", "", "")[:3]
    if magic != MAGIC or digest != hashlib.sha256(content).hexdigest():
        raise JournalError(f"{path} is damaged: the run is made again from its messages")
    if made_by != our_version():
        raise JournalError(f"{path} is of another version of the program: the run is made again from its messages")
    return _loaded(path, content)


def _loaded(path: Path, content: bytes) -> Saved:
    try:
        saved = _Unpickler(path.parent, content).load()  # of a file that only we can write
    except JournalError:
        raise
    except Exception as error:  # whatever stands in it is called
        reason = f"{type(error).__name__}: {error}"
        raise JournalError(f"{path} cannot be read ({reason}): the run is made again from its messages") from error
    if not isinstance(saved, Saved):
        raise JournalError(f"{path} holds no checkpoint: the run is made again from its messages")
    return saved


def _check_owner(path: Path) -> None:
    """JournalError for a file that others can write: what is loaded from it is run."""
    found = path.stat()
    if hasattr(os, "getuid") and found.st_uid != os.getuid():
        raise JournalError(f"{path} belongs to somebody else: it is not read")
    if os.name == "posix" and found.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
        raise JournalError(f"{path} can be written by others: it is not read")


def behind(items: Iterator[Item], position: Position | None) -> Iterator[Item]:
    """The items behind the one at a position; all without one, and none where it is not found."""
    if position is not None:
        for item in items:
            if type(item).__name__ == position.kind and item.stamp_ns == position.stamp_ns:
                break
    yield from items
