"""hectorscope run: from the flags to the files, without a page."""

import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from hectorscope.cli.opening import checked, get_ready
from hectorscope.cli.options import MapFlags, SettingFlags
from hectorscope.cli.report import show_progress, summary
from hectorscope.exporters import chosen, run
from hectorscope.inputs import Source
from hectorscope.run.metrics import failure
from hectorscope.run.notes import note
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
    formats = chosen(export, [shared_replay.exporter([*map(note, notes)], bag.name)])
    wanted = settings.settings()
    prior_map = saved.prior_map(wanted)
    recording = _ready(bag, source, settings)
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
        )
    summary(recording.name, figures, out)
    if why := failure(figures):
        print(f"hectorscope: {why}", file=sys.stderr)
        return LOST
    return 0


def _ready(bag: Path, source: Any, settings: SettingFlags) -> Source:
    """The recording, whose sensors were checked, with the kernels compiled."""
    recording = checked(str(bag), source, settings)
    get_ready()
    recording.check()
    return recording
