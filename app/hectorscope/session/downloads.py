"""Makes the files that a browser downloads, on a thread of its own, in a folder that goes with them."""

import zipfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from hectorscope.exporters import Exporter, collected, stream_again, with_map, write
from hectorscope.inputs import Item, Reopenable, Source, SourceReport
from hectorscope.run.metrics import metrics
from hectorscope.run.results import Run
from hectorscope.run.settings import Settings
from hectorscope.session.active_run import ActiveRun
from hectorscope.session.background_task import BackgroundTask
from hectorscope.session.commands import Answer, Export
from hectorscope.session.snapshot import Download
from slam_core.errors import SlamError
from slam_core.localization.prior_map import PriorMap
from slam_core.mapping.pyramid import Pyramid
from slam_core.measurements import LaserScan

LARGEST = 1 << 28  # bytes of an archive: it is sent from memory
AFTER_NS = 1_000_000_000  # of what comes behind the shown scan: the sequencer may wait for it


@dataclass(frozen=True, slots=True, eq=False)
class _Task:
    """What an archive is made of: the results so far, and how to come there once more."""

    client: int
    formats: Sequence[Exporter]
    source: Source
    results: Run
    pyramid: Pyramid
    settings: Settings
    last_ns: int


class Downloads:
    """ready: the latest archive, by the browser that it is for. answer: hears from any thread how it ended."""

    def __init__(self, prior_map: PriorMap | None, answer: Callable[[Answer], None]) -> None:
        self.ready: Mapping[int, Download] = {}
        self._prior_map = prior_map
        self._task = BackgroundTask(
            "export", answer, busy="Another export is being made", failed="The export failed"
        )
        self._made = 0

    def start(self, command: Export, source: Source, run: ActiveRun, report: SourceReport) -> None:
        """Begin with the results so far; SlamError if that cannot be."""
        pipeline = run.pipeline
        self._task.check_idle()
        if not pipeline.scans:
            raise SlamError("There is nothing to export, as no scan has been used yet: wait for the first")
        streams = [each.name for each in command.formats if each.stream]
        if streams and (source.live or not isinstance(source, Reopenable)):
            raise SlamError(
                f"{', '.join(streams)} can only be made of a recording that is read again: leave it out"
            )
        results = collected(pipeline, metrics(pipeline, report), report, run.annotations.marks)
        last_ns = pipeline.last_scan_ns or 0
        pyramid = pipeline.slam.map.copy()
        task = _Task(command.client, command.formats, source, results, pyramid, run.settings, last_ns)
        self._task.start(partial(self._make, task))

    def _make(self, task: _Task) -> str:
        with TemporaryDirectory(prefix="hectorscope-") as folder:
            self._write(task, Path(folder))
            content = packed(Path(folder))
        self._made += 1
        download = Download(self._made, f"{Path(task.source.name).stem or 'run'}.zip", content)
        self.ready = {task.client: download}  # in memory: one at a time
        names = ", ".join(each.name for each in task.formats)
        return f"Exported {names} as {download.name}"

    def _write(self, task: _Task, folder: Path) -> None:
        whole = [each for each in task.formats if each.stream is None]
        if whole:
            write(with_map(task.results, task.pyramid), folder, whole)
        streams = [each for each in task.formats if each.stream is not None]
        if streams and isinstance(task.source, Reopenable):
            source = UpTo(task.source.reopened(), task.last_ns)
            stream_again(source, task.settings, folder, streams, self._prior_map)


class UpTo:
    """A recording up to the shown scan, and what the sequencer may wait for behind it."""

    live = False

    def __init__(self, source: Source, last_ns: int) -> None:
        self.name = source.name
        self._source, self._last_ns = source, last_ns

    @property
    def span_ns(self) -> tuple[int, int] | None:
        """Of the recording."""
        return self._source.span_ns

    @property
    def report(self) -> SourceReport:
        """Of the recording, as far as it was read."""
        return self._source.report

    def items(self) -> Iterator[Item]:
        """Without later scans."""
        for item in self._source.items():
            if item.stamp_ns > self._last_ns + AFTER_NS:
                return
            if not (isinstance(item, LaserScan) and item.stamp_ns > self._last_ns):
                yield item

    def close(self) -> None:
        """Let go of it."""
        self._source.close()


def packed(folder: Path) -> bytes:
    """The files of a folder as one archive; SlamError if it is too large to be sent."""
    archive = folder / "archive.zip"
    files = sorted(folder.iterdir())
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as into:
        for file in files:
            into.write(file, file.name)
    if archive.stat().st_size > LARGEST:
        raise SlamError(
            f"the archive takes more than {LARGEST >> 20} MiB: leave formats out, or use hectorscope run --out DIR"
        )
    return archive.read_bytes()
