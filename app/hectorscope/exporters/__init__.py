"""Files that a run leaves, at its end or on the way. One file a format; each has `EXPORTER`, an `Exporter`."""

import os
import sys
import tempfile
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from hectorscope.common.registry import members
from hectorscope.inputs import Source, SourceError, SourceReport
from hectorscope.run.headless import Progress, run_headless
from hectorscope.run.map_images import FILE, map_images
from hectorscope.run.metrics import metrics as run_metrics  # a module of this package has the name
from hectorscope.run.metrics import truth_errors
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.results import Run
from hectorscope.run.settings import Settings
from slam_core.errors import SlamError
from slam_core.localization.prior_map import PriorMap, saved_levels
from slam_core.mapping.pyramid import Pyramid

if sys.platform != "win32":
    import fcntl

# Bytes that must find room before the work is begun: about what the files of a very short run take.
PROBE = 2**16


@dataclass(frozen=True, slots=True)
class Exporter:
    """`write(run, folder)` leaves its files in `folder` (under a temporary name, then renamed).

    `order` sorts the exporters: on a disk that fills up, what comes first is there.
    """

    files: tuple[str, ...]
    write: Callable[[Run, Path], None]
    order: int = 50


def exporters() -> list[Exporter]:
    """Every exporter of this folder, in order."""
    return sorted(members(sys.modules[__name__], "EXPORTER"), key=lambda exporter: exporter.order)


class OutputError(SlamError):
    """The folder for the results cannot be used."""


@contextmanager
def reserved(folder: Path) -> Iterator[None]:
    """`prepare` a folder, and keep other programs of this kind out of it meanwhile; OutputError if one is there.

    The lock is on the folder itself and goes with the process, however that ends.
    """
    prepare(folder)
    if sys.platform == "win32":
        yield
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        os.close(handle)
        raise OutputError(f"another run writes into {folder}: wait for its end, or give another --out") from error
    except OSError:
        pass  # a file system without locks
    try:
        yield
    finally:
        os.close(handle)


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


def collected(pipeline: Pipeline, figures: dict[str, Any], report: SourceReport | None = None) -> Run:
    """The results so far without the map; the run may go on, and they stay as they are. report: of the source."""
    return Run(
        pipeline.start_ns or 0,
        pipeline.trajectory,
        (),
        pipeline.settings,
        figures,
        sensors=report.sensors if report else {},
        navigation=pipeline.navigation,
    )


def with_map(run: Run, pyramid: Pyramid) -> Run:
    """Results with the map as images and cells."""
    return replace(run, maps=map_images(pyramid, most=FILE), levels=saved_levels(pyramid))


def export(
    pipeline: Pipeline, figures: dict[str, Any], folder: Path, report: SourceReport | None = None
) -> list[Path]:
    """`write` the results so far."""
    return write(with_map(collected(pipeline, figures, report), pipeline.slam.map), folder)


def write(run: Run, folder: Path) -> list[Path]:
    """Write every format, even if another fails; the files written. OutputError names what is missing."""
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


def saving(pipeline: Pipeline, report: SourceReport, folder: Path | None) -> Callable[[], str]:
    """Collect the results of a run that may go on. The function writes them, from any thread; it gives a sentence.

    OutputError, also from the function, if they cannot be saved.
    """
    if folder is None:
        raise OutputError("there is no folder to save to: start the program with --out DIR")
    if not pipeline.scans:
        raise OutputError("nothing was saved, as no scan has been used yet: wait for the first")
    results = collected(pipeline, run_metrics(pipeline, report, with_truth=False), report)
    truth, pyramid = pipeline.truth, pipeline.slam.map.copy()

    def save() -> str:
        figures = {**results.metrics, "truth": truth_errors(results.trajectory, truth)}
        files = write(with_map(replace(results, metrics=figures), pyramid), folder)
        return f"Saved {', '.join(file.name for file in files)} in {folder}"

    return save


def run(
    source: Source,
    settings: Settings,
    folder: Path,
    *,
    truth: str | None,
    progress: Progress,
    prior_map: PriorMap | None = None,
) -> dict[str, Any]:
    """All of it; the metrics. truth: a topic that was asked for by name and so must be there."""
    with reserved(folder):
        pipeline, effort = run_headless(source, settings, progress, prior_map)
        figures = run_metrics(pipeline, source.report, effort)
        if truth is not None and figures["truth"] is None:
            raise SourceError(f"{truth} holds no truth at the times of the scans: choose another --truth")
        export(pipeline, figures, folder, source.report)
        return figures
