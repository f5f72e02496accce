"""The recordings that were opened last: a list of paths in the person's own folder for states of programs."""

import json
import os
import tempfile
from pathlib import Path

from hectorscope.common.paths import exists

MOST = 10  # recordings
LARGEST = 64 * 1024  # bytes of the file


def recent_file() -> Path | None:
    """Where the list is kept; None for a person without a home."""
    state = os.environ.get("XDG_STATE_HOME")
    try:
        folder = Path(state) if state else Path.home() / ".local" / "state"
    except RuntimeError:
        return None
    return folder / "hectorscope" / "recent.json"


class Recent:
    """The newest first. A file that is missing or damaged is an empty list; one that cannot be written is left.

    file: None keeps nothing.
    """

    def __init__(self, file: Path | None) -> None:
        self._file = file

    def paths(self) -> list[Path]:
        """Those that are still there."""
        if self._file is None:
            return []
        try:
            with self._file.open(encoding="utf-8") as file:
                names = json.loads(file.read(LARGEST))
        except (OSError, ValueError, RecursionError):
            return []
        paths = [Path(name) for name in names if isinstance(name, str)] if isinstance(names, list) else []
        return [path for path in paths[:MOST] if path.is_absolute() and "\0" not in str(path) and exists(path)]

    def add(self, path: Path) -> None:
        """Put one that was opened now in front."""
        if self._file is None:
            return
        first = path.absolute()
        names = [str(first), *(str(other) for other in self.paths() if other != first)]
        try:
            self._write(self._file, json.dumps(names[:MOST], indent=1))
        except OSError:  # the list is a convenience: a full disk must not end a run
            return

    def _write(self, file: Path, text: str) -> None:
        """Under another name first, so that whoever reads has the old list or the new one."""
        file.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        handle, name = tempfile.mkstemp(dir=file.parent, prefix=file.name)  # for its owner alone
        try:
            with os.fdopen(handle, "w", encoding="utf-8") as written:
                written.write(text)
            Path(name).replace(file)
        except OSError:
            Path(name).unlink(missing_ok=True)
            raise
