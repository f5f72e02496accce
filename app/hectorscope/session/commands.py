"""What the page asks of the engine: immutable values, put into a queue by the callbacks of the page."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from hectorscope.run.permalink import Permalink
from hectorscope.run.readings import CellTarget
from hectorscope.run.settings import Settings
from hectorscope.steering import Request

if TYPE_CHECKING:
    from hectorscope.exporters import Exporter


@dataclass(frozen=True, slots=True)
class Command:
    """Something that is asked of the engine."""


@dataclass(frozen=True, slots=True)
class Play(Command):
    """Go on from here; a run that ended or failed begins again."""


@dataclass(frozen=True, slots=True)
class Pause(Command):
    """Stop after the next scan."""


@dataclass(frozen=True, slots=True)
class PlayPause(Command):
    """Pause if it runs, else go on: decided where the state is known, not by a drawing that may be late."""


@dataclass(frozen=True, slots=True)
class StepScan(Command):
    """Process exactly one more scan, then pause."""


@dataclass(frozen=True, slots=True)
class StepBack(Command):
    """Pause at the scan before the shown one, with everything as it was then."""


@dataclass(frozen=True, slots=True)
class SetSpeed(Command):
    """Playback speed, times real time; inf for as fast as it goes."""

    speed: float


@dataclass(frozen=True, slots=True)
class ChangeSpeed(Command):
    """So many notches faster or slower: counted where the speed is known, not from a drawing that may be late."""

    notches: int


@dataclass(frozen=True, slots=True)
class Restart(Command):
    """Begin the recording again with an empty map (a live stream keeps flowing, the map starts anew)."""


@dataclass(frozen=True, slots=True)
class Undo(Command):
    """Take back the last action that took something away, while it is offered."""


@dataclass(frozen=True, slots=True)
class Agree(Command):
    """Carry out what the question of this number holds back."""

    number: int


@dataclass(frozen=True, slots=True)
class Decline(Command):
    """Drop what the question of this number holds back."""

    number: int


@dataclass(frozen=True, slots=True)
class Seek(Command):
    """Go to this time of the recording, or of what is kept of a stream, by running up to it."""

    time_ns: int


@dataclass(frozen=True, slots=True)
class GoLive(Command):
    """Show a stream as it is now, after an earlier time of it was shown."""


@dataclass(frozen=True, slots=True)
class Configure(Command):
    """Change one setting, by its dotted name, from the scan that is shown on. throughout: for the whole run."""

    name: str
    value: float | int | bool | str
    throughout: bool = False


@dataclass(frozen=True, slots=True)
class ConfigureAll(Command):
    """Change several settings at once, by their dotted names, as `Configure` does. title: for the log."""

    title: str
    values: Mapping[str, float | int | bool | str]
    throughout: bool = False


@dataclass(frozen=True, slots=True)
class Save(Command):
    """Leave the results so far in the folder that the program was started with."""


@dataclass(frozen=True, slots=True)
class Repair(Command):
    """Open the source again with what the sensor check found put right, and begin again."""


@dataclass(frozen=True, slots=True)
class ListRecordings(Command):
    """Look again which recordings there are."""


@dataclass(frozen=True, slots=True)
class Open(Command):
    """Show another recording, by its key in the list; the present run is kept for a minute."""

    key: str


@dataclass(frozen=True, slots=True)
class OpenUploaded(Command):
    """Show a recording that a browser sent. Sent by the server only. name: a label."""

    path: Path
    name: str


@dataclass(frozen=True, slots=True)
class Follow(Command):
    """Show what a permalink asks for."""

    link: Permalink


@dataclass(frozen=True, slots=True)
class SetUp(Command):
    """Show a recording that comes with the program, with these settings, at rest so long after its start.

    title: of the lesson that asks for it, for the list of runs.
    """

    demo: str
    offset_ns: int
    settings: Settings
    title: str


@dataclass(frozen=True, slots=True)
class RunCommand(Command):
    """Of the runs of the session."""


@dataclass(frozen=True, slots=True)
class Fork(RunCommand):
    """The shown run stays in the list as it is, and another one goes on from here. name: empty for any."""

    name: str = ""


@dataclass(frozen=True, slots=True)
class ShowRun(RunCommand):
    """Show the run of this number, where it was last looked at."""

    number: int


@dataclass(frozen=True, slots=True)
class RenameRun(RunCommand):
    """Another name for the run of this number."""

    number: int
    name: str


@dataclass(frozen=True, slots=True)
class RemoveRun(RunCommand):
    """Take the run of this number out of the list."""

    number: int


@dataclass(frozen=True, slots=True)
class KeepRun(RunCommand):
    """Write the shown run to the folder for runs."""


@dataclass(frozen=True, slots=True)
class CompareRun(RunCommand):
    """Show the run of this number beside the shown one, at the same time; 0 for none."""

    number: int


@dataclass(frozen=True, slots=True)
class ComparePaper(RunCommand):
    """Show the same recording by the method of the paper beside the shown run."""


@dataclass(frozen=True, slots=True)
class Identified(Command):
    """A recording is known by its content. Sent by the engine's own threads only."""


@dataclass(frozen=True, slots=True)
class Examine(Command):
    """Read the whole recording beside the run, and find what is wrong with it."""


@dataclass(frozen=True, slots=True)
class Export(Command):
    """Make an archive of the results so far for a browser, in these formats."""

    client: int
    formats: "tuple[Exporter, ...]"


@dataclass(frozen=True, slots=True)
class Pick:
    """Where somebody points.

    places: where the sight meets the levels, the nearest first. reach: metres from there to a beam at most.
    """

    places: tuple[CellTarget, ...]
    reach: float


AHEAD = -1  # in place of the number of a beam: the middle one


@dataclass(frozen=True, slots=True)
class Inspect(Command):
    """A browser looks at the beam or cell under a point, at a beam by its number, or at nothing (None)."""

    client: int
    what: Pick | int | None


@dataclass(frozen=True, slots=True)
class Drive(Command):
    """Ask something of a robot that is driven by hand."""

    request: Request


@dataclass(frozen=True, slots=True)
class Answer(Command):
    """Work beside the engine has ended: a line for the log. Sent by the engine's own threads only."""

    text: str
    failed: bool = False


@dataclass(frozen=True, slots=True)
class Quit(Command):
    """End the engine."""
