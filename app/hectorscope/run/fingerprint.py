"""What tells one recording from another: the hash of its bytes."""

import hashlib
from pathlib import Path
from typing import NamedTuple


class Fingerprint(NamedTuple):
    """A file of a recording: its name in it, its size in bytes, and its SHA-256 in hexadecimal."""

    name: str
    size: int
    sha256: str


def fingerprints(recording: Path) -> tuple[Fingerprint, ...]:
    """Of a file, or of every file of a folder, by name. OSError if one cannot be read."""
    if not recording.is_dir():
        return (_fingerprint(recording, recording.name),)
    files = sorted(path for path in recording.rglob("*") if path.is_file())
    return tuple(_fingerprint(path, path.relative_to(recording).as_posix()) for path in files)


def _fingerprint(path: Path, name: str) -> Fingerprint:
    with path.open("rb") as file:
        return Fingerprint(name, path.stat().st_size, hashlib.file_digest(file, "sha256").hexdigest())
