"""Notes that an author pins to moments of a run."""

import math
from dataclasses import dataclass

from slam_core.errors import SlamError

LONGEST = 500  # characters
LAST_S = 1e9


class NoteError(SlamError):
    """A note without a time, or without a text."""


@dataclass(frozen=True, slots=True)
class Note:
    """What the author says of a moment. seconds: since the start of the run."""

    seconds: float
    text: str


def note(words: str) -> Note:
    """Of TIME=TEXT, as the command line gives it; NoteError otherwise."""
    time, _, text = words.partition("=")
    try:
        seconds = float(time)
    except ValueError:
        seconds = math.nan
    if not (0.0 <= seconds < LAST_S and text.strip()):
        raise NoteError(f"--note {words!r} is no note: give TIME=TEXT, with seconds since the start")
    if len(text) > LONGEST:
        raise NoteError(f"--note at {seconds:g} s has {len(text)} characters: give {LONGEST} at most")
    return Note(seconds, text.strip())
