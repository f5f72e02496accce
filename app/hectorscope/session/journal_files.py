"""The files of a journal: what a live run leaves on the disk while it goes on, and how it is found again.

A folder for each run: the messages of the stream (ros/stream_recorder.py), the newest checkpoint with the rows of
its run, the actions, and `closed` once the run ended in order or was gone on with.
"""

import json
import os
import tempfile
import time
from calendar import timegm
from pathlib import Path

from hectorscope.common.paths import FolderLock, exists, write_whole
from hectorscope.ros.stream_recorder import parts
from slam_core.errors import SlamError

ABOUT, CHECKPOINT, CLOSED, ACTIONS = "about.json", "checkpoint", "closed", "actions.jsonl"
STAMP = "%Y%m%dT%H%M%SZ"  # of the beginning of a run: UTC
ROWS = "rows_{}.f64"  # of the run, by number
KEPT, KEPT_BYTES = 5, 4 * 2**30  # journals of runs, and all together; the oldest ones are removed


class JournalError(SlamError):
    """A journal cannot be kept or read."""


def journal_folder() -> Path | None:
    """Where journals are kept by default: the person's own folder for states of programs; None without a home."""
    state = os.environ.get("XDG_STATE_HOME")
    try:
        return (Path(state) if state else Path.home() / ".local" / "state") / "hectorscope" / "journal"
    except RuntimeError:
        return None


class Hold(FolderLock):
    """Keeps the folder of a journal for one program."""

    def __init__(self, folder: Path) -> None:
        """JournalError if another program has it."""
        try:
            super().__init__(folder)
        except BlockingIOError as error:
            raise JournalError(f"another program writes into {folder}: wait for its end") from error


def begin(root: Path, address: str) -> Path:
    """A new folder for a run; older ones are removed. JournalError if it cannot be made."""
    stamp = time.strftime(STAMP, time.gmtime())
    try:
        root.mkdir(parents=True, exist_ok=True, mode=0o700)
        folder = Path(tempfile.mkdtemp(prefix=f"{stamp}-", dir=root))  # for its owner alone
        write_whole(folder / ABOUT, json.dumps({"address": address, "begun": stamp}).encode())
    except OSError as error:
        raise JournalError(
            f"the journal cannot be kept in {root} ({error.strerror}): give another --journal, or off"
        ) from error
    return folder


def begun(folder: Path) -> str:
    """When the run of a journal began, by the clock on the wall, with the date unless that is today's."""
    try:
        then = time.localtime(timegm(time.strptime(folder.name.split("-")[0], STAMP)))
    except ValueError:  # a name that somebody gave
        return folder.name
    return time.strftime("%H:%M" if then[:3] == time.localtime()[:3] else "%d %b %H:%M", then)


def ended_badly(root: Path, address: str) -> Path | None:
    """The newest journal of an address that holds something, was not closed, and that no running program writes.

    None without any. One that was offered and not answered is found again.
    """
    found = (folder for folder in reversed(journals(root)) if _address(folder) == address and _is_open(folder))
    return next(found, None)


def _address(folder: Path) -> str | None:
    """Of its stream; None if that cannot be read."""
    try:
        about = json.loads((folder / ABOUT).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    address = about.get("address") if isinstance(about, dict) else None
    return address if isinstance(address, str) else None


def _is_open(folder: Path) -> bool:
    return not exists(folder / CLOSED) and _has_content(folder) and _is_free(folder)


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
    """A run leaves an empty file at once, before anything has come."""
    return exists(folder / CHECKPOINT) or any(part.stat().st_size for part in parts(folder))


def forget_old(root: Path, most_bytes: int = KEPT_BYTES) -> None:
    """Remove the oldest ones while there are too many or they are too large; none that is still to be offered."""
    kept = journals(root)
    addresses = {address for folder in kept if (address := _address(folder)) is not None}
    offered = {ended_badly(root, address) for address in addresses}
    sizes = {folder: _size(folder) for folder in kept}
    for folder in kept:
        if len(sizes) <= KEPT and sum(sizes.values()) <= most_bytes:
            return
        if folder not in offered and _is_free(folder):
            _remove(folder)
            del sizes[folder]


def _size(folder: Path) -> int:
    """Bytes of its files."""
    try:
        return sum(path.stat().st_size for path in folder.iterdir())
    except OSError:
        return 0


def mark_closed(folder: Path) -> None:
    """It is not offered any more."""
    try:
        write_whole(folder / CLOSED, b"")
    except OSError:  # it is offered once more: better than lost
        return


def _remove(folder: Path) -> None:
    try:
        for path in folder.iterdir():
            path.unlink()
        folder.rmdir()
    except OSError:  # it stays
        return


def append_durably(folder: Path, lines: list[str]) -> None:
    """Add lines to the log of actions; they are on the disk then. OSError if there is no room."""
    with (folder / ACTIONS).open("a", encoding="utf-8") as file:
        file.writelines(lines)
        file.flush()
        os.fsync(file.fileno())
