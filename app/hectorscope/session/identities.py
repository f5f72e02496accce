"""What tells recordings apart, by their content: read beside the engine, as that takes a second a gigabyte."""

import threading
from collections.abc import Callable
from pathlib import Path

from hectorscope.run.fingerprint import Identity, identity, size_of

_Stamp = tuple[int, float]


class Identities:
    """Each recording is read once, and again if it was written since. told: called once one is known."""

    def __init__(self, told: Callable[[], None] = lambda: None) -> None:
        self.told = told
        self._known: dict[Path, tuple[_Stamp, Identity | None]] = {}
        self._read: set[Path] = set()
        self._lock = threading.Lock()

    def known(self, path: Path) -> Identity | None:
        """Of the recording at a path, once it was read; the first call begins to read it."""
        with self._lock:
            if path in self._known:
                return self._known[path][1]
            is_new = path not in self._read
            self._read.add(path)
        if is_new:
            threading.Thread(target=self._find_out, args=(path,), name="identity", daemon=True).start()
        return None

    def _find_out(self, path: Path) -> None:
        self.find_out(path)
        self.told()

    def find_out(self, path: Path) -> Identity | None:
        """The same, at once; None if it cannot be read."""
        try:
            stamp = (size_of(path), path.stat().st_mtime)
            with self._lock:
                before = self._known.get(path)
            found = before[1] if before and before[0] == stamp else identity(path)
        except OSError:
            stamp, found = (0, 0.0), None
        with self._lock:
            self._known[path] = stamp, found
        return found

    def is_at(self, wanted: Identity, path: Path) -> bool:
        """Whether a recording is the wanted one: it is read only if it has the size."""
        try:
            return size_of(path) == wanted.size and self.find_out(path) == wanted
        except OSError:
            return False
