"""The recordings that were opened last: a list of paths in the person's own folder for states of programs."""

import json
import os
from pathlib import Path

from hectorscope.common.paths import exists, write_whole

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

    file: None keeps it for as long as the program runs.
    """

    def __init__(self, file: Path | None) -> None:
        self._file = file
        self._paths: list[Path] = []  # without a file

    def paths(self) -> list[Path]:
        """Those that are still there."""
        if self._file is None:
            return [path for path in self._paths if exists(path)]
        try:
            with self._file.open(encoding="utf-8") as file:
                names = json.loads(file.read(LARGEST))
        except (OSError, ValueError, RecursionError):
            return []
        paths = [Path(name) for name in names if isinstance(name, str)] if isinstance(names, list) else []
        return [path for path in paths[:MOST] if path.is_absolute() and "\0" not in str(path) and exists(path)]

    def add(self, path: Path) -> None:
        """Put one that was opened now in front."""
        first = path.absolute()
        paths = [first, *(other for other in self.paths() if other != first)][:MOST]
        if self._file is None:
            self._paths = paths
            return
        try:
            self._file.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
            write_whole(self._file, json.dumps([str(each) for each in paths], indent=1).encode(), mode=0o600)
        except OSError:  # the list is a convenience: a full disk must not end a run
            return
