"""Files that a run leaves, at its end or on the way. One file a format; each has `EXPORTER`, an `Exporter`."""

import sys
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from difflib import get_close_matches
from pathlib import Path
from types import MappingProxyType
from typing import Any

from hectorscope.common.registry import members
from hectorscope.exporters._exporter import Exporter, Stream
from hectorscope.exporters._files import GrowingFile, unfinished
from hectorscope.exporters._folder import OutputError, locked, make, set_aside
from hectorscope.exporters._streams import Streams, reason
from hectorscope.inputs import Source, SourceError, SourceReport
from hectorscope.ros.roles import NOTHING
from hectorscope.run.annotations import Annotation
from hectorscope.run.headless import Progress, run_headless
from hectorscope.run.map_images import FILE, map_images
from hectorscope.run.metrics import metrics as run_metrics  # a module of this package has the name
from hectorscope.run.metrics import truth_errors
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.relations import relation_figures
from hectorscope.run.results import Run
from hectorscope.run.settings import Settings
from slam_core.errors import SlamError
from slam_core.evaluation.relations import Relations
from slam_core.localization.prior_map import PriorMap, saved_levels
from slam_core.mapping.pyramid import Pyramid

__all__ = [
    "REPLAY",
    "Exporter",
    "GrowingFile",
    "OutputError",
    "Stream",
    "chosen",
    "clear",
    "collected",
    "export",
    "exporters",
    "prepare",
    "reserved",
    "run",
    "saving",
    "stream_again",
    "with_map",
    "write",
]

DEFAULT, ALL = "default", "all"
REPLAY = "replay.html"  # of the format that `web` adds


class FormatError(SlamError):
    """A format that does not exist was asked for."""


def exporters() -> list[Exporter]:
    """Every exporter of this folder, in order."""
    return sorted(members(sys.modules[__name__], "EXPORTER"), key=lambda exporter: exporter.order)


def chosen(names: str = DEFAULT, further: Iterable[Exporter] = ()) -> list[Exporter]:
    """The exporters of names with commas between them, in order; FormatError for a name that is none.

    `default` stands for what is written without a word, `all` for everything. further: formats of other packages.
    """
    known = sorted([*exporters(), *further], key=lambda exporter: exporter.order)
    groups = {DEFAULT: {e.name for e in known if e.default}, ALL: {e.name for e in known}}
    groups |= {exporter.name: {exporter.name} for exporter in known}
    wanted: set[str] = set()
    for name in (each.strip().lower() for each in names.split(",")):
        if name not in groups:
            raise FormatError(
                f"--export {name!r} is no format: did you mean {_nearest(name, known)}?"
                f" There are {', '.join(sorted(groups))}"
            )
        wanted |= groups[name]
    return [exporter for exporter in known if exporter.name in wanted]


def _nearest(name: str, known: Iterable[Exporter]) -> str:
    """The format whose name, or whose files' suffix, is most like a word."""
    suffixes = {Path(file).suffix.strip("."): exporter.name for exporter in known for file in exporter.files}
    words = {**suffixes, ALL: ALL, DEFAULT: DEFAULT, **{exporter.name: exporter.name for exporter in known}}
    return words[get_close_matches(name, words, n=1, cutoff=0.0)[0]]


@contextmanager
def reserved(folder: Path, formats: Iterable[Exporter] | None = None) -> Iterator[None]:
    """`prepare` a folder, and keep other programs of this kind out of it; OutputError if one is there."""
    prepare(folder, formats)
    with locked(folder):
        yield


def prepare(folder: Path, formats: Iterable[Exporter] | None = None) -> None:
    """Make the folder for the results, and try it, before the work is done; OutputError if it is of no use."""
    make(folder, _names(chosen() if formats is None else formats))


def clear(folder: Path) -> str:
    """Set the results of an earlier run aside before those of another come; a sentence if there were any."""
    return set_aside(folder, [*_names(exporters()), REPLAY])


def _clear_unfinished(folder: Path) -> str:
    """Likewise what a run left that did not come to its end."""
    return set_aside(folder, [unfinished(folder / name).name for name in [*_names(exporters()), REPLAY]])


def _names(formats: Iterable[Exporter]) -> list[str]:
    return [name for exporter in formats for name in exporter.files]


def collected(
    pipeline: Pipeline,
    figures: dict[str, Any],
    report: SourceReport | None = None,
    annotations: tuple[Annotation, ...] = (),
) -> Run:
    """The results so far without the map; the run may go on, and they stay as they are. report: of the source."""
    if annotations:
        figures = {**figures, "marks": [mark.told(pipeline.start_ns or 0) for mark in annotations]}
    return Run(
        pipeline.start_ns or 0,
        pipeline.trajectory,
        (),
        pipeline.settings,
        figures,
        report=report or SourceReport(),
        navigation=pipeline.navigation,
        series=pipeline.series,
        annotations=annotations,
    )


