"""What the page asks of the engine: immutable values, put into a queue by the callbacks of the page."""

from collections.abc import Mapping
from dataclasses import dataclass

from hectorscope.exporters import Exporter
from hectorscope.run.inspection import CellTarget


@dataclass(frozen=True, slots=True)
class Play:
    """Go on from here; a run that ended or failed begins again."""


@dataclass(frozen=True, slots=True)
class Pause:
    """Stop after the next scan."""


@dataclass(frozen=True, slots=True)
class PlayPause:
    """Pause if it runs, else go on: decided where the state is known, not by a drawing that may be late."""


@dataclass(frozen=True, slots=True)
class StepScan:
    """Process exactly one more scan, then pause."""


@dataclass(frozen=True, slots=True)
class StepBack:
    """Pause at the scan before the shown one, with everything as it was then."""


@dataclass(frozen=True, slots=True)
class SetSpeed:
    """Playback speed, times real time; inf for as fast as it goes."""

    speed: float


@dataclass(frozen=True, slots=True)
class ChangeSpeed:
    """So many notches faster or slower: counted where the speed is known, not from a drawing that may be late."""

    notches: int


@dataclass(frozen=True, slots=True)
class Restart:
    """Begin the recording again with an empty map (a live stream keeps flowing, the map starts anew)."""


@dataclass(frozen=True, slots=True)
class Undo:
    """Take back the last action that took something away, while it is offered."""


@dataclass(frozen=True, slots=True)
class Agree:
    """Carry out what the question of this number holds back."""

    number: int


@dataclass(frozen=True, slots=True)
class Decline:
    """Drop what the question of this number holds back."""

    number: int


@dataclass(frozen=True, slots=True)
class Seek:
    """Go to this time of the recording, by running up to it."""

    time_ns: int


@dataclass(frozen=True, slots=True)
class Configure:
    """Change one setting, by its dotted name, from the scan that is shown on. throughout: for the whole run."""

    name: str
    value: float | int | bool | str
    throughout: bool = False


@dataclass(frozen=True, slots=True)
class ConfigureAll:
    """Change several settings at once, by their dotted names, as `Configure` does. title: for the log."""

    title: str
    values: Mapping[str, float | int | bool | str]
    throughout: bool = False


@dataclass(frozen=True, slots=True)
class Save:
    """Leave the results so far in the folder that the program was started with."""


@dataclass(frozen=True, slots=True)
class Repair:
    """Open the source again with what the sensor check found put right, and begin again."""


@dataclass(frozen=True, slots=True)
class Examine:
    """Read the whole recording beside the run, and find what is wrong with it."""


@dataclass(frozen=True, slots=True)
class Export:
    """Make an archive of the results so far for a browser, in these formats."""

    client: int
    formats: tuple[Exporter, ...]


@dataclass(frozen=True, slots=True)
class Pick:
    """Where somebody points.

    places: where the sight meets the levels, the nearest first. reach: metres from there to a beam at most.
    """

    places: tuple[CellTarget, ...]
    reach: float


AHEAD = -1  # in place of the number of a beam: the middle one


@dataclass(frozen=True, slots=True)
class Inspect:
    """A browser looks at the beam or cell under a point, at a beam by its number, or at nothing (None)."""

    client: int
    what: Pick | int | None


@dataclass(frozen=True, slots=True)
class Answer:
    """Work beside the engine has ended: a line for the log. Sent by the engine's own threads only."""

    text: str
    failed: bool = False


@dataclass(frozen=True, slots=True)
class Quit:
    """End the engine."""


Command = (
    Play
    | Pause
    | PlayPause
    | StepScan
    | StepBack
    | SetSpeed
    | ChangeSpeed
    | Restart
    | Undo
    | Agree
    | Decline
    | Seek
    | Configure
    | ConfigureAll
    | Save
    | Repair
    | Inspect
    | Examine
    | Export
    | Answer
    | Quit
)
