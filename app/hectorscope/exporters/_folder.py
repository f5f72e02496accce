"""The folder for the results: usable, for one program at a time, and with what earlier ones left set aside."""

import os
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from itertools import count
from pathlib import Path

from hectorscope.common.paths import FolderLock, exists, is_file, sync_folder
from slam_core.errors import SlamError

# Bytes that must find room before the work is begun: about what the files of a very short run take.
PROBE = 2**16
EARLIER = "earlier"  # the folder in it for the results of earlier runs


class OutputError(SlamError):
    """The folder for the results cannot be used."""


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Keep other programs of this kind out of an existing folder meanwhile; OutputError if one is there.

    The lock goes with the process, however that ends.
    """
    try:
        lock = FolderLock(folder)
    except BlockingIOError as error:
        raise OutputError(f"another run writes into {folder}: wait for its end, or give another --out") from error
    try:
        yield
    finally:
        lock.release()


def make(folder: Path, files: Iterable[str]) -> None:
    """Make the folder, and try it, before the work is done; OutputError if it is of no use for these files."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{folder} cannot be made ({error.strerror}): give another --out") from error
    try:
        with tempfile.NamedTemporaryFile(dir=folder, prefix=".probe.") as probe:
            probe.write(bytes(PROBE))
    except OSError as error:
        raise OutputError(f"{folder} cannot be written to ({error.strerror}): give another --out") from error
    earlier = folder / EARLIER
    if exists(earlier) and not (earlier.is_dir() and os.access(earlier, os.W_OK | os.X_OK)):
        raise OutputError(f"{earlier} takes no earlier results: remove it or give another --out")
    for name in files:
        if (folder / name).is_dir():
            raise OutputError(
                f"{folder / name} is a folder where a file is to be: remove it or give another --out"
            )


def set_aside(folder: Path, files: Iterable[str]) -> str:
    """Move these files of an earlier run to `earlier/TIME`; a sentence that says so, "" if there are none.

    TIME is that of the newest, which goes last: what a crash leaves follows to the same place. OutputError.
    """
    found = sorted((path.stat().st_mtime_ns, path) for name in files if is_file(path := folder / name))
    if not found:
        return ""
    place = _place(folder / EARLIER, found[-1][0] // 10**9, [path.name for _, path in found])
    try:
        place.mkdir(parents=True, exist_ok=True)
        for _, path in found:
            path.rename(place / path.name)
        sync_folder(place)
        sync_folder(folder)
    except OSError as error:
        raise OutputError(f"{place} cannot be written to ({error.strerror}): give another --out") from error
    return f"The results of an earlier run are now in {place}"


def _place(earlier: Path, seconds: int, names: Iterable[str]) -> Path:
    """A folder for files of that time in which none of the names is taken."""
    name = f"{datetime.fromtimestamp(seconds, UTC):%Y%m%dT%H%M%SZ}"
    places = (earlier / (name if number == 1 else f"{name}-{number}") for number in count(1))
    return next(place for place in places if not any(exists(place / each) for each in names))
