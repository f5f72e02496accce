"""hectorscope run: from the flags to the files, without a page."""

import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from hectorscope.cli.opening import checked, get_ready
from hectorscope.cli.options import MapFlags, SettingFlags
from hectorscope.cli.report import show_progress, summary
from hectorscope.common.terminal import printable
from hectorscope.exporters import Exporter, chosen, run
from hectorscope.inputs import Source
from hectorscope.run.metrics import failure
from hectorscope.run.notes import Note, NoteError, note
from hectorscope.run.relations import read_relations
from hectorscope.web import shared_replay

LOST = 3


def process(
    bag: Path,
    out: Path,
    export: str,
    relations: Path | None,
    notes: Iterable[str],
    settings: SettingFlags,
    saved: MapFlags,
    source: Any,
) -> int:
    """Process a recording as fast as it goes, and leave its results in `out`; the exit code."""
    motions = read_relations(relations) if relations else None
    pinned = [*map(note, notes)]
    formats = _formats(export, pinned, bag.name)
    wanted = settings.settings()
    prior_map = saved.prior_map(wanted)
    recording = _ready(bag, source, settings)
    _check_notes(pinned, recording)
    moved: list[str] = []
    try:
        with show_progress(recording) as progress:
            figures = run(
                recording,
                wanted,
                out,
                truth=source.truth_topic,
                progress=progress,
                prior_map=prior_map,
                formats=formats,
                recording=bag,
                relations=motions,
                tell=moved.append,
            )
    finally:
        for line in filter(None, moved):
            print(printable(line))
    summary(recording.name, figures, out)
    if why := failure(figures):
        print(f"hectorscope: {why}", file=sys.stderr)
        return LOST
    return 0


def _formats(export: str, notes: Sequence[Note], name: str) -> list[Exporter]:
    """Those that are wanted; NoteError for notes without the replay that shows them."""
    formats = chosen(export, [shared_replay.exporter(notes, name)])
    if notes and all(each.name != "html" for each in formats):
        raise NoteError("--note is for the replay, which is not among the formats: add html to --export")
    return formats


def _check_notes(notes: Iterable[Note], recording: Source) -> None:
    """NoteError for one behind the end of the recording."""
    first_ns, last_ns = recording.span_ns or (0, 2**63)
    length_s = (last_ns - first_ns) / 1e9
    for each in notes:
        if each.seconds > length_s:
            raise NoteError(
                f"--note at {each.seconds:g} s is behind the end of {recording.name}: give 0 to {length_s:.1f} s"
            )


def _ready(bag: Path, source: Any, settings: SettingFlags) -> Source:
    """The recording, whose sensors were checked, with the kernels compiled."""
    recording = checked(str(bag), source, settings)
    get_ready()
    recording.check()
    return recording
