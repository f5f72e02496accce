"""Where compiled kernels are kept: a folder for each state of their sources and each build, so that none is ever
out of date.

Numba notices a change in a kernel's own file, not in a kernel that it calls from another one. Call `keep_compiled`
before numba is imported; processes that are started inherit it.
"""

import hashlib
import os
import re
from importlib.util import find_spec
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]


def _core() -> Path:
    """The folder of slam_core, which is not imported for that."""
    found = find_spec("slam_core")
    if found is None or found.origin is None:
        raise ModuleNotFoundError("slam_core is not installed: install hectorscope again")
    return Path(found.origin).parent


PACKAGES = (_core(), PACKAGE)
# What numba compiles and how, and the geometry that kernels compile into themselves.
COMPILED = re.compile(rb"njit|intrinsic|NamedTuple|^def cosines", re.MULTILINE)


def keep_compiled(caches: Path) -> None:
    """Keep them below `caches`, unless the environment names a folder already or this one cannot be written."""
    checked = os.environ.get("NUMBA_BOUNDSCHECK", "0") not in ("", "0")
    folder = caches / (fingerprint() + ("-checked" if checked else ""))
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return  # numba finds a place of its own
    os.environ.setdefault("NUMBA_CACHE_DIR", str(folder))


def user_cache() -> Path:
    """The person's folder for what can be made again."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "hectorscope"


def fingerprint() -> str:
    """A name for the text of every compiled function."""
    sources = [path for package in PACKAGES for path in sorted(package.rglob("*.py"))]
    texts = (path.read_bytes() for path in sources)
    compiled = (text for text in texts if COMPILED.search(text))
    return hashlib.sha256(b"".join(compiled)).hexdigest()[:16]
