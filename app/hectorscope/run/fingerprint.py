"""What tells one recording, or one prior map, from another: the hash of its bytes."""

import hashlib
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from slam_core.localization.prior_map import PriorMap  # takes long: loads the compiler


class Identity(NamedTuple):
    """A recording by its content, wherever it lies: its size in bytes, and a SHA-256 in hexadecimal."""

    size: int
    sha256: str


class Fingerprint(NamedTuple):
    """A file of a recording: its name in it, its size in bytes, and its SHA-256 in hexadecimal."""

    name: str
    size: int
    sha256: str


def fingerprints(recording: Path) -> tuple[Fingerprint, ...]:
    """Of a file, or of every file of a folder, by name. OSError if one cannot be read."""
    if not recording.is_dir():
        return (_fingerprint(recording, recording.name),)
    return tuple(_fingerprint(path, path.relative_to(recording).as_posix()) for path in _files(recording))


def _files(recording: Path) -> list[Path]:
    if not recording.is_dir():
        return [recording]
    return sorted(path for path in recording.rglob("*") if path.is_file())


def _fingerprint(path: Path, name: str) -> Fingerprint:
    with path.open("rb") as file:
        return Fingerprint(name, path.stat().st_size, hashlib.file_digest(file, "sha256").hexdigest())


def size_of(recording: Path) -> int:
    """Bytes of a file, or of all files of a folder. OSError if one cannot be reached."""
    return sum(path.stat().st_size for path in _files(recording))


def identity(recording: Path) -> Identity:
    """Of a file its own hash; of a folder that of its files' names and hashes. OSError if one cannot be read."""
    files = fingerprints(recording)
    size = sum(file.size for file in files)
    if not recording.is_dir():
        return Identity(size, files[0].sha256)
    told = "".join(f"{file.name}\0{file.sha256}\n" for file in files)
    return Identity(size, hashlib.sha256(told.encode()).hexdigest())


def map_sha256(prior_map: "PriorMap | None") -> str:
    """Of its cells, and of how a run begins with it: whether it writes them, and where. Empty without one."""
    if prior_map is None:
        return ""
    found = hashlib.sha256(repr((prior_map.write, prior_map.start is not None)).encode())
    if prior_map.start is not None:
        found.update(np.asarray(prior_map.start, np.float64).tobytes())
    for level in prior_map.levels:
        found.update(repr((level.resolution, level.corner.tolist(), level.log_odds.shape)).encode())
        for cells in (level.log_odds, level.surfels):
            found.update(b"" if cells is None else np.ascontiguousarray(cells).data)
    return found.hexdigest()
