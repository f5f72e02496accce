"""The recordings that a page can open: of the folders that were given, the demos, the recent, the uploaded."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from types import MappingProxyType

from hectorscope.common.paths import absence
from hectorscope.common.recent import Recent
from hectorscope.inputs import OptionValue, Source
from hectorscope.run.fingerprint import Identity
from hectorscope.run.run_file import RunFile
from hectorscope.session.identities import Identities
from hectorscope.session.kept_runs import GROUP as KEPT
from hectorscope.session.kept_runs import KeptRuns
from hectorscope.session.snapshot import Listed
from hectorscope.sources import is_inside, recordings_in
from slam_core.errors import SlamError

MOST = 500  # recordings of one folder
UPLOADED, RECENT, DEMOS = "Dropped onto the page", "Recent", "Demos"


class LibraryError(SlamError):
    """What was asked for cannot be opened."""


@dataclass(frozen=True, slots=True)
class _Found:
    """A recording under the name that is shown. below: the folder that it must lie in, also when it is opened."""

    path: Path
    name: str
    group: str
    below: Path | None = None


Opened = Callable[[Path, Mapping[str, OptionValue]], Source]


def no_opening(path: Path, _: Mapping[str, OptionValue]) -> Source:
    """For an engine that shows one source only."""
    raise LibraryError(f"{path.name} cannot be opened from here: start the program with it")


class Library:
    """A page asks by a key from the list that was made here; no path of a page reaches the disk.

    opened: opens what is at a path, with `SENSOR_OPTIONS`; SlamError if that cannot be. demos: by name.
    kept: runs, which are listed too. shown: what the program begins with.
    """

    def __init__(
        self,
        opened: Opened = no_opening,
        folders: Sequence[Path] = (),
        demos: Mapping[str, Path] | None = None,
        recent: Recent | None = None,
        kept: KeptRuns | None = None,
    ) -> None:
        self.listed: tuple[Listed, ...] = ()
        self.shown: Path | None = None
        self.identities = Identities()
        self._opened, self._folders, self._demos = opened, folders, demos or {}
        self._recent, self.kept = recent or Recent(None), kept or KeptRuns(None)
        self._uploaded: list[_Found] = []
        self._keys: dict[_Found, str] = {}
        self._found: dict[str, _Found] = {}
        self.refresh()

    def refresh(self) -> None:
        """Look again what is there."""
        self._found = {self._key(found): found for found in self._all()}
        self.listed = tuple(Listed(key, found.name, found.group) for key, found in self._found.items())

    def _all(self) -> Iterator[_Found]:
        yield from self._uploaded
        for folder in self._folders:
            for path in islice(recordings_in(folder), MOST):
                yield _Found(path, path.relative_to(folder.resolve()).as_posix(), folder.resolve().name, folder)
        yield from (_Found(path, f"{path.parent.name}/{path.name}", RECENT) for path in self._recent.paths())
        yield from (_Found(path, name, DEMOS) for name, path in self._demos.items())
        yield from (_Found(Path(run.key), run.name, run.group) for run in self.kept.listed())

    def _key(self, found: _Found) -> str:
        """The same for the same recording, as long as the program runs."""
        return self._keys.setdefault(found, f"r{len(self._keys) + 1}")

    def add(self, path: Path, name: str) -> str:
        """One that was uploaded; its key."""
        self._uploaded.append(_Found(path, name, UPLOADED))
        self.refresh()
        return self._key(self._uploaded[-1])

    def name(self, key: str) -> str:
        """How it is shown; "a recording" for a key that is none."""
        return self._found[key].name if key in self._found else "a recording"

    def find(self, wanted: Identity) -> str | None:
        """The key of the recording with this content, or None. Those of its size are read for that."""
        self.refresh()
        recordings = ((key, found.path) for key, found in self._found.items() if found.group != KEPT)
        return next((key for key, path in recordings if self.identities.is_at(wanted, path)), None)

    def demo(self, name: str) -> str:
        """The key of a recording that comes with the program; LibraryError if it is not there."""
        for key, found in self._found.items():
            if found.group == DEMOS and found.name == name:
                return key
        raise LibraryError(f"The recording {name} is not there: it comes with the program, and is missing here")

    def path(self, key: str) -> Path | None:
        """Where the recording of a key lies."""
        return self._found[key].path if key in self._found else None

    def keep(self, run: RunFile) -> str:
        """Write a run to the folder for them; the name that it has in the list."""
        name = self.kept.keep(run)
        self.refresh()
        return name

    def kept_run(self, key: str) -> RunFile | None:
        """What is kept under a key; None if that is no run. SlamError for a bad one."""
        found = self._found.get(key)
        return self.kept.load(found.name) if found and found.group == KEPT else None

    def open(self, key: str, sensors: Mapping[str, OptionValue] = MappingProxyType({})) -> tuple[Source, Path]:
        """The recording of a key, and where it lies.

        SlamError for one that is not in the list, is gone, or cannot be read.
        """
        found = self._found.get(key)
        if found is None or found.group == KEPT:
            raise LibraryError("This recording is not in the list: open the list again")
        if found.below is not None and not is_inside(found.path, found.below.resolve()):
            raise LibraryError(f"{found.name} is no longer in its folder: open the list again")
        try:
            source = self._opened(found.path, sensors)
        except SlamError as error:  # which names the path: that is the server's own
            raise LibraryError(str(error).replace(str(found.path), found.name)) from error
        if found.group == UPLOADED:
            source.name = found.name
        else:
            self.note(found.path)
        return source, found.path

    def note(self, path: Path) -> None:
        """A recording was opened: it is among the recent ones, unless it is a demo."""
        if path not in self._demos.values():
            self._recent.add(path)


def check_folders(folders: Sequence[Path]) -> None:
    """LibraryError for one that cannot be listed."""
    for folder in folders:
        why = absence(folder) or ("" if folder.is_dir() else "is no folder")
        if why:
            raise LibraryError(f"--folder {folder} {why}: give a folder with recordings")
