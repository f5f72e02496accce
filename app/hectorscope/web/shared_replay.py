"""replay.html: the scene of a run with timeline, curves, log and notes in one file, which needs no server.

viser, which draws it, is loaded with the first scan: the names of the formats must come at once.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from hectorscope.exporters import Exporter, Stream
from slam_core.errors import SlamError

NAME = "replay.html"
LONGEST_NOTE = 500  # characters
MOST_NOTES = 200


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
        seconds = -1.0
    if not (0.0 <= seconds < 1e9 and text.strip()):
        raise NoteError(f"--note {words!r} is no note: give TIME=TEXT, with seconds since the start")
    if len(text) > LONGEST_NOTE:
        raise NoteError(f"--note at {seconds:g} s has {len(text)} characters: give {LONGEST_NOTE} at most")
    return Note(seconds, text.strip())


def exporter(notes: Sequence[Note] = (), source: str = "") -> Exporter:
    """The format html, with these notes pinned to their moments. source: the name of what was run."""
    return Exporter("html", (NAME,), order=95, stream=partial(_stream, tuple(notes), source))


def _stream(notes: tuple[Note, ...], source: str, folder: Path) -> Stream:
    from hectorscope.web.replay import ReplayStream  # noqa: PLC0415

    return ReplayStream(folder, notes, source)
