"""The folder for the results: usable, and for one program at a time."""

import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from hectorscope.common.paths import FolderLock
from slam_core.errors import SlamError

# Bytes that must find room before the work is begun: about what the files of a very short run take.
PROBE = 2**16


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
    for name in files:
        if (folder / name).is_dir():
            raise OutputError(
                f"{folder / name} is a folder where a file is to be: remove it or give another --out"
            )
