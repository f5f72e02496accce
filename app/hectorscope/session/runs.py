"""The runs of a session by name. A run is a value: recording, settings with their changes, and where it was.

A replay gives the same bytes, so a run that is not shown takes no memory, and comes back as it was.
"""

from dataclasses import dataclass, field, replace
from pathlib import Path

from hectorscope.common.terminal import printable
from hectorscope.run.permalink import LONGEST_NAME
from hectorscope.run.settings import Settings
from hectorscope.session.snapshot import ListedRun
from slam_core.errors import SlamError

MOST = 50  # runs


class RunsError(SlamError):
    """What was asked of the runs cannot be."""


@dataclass(frozen=True, slots=True)
class NamedRun:
    """path, source: of its recording. offset_ns: where it was last looked at, since the recording's start."""

    number: int
    name: str
    source: str = ""
    path: Path | None = None
    settings: Settings = field(default_factory=Settings)
    offset_ns: int = 0


class Runs:
    """Belongs to the engine's thread."""

    def __init__(self) -> None:
        self._runs: dict[int, NamedRun] = {}
        self._last = 0

    def new(self, name: str = "") -> int:
        """The number of one more run; RunsError if there are too many. Without a name it is called by that."""
        run = self.copied(NamedRun(0, ""), name)
        self.put(run)
        return run.number

    def copied(self, run: NamedRun, name: str = "") -> NamedRun:
        """The same with a number of its own, to be `put` into the list; RunsError if there are too many."""
        if len(self._runs) >= MOST:
            raise RunsError(f"There are {MOST} runs already: remove one")
        number = self._last + 1
        return replace(run, number=number, name=self._free(name or f"run {number}"))

    def find(self, path: Path | None, settings: Settings) -> NamedRun | None:
        """A run of this recording with these settings."""
        return next((run for run in self._runs.values() if (run.path, run.settings) == (path, settings)), None)

    def put(self, run: NamedRun) -> None:
        """The run of this number is that from now on, also if it was removed."""
        self._runs[run.number] = run
        self._last = max(self._last, run.number)

    def __getitem__(self, number: int) -> NamedRun:
        """RunsError for a number of none."""
        if number not in self._runs:
            raise RunsError("This run is no longer there")
        return self._runs[number]

    def name(self, number: int) -> str:
        """Of a run that may have been removed."""
        return self._runs[number].name if number in self._runs else self._free(f"run {number}")

    def named(self, name: str) -> int | None:
        """The number of the run with this name."""
        return next((run.number for run in self._runs.values() if run.name == name), None)

    def rename(self, number: int, name: str) -> None:
        """Another name; RunsError for one that is empty or taken."""
        run, name = self[number], cleaned(name)
        if not name:
            raise RunsError("A run needs a name: give a letter at least")
        if self.named(name) not in (None, number):
            raise RunsError(f"There is a run {name} already: choose another name")
        self.put(replace(run, name=name))

    def remove(self, number: int) -> NamedRun:
        """Take one away; it."""
        run = self[number]
        del self._runs[number]
        return run

    def listed(self) -> tuple[ListedRun, ...]:
        """By their numbers."""
        runs = sorted(self._runs.values(), key=lambda run: run.number)
        return tuple(ListedRun(run.number, run.name, run.source, run.offset_ns, run.settings) for run in runs)

    def _free(self, name: str) -> str:
        """The name, or with a number behind it that makes it another one."""
        name, number = cleaned(name) or "run", 1
        free = name
        while self.named(free) is not None:
            number += 1
            free = f"{name} ({number})"
        return free


def cleaned(name: str) -> str:
    """A name as it can be shown."""
    return printable(" ".join(name.split()))[:LONGEST_NAME].strip()


def first_difference(one: Settings, other: Settings) -> int | None:
    """The time from which on two settings give other configurations, ns; None for never."""
    if one.start != other.start:
        return -(2**63)
    times = sorted({change.time_ns for change in (*one.changes, *other.changes)})
    return next((time_ns for time_ns in times if one.at(time_ns) != other.at(time_ns)), None)