def with_map(run: Run, pyramid: Pyramid) -> Run:
    """Results with the map as images and cells."""
    return replace(run, maps=map_images(pyramid, most=FILE), levels=saved_levels(pyramid))


def export(
    pipeline: Pipeline, figures: dict[str, Any], folder: Path, report: SourceReport | None = None
) -> list[Path]:
    """`write` the results so far."""
    return write(with_map(collected(pipeline, figures, report), pipeline.slam.map), folder)


def write(
    run: Run,
    folder: Path,
    formats: Iterable[Exporter] | None = None,
    failed: Mapping[str, list[str]] = MappingProxyType({}),
) -> list[Path]:
    """Write every format, even if another fails; the files written. OutputError names what is missing.

    formats: those of `chosen`; None takes the default. failed: reason -> files that are missing already.
    """
    formats = chosen() if formats is None else formats
    missing = defaultdict(list, failed)
    for exporter in formats:
        try:
            exporter.write(run, folder)
        except Exception as error:  # what one format chokes on must not cost the others
            missing[reason(error)] += exporter.files
    if missing:
        reasons = "; ".join(f"{why}: {', '.join(files)}" for why, files in missing.items())
        raise OutputError(f"{folder} cannot be written to ({reasons}): give another --out")
    return [folder / name for name in _names(formats) if (folder / name).exists()]


def saving(
    pipeline: Pipeline, report: SourceReport, folder: Path | None, annotations: tuple[Annotation, ...] = ()
) -> Callable[[], str]:
    """Collect the results of a run that may go on. The function writes them, from any thread; it gives a sentence.

    OutputError, also from the function, if they cannot be saved.
    """
    if folder is None:
        raise OutputError("there is no folder to save to: start the program with --out DIR")
    if not pipeline.scans:
        raise OutputError("nothing was saved, as no scan has been used yet: wait for the first")
    results = collected(pipeline, run_metrics(pipeline, report, with_truth=False), report, annotations)
    truth, pyramid = pipeline.truth, pipeline.slam.map.copy()

    def save() -> str:
        figures = {**results.metrics, "truth": truth_errors(results.trajectory, truth)}
        files = write(with_map(replace(results, metrics=figures), pyramid), folder)
        return f"Saved {', '.join(file.name for file in files)} in {folder}"

    return save


def stream_again(
    source: Source,
    settings: Settings,
    folder: Path,
    formats: Iterable[Exporter],
    prior_map: PriorMap | None = None,
) -> None:
    """Process a recording once more for formats that are written meanwhile; OutputError names what is missing."""
    with Streams(formats, folder) as streams:
        pipeline, _ = run_headless(source, settings, prior_map=prior_map, observe=streams.add)
        streams.finish(pipeline)
    if streams.missing:
        raise OutputError("; ".join(f"{why}: {', '.join(files)}" for why, files in streams.missing.items()))


def run(
    source: Source,
    settings: Settings,
    folder: Path,
    *,
    truth: str | None,
    progress: Progress,
    prior_map: PriorMap | None = None,
    formats: Iterable[Exporter] | None = None,
    recording: Path | None = None,
    relations: Relations | None = None,
    tell: Callable[[str], None] = lambda _: None,
) -> dict[str, Any]:
    """All of it; the metrics.

    truth: a topic that was asked for by name: SourceError, behind the results, if it scores nothing. formats: as
    in `write`. recording: the file or folder that `source` reads, for what names it. relations: true motions that
    the metrics score it by. tell: hears where the results of an earlier run are.
    """
    formats = chosen() if formats is None else list(formats)
    with reserved(folder, formats), Streams(formats, folder) as streams:
        moved = _clear_unfinished(folder)
        pipeline, effort = run_headless(source, settings, progress, prior_map, streams.add)
        figures = run_metrics(pipeline, source.report, effort)
        if relations is not None:
            figures["relations"] = relation_figures(pipeline.trajectory, pipeline.start_ns or 0, relations)
        tell(clear(folder) or moved)
        streams.finish(pipeline)
        results = replace(collected(pipeline, figures, source.report), recording=recording)
        write(with_map(results, pipeline.slam.map), folder, formats, streams.missing)
    if truth not in (None, NOTHING) and figures["truth"] is None:
        raise SourceError(
            f"{truth} holds no truth at the times of the scans, so {folder} has no score: choose another --truth"
        )
    return figures
