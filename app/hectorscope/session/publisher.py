"""Composes snapshots of a pipeline and leaves them in the mailbox, no more often than anybody can look."""

import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from hectorscope.inputs import Finding, Source, SourceReport
from hectorscope.run.fingerprint import Identity
from hectorscope.run.map_image import MapImage
from hectorscope.run.map_images import map_images
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.readings import View
from hectorscope.run.series import SERIES_DTYPE
from hectorscope.run.wording import verdict_text
from hectorscope.session.event_log import EventLog
from hectorscope.session.mailbox import Mailbox
from hectorscope.session.other_scans import OtherScans
from hectorscope.session.rework import Rework
from hectorscope.session.snapshot import (
    Ahead,
    Compared,
    Download,
    Listed,
    ListedRun,
    LogEntry,
    PlaybackStatus,
    Question,
    Snapshot,
    UndoOffer,
)
from hectorscope.session.station_state import StationState
from hectorscope.session.transport import Transport
from hectorscope.steering import DriveState
from slam_core.config import SlamConfig
from slam_core.results import StepResult

SNAPSHOT_S = 1 / 60
MAPS_S = 1 / 5
SHARE = 20  # times as long as a map took to draw it stays: one of kilometres is drawn more rarely
STREAM_S = 1 / 2  # a stream's counters are shown this often even when no scan comes

LogLevel = Literal["info", "warning", "error"]


@dataclass(frozen=True, slots=True)
class Run:
    """What a snapshot is composed of. config: the one in force now. behind: scans of a stream to catch up with.

    lag, kept_ns: as in a `PlaybackStatus`. The others: as in a `Snapshot`.
    """

    source: Source
    pipeline: Pipeline
    transport: Transport
    config: SlamConfig
    report: SourceReport
    epoch: int
    saves: bool
    obeyed: int
    question: Question | None
    undo: UndoOffer | None
    ahead: Ahead
    behind: int
    lag: float | None
    kept_ns: tuple[int, int] | None
    library: tuple[Listed, ...]
    recording: Identity | None
    map_sha256: str
    views: Mapping[int, View | None]
    examined: tuple[Finding, ...] | None
    runs: tuple[ListedRun, ...]
    shown_run: int
    keeps: bool
    compared: Compared | None
    downloads: Mapping[int, Download]
    station: StationState
    drive: DriveState | None
    rework: Rework | None
    other_scans: OtherScans | None


