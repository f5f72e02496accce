"""Files and folders: why one that a person named cannot be used, and how one is written."""

import os
import sys
from collections.abc import Iterable
from functools import partial
from pathlib import Path

from slam_core.errors import nearest

if sys.platform != "win32":
    import fcntl


def exists(path: Path) -> bool:
    """Whether something is found at a path; False also where it cannot be reached."""
    try:
        path.stat()
    except OSError:
        return False
    return True


def is_file(path: Path) -> bool:
    """Whether a file is found at a path; False also where it cannot be reached."""
    return exists(path) and path.is_file()


def absence(path: Path) -> str:
    """Why nothing is found at a path, as part of a message with the nearest name; empty if there is something."""
    try:
        path.stat()
    except FileNotFoundError:
        near = _nearest(path)
        return f"does not exist (did you mean {near}?)" if near else "does not exist"
    except OSError as error:  # a name that is too long, a folder that is locked
        return f"cannot be reached ({error.strerror})"
    return ""


def _nearest(path: Path) -> str:
    """The path with its first missing part replaced by the name there that is most like it; "" if none is."""
    missing = next((part for part in reversed(path.parents) if not exists(part)), path)
    try:
        near = nearest(missing.name, sorted(other.name for other in missing.parent.iterdir()))
    except OSError:  # a folder that may not be listed
        return ""
    return str(missing.with_name(near)) if near else ""


def write_whole(path: Path, *parts: bytes | Iterable[bytes], mode: int = 0o666) -> None:
    """Write under a temporary name, then rename; an older file stays until all is on the disk. OSError.

    mode: who may read it, less what the umask takes.
    """
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        with open(temporary, "wb", opener=partial(os.open, mode=mode)) as file:
            for part in parts:
                file.writelines([part] if isinstance(part, bytes) else part)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)
    sync_folder(path.parent)


def sync_folder(folder: Path) -> None:
    """The names in it are on the disk too, where folders can be asked for that."""
    if sys.platform == "win32":
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


class FolderLock:
    """Keeps other programs out of a folder, where the system has such locks; it goes with the process."""

    def __init__(self, folder: Path) -> None:
        """BlockingIOError if another program has it."""
        self._handle: int | None = None
        if sys.platform == "win32":
            return
        self._handle = os.open(folder, os.O_RDONLY)
        try:
            fcntl.flock(self._handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            self.release()
            raise
        except OSError:
            pass  # a file system without locks

    def release(self) -> None:
        """Let others have it."""
        if self._handle is not None:
            os.close(self._handle)
