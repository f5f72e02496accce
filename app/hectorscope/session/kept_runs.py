"""Runs that are kept in a folder, each in one of its own with a RUN.toml, and opened again from there."""

import re
import tempfile
from pathlib import Path

from hectorscope.common.paths import exists, write_whole
from hectorscope.run.run_file import FILE, RunFile, RunFileError, read_run, write_text
from hectorscope.session.snapshot import Listed

MOST = 200  # runs of a folder
LONGEST = 40  # characters of a folder's name
GROUP = "Kept runs"


class KeptRuns:
    """folder: None keeps nothing. What a page calls a run is a label: its letters and digits name a folder."""

    def __init__(self, folder: Path | None) -> None:
        """RunFileError where there is no run and none can be kept. The folder is made if it is missing."""
        self.folder = folder
        if folder is not None and not self.listed():
            try:
                folder.mkdir(parents=True, exist_ok=True)
                tempfile.TemporaryFile(dir=folder).close()
            except OSError as error:
                raise RunFileError(
                    f"--runs {folder} cannot be written to ({error.strerror}): give another folder"
                ) from error

    def listed(self) -> tuple[Listed, ...]:
        """The name of each folder with a run, which is its key too."""
        if self.folder is None or not exists(self.folder):
            return ()
        there = sorted(path.parent.name for path in self.folder.glob(f"*/{FILE}") if self._is_ours(path))
        return tuple(Listed(name, name, GROUP) for name in there[:MOST])

    def keep(self, run: RunFile) -> str:
        """Write it to a folder of its own; the name of that. RunFileError if it cannot be."""
        if self.folder is None:
            raise RunFileError("There is no folder to keep runs in: start the program with --runs DIR")
        try:
            place = self._made(self.folder, run.link.name)
            write_whole(place / FILE, write_text(run).encode(), mode=0o600)
        except OSError as error:
            raise RunFileError(f"The run cannot be kept ({error.strerror}): give another --runs") from error
        return place.name

    def load(self, key: str) -> RunFile:
        """The run of a name in the list; RunFileError for another one, or a bad file."""
        if self.folder is None or key not in (each.key for each in self.listed()):
            raise RunFileError("This run is not in the list: open the list again")
        return read_run(self.folder / key / FILE)

    def _is_ours(self, path: Path) -> bool:
        """Whether a file lies where it seems to: no link leads elsewhere."""
        assert self.folder is not None
        return path.is_file() and path.resolve().parent.parent == self.folder.resolve()

    def _made(self, folder: Path, name: str) -> Path:
        """A folder that was not there."""
        base = re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")[:LONGEST] or "run"
        for number in range(1, MOST + 1):
            place = folder / (base if number == 1 else f"{base}-{number}")
            try:
                place.mkdir(parents=True)
            except FileExistsError:
                continue
            return place
        raise RunFileError(f"There are {MOST} runs of the name {base} already: choose another one")
