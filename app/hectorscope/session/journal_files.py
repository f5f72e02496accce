"""The files of a journal: what a live run leaves on the disk while it goes on, and how it is found again.

A folder for each run: the messages of the stream (ros/stream_recorder.py), the newest checkpoint, the actions,
and `closed` once the run ended in order. A checkpoint is a pickle, so a folder or file that others could write is
never read.
"""

import hashlib
import json
import os
import pickle
import stat
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from hectorscope.common.kernel_cache import fingerprint
from hectorscope.common.paths import exists
from hectorscope.inputs import Item
from hectorscope.run.annotations import Annotations
from hectorscope.run.checkpoints import Checkpoint
from hectorscope.run.settings import Settings
from slam_core.errors import SlamError

if sys.platform != "win32":
    import fcntl

ABOUT, CHECKPOINT, CLOSED, ACTIONS = "about.json", "checkpoint", "closed", "actions.jsonl"
KEPT = 5  # journals of runs; older ones are removed
MAGIC = "hectorscope-checkpoint"


class JournalError(SlamError):
    """A journal cannot be kept or read."""


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
    """What a checkpoint file holds."""

    checkpoint: Checkpoint
    settings: Settings
    position: Position
    annotations: Annotations


def journal_folder() -> Path | None:
    """Where journals are kept by default: the person's own folder for states of programs; None without a home."""
    state = os.environ.get("XDG_STATE_HOME")
    try:
        return (Path(state) if state else Path.home() / ".local" / "state") / "hectorscope" / "journal"
    except RuntimeError:
        return None


class Hold:
    """Keeps a folder for one program; the lock goes with the process, however that ends."""

    def __init__(self, folder: Path) -> None:
        """JournalError if another program has it."""
        self._handle = os.open(folder, os.O_RDONLY)
        if sys.platform == "win32":
            return
        try:
            fcntl.flock(self._handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            os.close(self._handle)
            raise JournalError(f"another program writes into {folder}: wait for its end") from error
        except OSError:
            pass  # a file system without locks

    def release(self) -> None:
        """Let others have it."""
        os.close(self._handle)


def begin(root: Path, address: str) -> Path:
    """A new folder for a run; older ones are removed. JournalError if it cannot be made."""
    stamp = time.strftime("%Y%m%dT%H%M%SZ", time.gmtime())
    try:
        root.mkdir(parents=True, exist_ok=True, mode=0o700)
        folder = Path(tempfile.mkdtemp(prefix=f"{stamp}-", dir=root))  # for its owner alone
        write_durably(folder / ABOUT, json.dumps({"address": address, "begun": stamp}).encode())
    except OSError as error:
        raise JournalError(
            f"the journal cannot be kept in {root} ({error.strerror}): give another --journal, or off"
        ) from error
    return folder


def ended_badly(root: Path, address: str) -> Path | None:
    """The newest journal of an address that was not closed and that no running program writes; None without."""
    for folder in reversed(journals(root)):
        try:
            about = json.loads((folder / ABOUT).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            continue
        if not isinstance(about, dict) or about.get("address") != address:
            continue
        if exists(folder / CLOSED) or not _is_free(folder) or not _has_content(folder):
            return None  # there is a newer one than any that ended badly
        return folder
    return None


def journals(root: Path) -> list[Path]:
    """All of them, the oldest first."""
    try:
        return sorted(path for path in root.iterdir() if exists(path / ABOUT))
    except OSError:
        return []


def _is_free(folder: Path) -> bool:
    try:
        Hold(folder).release()
    except (JournalError, OSError):
        return False
    return True


def _has_content(folder: Path) -> bool:
    return exists(folder / CHECKPOINT) or any(folder.glob("stream_*.mcap"))


def forget_old(root: Path) -> None:
    """Remove all but the newest ones."""
    for folder in journals(root)[:-KEPT]:
        if _is_free(folder):
            _remove(folder)


def _remove(folder: Path) -> None:
    try:
        for path in folder.iterdir():
            path.unlink()
        folder.rmdir()
    except OSError:  # it stays
        return


def write_durably(path: Path, content: bytes) -> None:
    """Under another name first, and on the disk before it takes its own: one of both is always whole."""
    part = path.with_name(f".{path.name}.part")
    with part.open("wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    part.replace(path)
    handle = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def write_checkpoint(folder: Path, saved: Saved) -> None:
    """OSError if there is no room."""
    content = pickle.dumps(saved, pickle.HIGHEST_PROTOCOL)
    head = f"{MAGIC} {fingerprint()} {hashlib.sha256(content).hexdigest()}\n"
    write_durably(folder / CHECKPOINT, head.encode() + content)


def read_checkpoint(folder: Path) -> Saved | None:
    """None if there is none, or one of another version. JournalError for one that is damaged or not one's own."""
    path = folder / CHECKPOINT
    try:
        for place in (folder, path):
            _check_owner(place)
        head, _, content = path.read_bytes().partition(b"\n")
    except FileNotFoundError:
        return None
    except OSError as error:
        raise JournalError(f"{path} cannot be read ({error.strerror}): check its permissions") from error
    magic, version, digest = (*head.decode("ascii", "replace").split(), "", "", "")[:3]
    if magic != MAGIC or digest != hashlib.sha256(content).hexdigest():
        raise JournalError(f"{path} is damaged: the run is made again from its messages")
    if version != fingerprint():
        return None
    saved = pickle.loads(content)  # of a file that only we can write
    assert isinstance(saved, Saved)
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
