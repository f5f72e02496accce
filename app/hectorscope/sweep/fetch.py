"""Recordings by address: a worker copies one to its own disk, by fsspec, and keeps the last one."""

import atexit
import hashlib
import shutil
import tempfile
from importlib import import_module
from pathlib import Path
from typing import Any

from hectorscope.inputs import SourceError

_kept: dict[str, Path] = {}  # the one copy of this process, by address


def is_address(name: str) -> bool:
    """Whether a recording is named by an address, as in s3://bucket/a.bag, and not by a path."""
    return "://" in name


def listed(address: str) -> list[str]:
    """The addresses that one with a pattern (*) stands for, sorted; SourceError if none fits."""
    if "*" not in address:
        return [address]
    system, path = _opened(address)
    try:
        found = sorted(system.glob(path))
    except Exception as error:  # each protocol has errors of its own
        raise _unreachable(address, error) from error
    if not found:
        raise SourceError(f"{address} matches nothing: give an address of recordings")
    return [str(system.unstrip_protocol(each)) for each in found]


def local(path: str) -> Path:
    """The path itself, or that of a copy of what lies at an address; SourceError if it cannot be had.

    The copy before it is removed: a sweep goes through its settings recording by recording.
    """
    if not is_address(path):
        return Path(path)
    if path not in _kept:
        forget()
        _kept[path] = _copied(path)
    return _kept[path]


def kept(path: str) -> str:
    """Where the copy of an address lies; the path itself without one."""
    return str(_kept.get(path, path))


def _copied(address: str) -> Path:
    system, path = _opened(address)
    folder = Path(tempfile.mkdtemp(prefix="hectorscope-"))
    target = folder / (Path(path.rstrip("/")).name or hashlib.sha256(path.encode()).hexdigest()[:8])
    try:
        system.get(path, str(target), recursive=bool(system.isdir(path)))
    except Exception as error:  # each protocol has errors of its own
        shutil.rmtree(folder, ignore_errors=True)
        raise _unreachable(address, error) from error
    return target


def forget() -> None:
    """Remove the copy, if there is one."""
    for copy in _kept.values():
        shutil.rmtree(copy.parent, ignore_errors=True)
    _kept.clear()


atexit.register(forget)


def _opened(address: str) -> tuple[Any, str]:
    """The file system of an address and the path in it."""
    try:
        fsspec: Any = import_module("fsspec.core")  # an extra
    except ImportError as error:
        raise SourceError(
            f"{address} is an address, which needs fsspec: run pip install 'hectorscope[cluster]', or give a path"
        ) from error
    try:
        system, path = fsspec.url_to_fs(address)
    except Exception as error:  # an unknown protocol, or one whose library is missing
        raise _unreachable(address, error) from error
    return system, path


def _unreachable(address: str, error: Exception) -> SourceError:
    reason = f"{type(error).__name__}: {error}".removesuffix(f": {address}")
    return SourceError(f"{address} cannot be read ({reason}): check the address and the rights")
