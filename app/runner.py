"""The headless run: the whole recording through the pipeline as fast as it goes, and files at the end."""

import tempfile
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from itertools import islice
from pathlib import Path
from typing import Any

from app.exporters import Run, exporters
from app.metrics import Effort, metrics
from app.pipeline import Pipeline, nothing_used
from app.publisher import map_images, merged
from app.settings import Settings
from app.snapshot import SourceReport
from app.sources import Item, Source, SourceError
from slam_core.errors import SlamError
from slam_core.given import GivenMap, saved_levels
from slam_core.measurements import LaserScan

Progress = Callable[[int], None]

# Items are read so many at a time: one by one between the scans, each would find the caches full of map.
READ_AHEAD = 256
# Bytes that must find room before the work is begun: about what the files of a very short run take.
PROBE = 2**16


class OutputError(SlamError):
    """The folder for the results cannot be used."""


def run_headless(
    source: Source,
    settings: Settings,
    progress: Progress = lambda _: None,
    given: GivenMap | None = None,
) -> tuple[Pipeline, Effort]:
    """Every item of `source`, in a plain loop. progress: called with the time of every scan. Closes the source.

    given: the map to begin with. SourceError when not a single scan could be used.
    """
    begin = time.perf_counter()
    span = source.span_ns
    pipeline = Pipeline(settings, span[0] if span else None, given)
    try:
        for item in _read_ahead(source.items()):
            for measurement in pipeline.admit(item):
                pipeline.step(measurement)
            if isinstance(item, LaserScan):
                progress(item.stamp_ns)
        for measurement in pipeline.flush():
            pipeline.step(measurement)
    finally:
        source.close()
    if not pipeline.scans:
        raise nothing_used(source.name, merged(source.report, pipeline.skipped, 0).skipped, pipeline.slam)
    recorded = (span[1] - span[0]) / 1e9 if span else float(pipeline.trajectory[-1, 0])
    return pipeline, Effort(recorded, time.perf_counter() - begin)


def _read_ahead(items: Iterator[Item]) -> Iterator[Item]:
    while some := list(islice(items, READ_AHEAD)):
        yield from some


def prepare(folder: Path) -> None:
    """Make the folder for the results, and try it, before the work is done; OutputError if it is of no use."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{folder} cannot be made ({error.strerror}): give another --out") from error
    try:
        with tempfile.NamedTemporaryFile(dir=folder, prefix=".probe.") as probe:
            probe.write(bytes(PROBE))
    except OSError as error:
        raise OutputError(f"{folder} cannot be written to ({error.strerror}): give another --out") from error
    for name in _names():
        if (folder / name).is_dir():
            raise OutputError(
                f"{folder / name} is a folder where a file is to be: remove it or give another --out"
            )


def _names() -> list[str]:
    return [name for exporter in exporters() for name in exporter.files]


def export(pipeline: Pipeline, figures: dict[str, Any], folder: Path) -> list[Path]:
    """Write every format, whatever becomes of the others; the files written. OutputError tells what is missing."""
    run = Run(
        pipeline.start_ns or 0,
        pipeline.trajectory,
        map_images(pipeline),
        pipeline.settings,
        figures,
        saved_levels(pipeline.slam.pyramid),
        pipeline.navigation,
    )
    missing: defaultdict[str, list[str]] = defaultdict(list)
    for exporter in exporters():
        try:
            exporter.write(run, folder)
        except OSError as error:
            missing[error.strerror or str(error)] += exporter.files
        except Exception as error:  # what one format chokes on must not cost the others
            missing[f"{type(error).__name__}: {error}"] += exporter.files
    if missing:
        reasons = "; ".join(f"{reason}: {', '.join(files)}" for reason, files in missing.items())
        raise OutputError(f"{folder} cannot be written to ({reasons}): give another --out")
    return [folder / name for name in _names() if (folder / name).exists()]


def save(pipeline: Pipeline, report: SourceReport, folder: Path | None) -> str:
    """Write every format of a run that need not be at its end, and say so; OutputError if that cannot be."""
    if folder is None:
        raise OutputError("there is no folder to save to: start the program with --out DIR")
    if not pipeline.scans:
        raise OutputError("nothing was saved, as no scan has been used yet: wait for the first")
    files = export(pipeline, metrics(pipeline, report), folder)
    return f"Saved {', '.join(file.name for file in files)} in {folder}"


def run(
    source: Source,
    settings: Settings,
    folder: Path,
    *,
    truth: str | None,
    progress: Progress,
    given: GivenMap | None = None,
) -> dict[str, Any]:
    """All of it; the metrics. truth: a topic that was asked for by name and so must be there."""
    prepare(folder)
    pipeline, effort = run_headless(source, settings, progress, given)
    figures = metrics(pipeline, source.report, effort)
    if truth is not None and figures["truth"] is None:
        raise SourceError(f"{truth} holds no truth at the times of the scans: choose another --truth")
    export(pipeline, figures, folder)
    return figures
