"""Leaves snapshots in the mailbox, with log and map images, no more often than anybody can look."""

import time
from dataclasses import replace
from typing import Literal

from hectorscope.run.map_image import MapImage
from hectorscope.run.map_images import map_images
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.wording import verdict_text
from hectorscope.session.event_log import EventLog
from hectorscope.session.mailbox import Mailbox
from hectorscope.session.snapshot import LogEntry, Snapshot
from slam_core.results import StepResult

SNAPSHOT_S = 1 / 60
MAPS_S = 1 / 5
SHARE = 20  # times as long as a map took to draw it stays: one of kilometres is drawn more rarely
STREAM_S = 1 / 2  # a stream's counters are shown this often even when no scan comes

LogLevel = Literal["info", "warning", "error"]


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

    def publish(self, snapshot: Snapshot, pipeline: Pipeline, *, complete: bool) -> None:
        """Put a snapshot of a run into the mailbox, with its number, map images and log.

        complete: show the map as it is now, however recently it was drawn.
        """
        self._log_notes(snapshot, pipeline)
        self._published = time.monotonic()
        self._news = False
        self._sequence += 1
        self._draw_maps(pipeline, snapshot.epoch, complete)
        log = self.event_log.entries
        self._mailbox.put(replace(snapshot, sequence=self._sequence, maps=self._maps, log=log))

    def _log_notes(self, snapshot: Snapshot, pipeline: Pipeline) -> None:
        """What the source and the pipeline found, and what holds the pipeline back, each once."""
        now_ns, now_scans = pipeline.time_ns, pipeline.scans
        for note in (*snapshot.report.notes, *pipeline.notes):
            self.log_once(LogEntry(now_ns, note, "info", now_scans))
        for warning in (*snapshot.report.warnings, *snapshot.station.warnings):
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


def change_of_tracking(before: StepResult | None, result: StepResult | None) -> tuple[str, LogLevel] | None:
    """What to log when the pose is lost or found between two scans; None if that did not change."""
    if before is None or result is None or result.tracking in {before.tracking, "tracking"}:
        return None
    reason = verdict_text(result.verdict)
    because = f": {reason}" if reason else ""
    return f"The pose is {result.tracking}{because}", "info" if result.tracking == "recovered" else "warning"