class Publisher:
    """Keeps the log, the map images and the pace of the snapshots. event_log: of the recording that is shown."""

    def __init__(self, mailbox: Mailbox[Snapshot]) -> None:
        self._mailbox = mailbox
        self.event_log = EventLog()
        self._news = True
        self._sequence = 0
        self._published = 0.0
        self._maps: tuple[MapImage, ...] = ()
        self._drawn: tuple[int, int] | None = None  # epoch and map updates that the images show
        self._drawn_at = 0.0
        self._maps_s = MAPS_S
        self._revision = 0

    def log(self, entry: LogEntry) -> None:
        """One more line for the page."""
        self.event_log.add(entry)
        self.touch()

    def touch(self) -> None:
        """There is something new to show."""
        self._news = True

    @property
    def age(self) -> float:
        """Seconds since the last snapshot."""
        return time.monotonic() - self._published

    def due(self, *, resting: bool = False, live: bool = False) -> bool:
        """Whether to publish now: news wait for their turn, unless the engine is about to rest."""
        waited = self._news and (resting or self.age >= SNAPSHOT_S)
        return waited or (live and self.age >= STREAM_S)

    def publish(self, run: Run, *, complete: bool) -> None:
        """Put a snapshot into the mailbox. complete: show the map as it is now, however recently it was drawn."""
        pipeline = run.pipeline
        warnings = (*run.report.warnings, *pipeline.warnings())
        self._log_notes(run)
        self._published = time.monotonic()
        self._news = False
        self._sequence += 1
        self._draw_maps(pipeline, run.epoch, complete)
        snapshot = Snapshot(
            sequence=self._sequence,
            epoch=run.epoch,
            source=run.source.name,
            playback=status(run),
            config=run.config,
            result=pipeline.result,
            trajectory=pipeline.trajectory,
            navigation=pipeline.navigation,
            truth=pipeline.truth,
            truth_in_map=pipeline.truth_in_map,
            series=pipeline.series.view(SERIES_DTYPE).reshape(-1),
            maps=self._maps,
            map_updates=pipeline.slam.map.updates,
            scans=pipeline.scans,
            report=run.report,
            log=self.event_log.entries,
            mode=pipeline.mode,
            searching=pipeline.searching,
            warnings=warnings,
            unused=dict(pipeline.slam.status.unused),
            saves=run.saves,
            obeyed=run.obeyed,
            question=run.question,
            undo=run.undo,
            library=run.library,
            recording=run.recording,
            map_sha256=run.map_sha256,
            runs=run.runs,
            shown_run=run.shown_run,
            keeps=run.keeps,
            compared=run.compared,
            ahead=run.ahead,
            views=run.views,
            examined=run.examined,
            downloads=run.downloads,
            station=run.station,
            drive=run.drive,
            rework=run.rework,
            other_scans=run.other_scans,
        )
        self._mailbox.put(snapshot)

    def _log_notes(self, run: Run) -> None:
        """What the source and the pipeline found, and what holds the pipeline back, each once."""
        pipeline = run.pipeline
        now_ns, now_scans = pipeline.time_ns, pipeline.scans
        for note in (*run.report.notes, *pipeline.notes):
            self.log_once(LogEntry(now_ns, note, "info", now_scans))
        for warning in (*run.report.warnings, *run.station.warnings):
            self.log_once(LogEntry(now_ns, warning, "warning", now_scans))
        for warning, (time_ns, scans) in pipeline.warned.items():
            self.log_once(LogEntry(time_ns, warning, "warning", scans))

    def log_once(self, entry: LogEntry) -> None:
        """A line whose text is not in the log of this recording yet."""
        if self.event_log.is_new(entry.text):
            self.log(entry)

    def _draw_maps(self, pipeline: Pipeline, epoch: int, complete: bool) -> None:
        state = (epoch, pipeline.slam.map.revision)
        anew = self._drawn is None or epoch != self._drawn[0]
        if state == self._drawn or not (anew or complete or self._published - self._drawn_at >= self._maps_s):
            return
        self._drawn, self._drawn_at = state, self._published
        self._revision += 1
        self._maps = map_images(pipeline.slam.map, self._revision)
        self._maps_s = max(MAPS_S, SHARE * (time.monotonic() - self._published))


def status(run: Run) -> PlaybackStatus:
    """Where the run is."""
    source, pipeline, transport = run.source, run.pipeline, run.transport
    span, start_ns, time_ns = source.span_ns, pipeline.start_ns or 0, pipeline.time_ns
    detail = transport.opening or transport.failure or run.report.waiting
    if run.behind:
        detail = detail or f"catching up with the stream: {run.behind} scans behind"
    if run.lag is not None:
        detail = f"behind by {run.lag:.0f} s"
    if transport.processed_again:
        detail = detail or "scan processed again"
    if transport.target_ns is not None:
        whole_ns = max(1, transport.target_ns - start_ns)
        detail = f"running up to {whole_ns / 1e9:.1f} s: {100 * (time_ns - start_ns) // whole_ns} %"
    return PlaybackStatus(
        state=transport.state(pipeline.scans),
        live=source.live,
        time_ns=time_ns,
        start_ns=start_ns,
        end_ns=span[1] if span else None,
        speed=transport.speed,
        realtime_factor=transport.meter.realtime_factor,
        scan_rate=transport.meter.scan_rate,
        detail=detail,
        kept_ns=run.kept_ns,
        lag=run.lag,
        seeks=transport.seeks,
        preparing=transport.preparing,
        prepared=transport.prepared,
    )


def change_of_tracking(before: StepResult | None, result: StepResult | None) -> tuple[str, LogLevel] | None:
    """What to log when the pose is lost or found between two scans; None if that did not change."""
    if before is None or result is None or result.tracking in {before.tracking, "tracking"}:
        return None
    reason = verdict_text(result.verdict)
    because = f": {reason}" if reason else ""
    return f"The pose is {result.tracking}{because}", "info" if result.tracking == "recovered" else "warning"
