"""Files and folders: why one that a person named cannot be used, and how one is written."""

import os
import tempfile
from pathlib import Path

from slam_core.errors import nearest


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


def write_whole(path: Path, text: str) -> None:
    """Write for the owner alone, under another name first: whoever reads has the old file or the new. OSError."""
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(text)
        Path(name).replace(path)
    finally:
        Path(name).unlink(missing_ok=True)
