"""Where compiled kernels are kept: a folder for each state of their sources and each build, so that none is ever
out of date.

Numba notices a change in a kernel's own file, not in a kernel that it calls from another one. Call `keep_compiled`
before numba is imported; processes that are started inherit it.
"""

import errno
import getpass
import hashlib
import os
import pickle
import shutil
import stat
import tempfile
from collections.abc import Iterable, Iterator
from importlib.util import find_spec
from pathlib import Path

from slam_core.errors import SlamError

NEEDED = 64 * 2**20  # bytes: all kernels take some 15 MB, files are written beside those that they replace
PACKAGE = Path(__file__).resolve().parents[1]


def _core() -> Path:
    """The folder of slam_core, which is not imported for that."""
    found = find_spec("slam_core")
    if found is None or found.origin is None:
        raise ModuleNotFoundError("slam_core is not installed: install hectorscope again")
    return Path(found.origin).parent


PACKAGES = (_core(), PACKAGE)
# What numba compiles and how, and the geometry that kernels compile into themselves.
COMPILED = (b"njit", b"intrinsic", b"NamedTuple", b"\ndef cosines")


def keep_compiled(*places: Path) -> None:
    """Keep them below the first of `places` that can take them, unless the environment names a folder already.

    CacheError if none can. What was cut there, by a full disk for one, is removed, and so compiled again.
    """
    if "NUMBA_CACHE_DIR" in os.environ:
        return
    name, reasons = fingerprint() + ("-checked" if checked() else ""), []
    for place in places:
        try:
            folder = _private(place / name)
        except OSError as error:
            reasons.append(f"{place}: {error.strerror or error}")
            continue
        _remove_cut(folder)
        os.environ["NUMBA_CACHE_DIR"] = str(folder)
        return
    raise CacheError(
        f"compiled kernels can be kept nowhere ({'; '.join(reasons)}): set NUMBA_CACHE_DIR to a folder of your own"
        f" with {NEEDED // 2**20} MB free"
    )


def checked() -> bool:
    """Whether kernels are compiled with bounds checks."""
    return os.environ.get("NUMBA_BOUNDSCHECK", "0") not in ("", "0")


class CacheError(SlamError):
    """There is no folder for compiled kernels."""


def _private(folder: Path) -> Path:
    """The folder, made if need be, for its owner alone: what is loaded from it is run. OSError if it is no use."""
    folder.mkdir(parents=True, exist_ok=True, mode=0o700)
    if hasattr(os, "getuid"):
        for each in (folder.parent, folder):
            if each.stat().st_uid != os.getuid():
                raise PermissionError(errno.EPERM, f"{each} belongs to somebody else")
            if each.stat().st_mode & (stat.S_IRWXG | stat.S_IRWXO):
                each.chmod(0o700)
    with tempfile.TemporaryFile(dir=folder) as probe:
        probe.write(b"x")
    used = sum(file.stat().st_size for file in folder.rglob("*.nb?"))
    if shutil.disk_usage(folder).free < NEEDED - used:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    return folder


def _remove_cut(folder: Path) -> None:
    """Remove files that do not end as a pickle does; numba would stop at them."""
    for file in folder.rglob("*.nb[ci]"):
        with file.open("rb") as stream:
            stream.seek(0, os.SEEK_END)
            stream.seek(max(0, stream.tell() - 1))
            whole = stream.read() == pickle.STOP
        if not whole:
            file.unlink()


def cache_places() -> list[Path]:
    """Where compiled kernels may be kept: the person's cache, or else a folder of theirs for temporary files."""
    user = str(os.getuid()) if hasattr(os, "getuid") else getpass.getuser()
    temporary = Path(tempfile.gettempdir()) / f"hectorscope-{user}"
    cache = os.environ.get("XDG_CACHE_HOME")
    try:
        return [Path(cache) / "hectorscope" if cache else Path.home() / ".cache" / "hectorscope", temporary]
    except RuntimeError:  # no home
        return [temporary]


def fingerprint() -> str:
    """A name for the text of every compiled function."""
    return _named(text for text in _texts() if any(word in text for word in COMPILED))


def version() -> str:
    """A name for the text of the whole program, as it lies on the disk."""
    return _named(_texts())


def _texts() -> Iterator[bytes]:
    return (path.read_bytes() for package in PACKAGES for path in sorted(package.rglob("*.py")))


def _named(texts: Iterable[bytes]) -> str:
    return hashlib.sha256(b"".join(texts)).hexdigest()[:16]
