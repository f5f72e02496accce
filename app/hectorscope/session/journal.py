"""The journal of a live run: its messages, its newest checkpoint and its actions are on the disk at all times."""

import json
import time
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any, NamedTuple

from hectorscope.inputs import Source, Tappable
from hectorscope.ros.stream_recorder import RecordError, StreamRecorder
from hectorscope.run.annotations import Annotations
from hectorscope.run.checkpoints import Checkpoint, Place
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from hectorscope.session import journal_files
from hectorscope.session.active_run import ActiveRun
from hectorscope.session.checkpoint_file import Position, Saved, behind, our_version, read_checkpoint
from hectorscope.session.journal_files import KEPT_BYTES, Hold, JournalError
from hectorscope.session.journal_writer import JournalWriter
from hectorscope.session.transport import PAUSED
from slam_core.errors import SlamError
from slam_core.localization.prior_map import PriorMap
from slam_core.measurements import LaserScan

CHECKPOINT_S = 60.0
BURST, BURST_S = 60, 10.0  # so many keyframes more are worth a checkpoint of their own, but not more often
WANTED_S = 1.0  # nor does a slider that is dragged ask for more than one in such a time
NOWHERE = Place(0, None)
TOLD = 100  # scans from one word on the progress to the next


class Resumed(NamedTuple):
    """A run that is gone on with. again: scans that were processed again for that.

    left_out: why its checkpoint was not used; empty if it was, or if there is none.
    """

    pipeline: Pipeline
    again: int
    annotations: Annotations
    left_out: str = ""


class Journal:
    """Belongs to the engine's thread. What goes wrong is told by `warning`, and the run goes on.

    reopen: opens the messages of an earlier run. past: the folder of the run of this address that ended badly.
    wanted: something changed that a checkpoint has to hold.
    """

    def __init__(
        self, root: Path, address: str, reopen: Callable[[Path], Source], *, kept_bytes: int = KEPT_BYTES
    ) -> None:
        """kept_bytes: of all journals. JournalError if nothing can be written there."""
        our_version()
        self._root, self._address, self._reopen = root, address, reopen
        self.past: Path | None = None
        self._held: Hold | None = None
        self._find_past()
        self._replaced: tuple[Path, Hold] | None = None
        self.folder = journal_files.begin(root, address)
        self._hold = Hold(self.folder)
        journal_files.forget_old(root, kept_bytes)
        self._unrecorded = ""
        self.wanted = False
        self._last: Checkpoint | None = None
        self._kept_at, self._kept_updates = 0.0, 0
        self._writer = JournalWriter(self.folder)
        try:
            self._recorder: StreamRecorder | None = StreamRecorder(self.folder)
        except RecordError as error:
            self._recorder, self._unrecorded = None, str(error)

    @property
    def warning(self) -> str:
        """What cannot be written, with the remedy; empty while all is well."""
        return "; ".join(filter(None, (self._unrecorded, self._writer.warning)))

    def listen(self, source: Source) -> None:
        """Keep what a stream brings from now on."""
        if isinstance(source, Tappable) and self._recorder is not None:
            source.tap(self._recorder)

    def keep(self, run: ActiveRun, *, paused: bool = False) -> None:
        """Write a checkpoint beside the run if it is time. paused: whether its scans are let go by."""
        updates = run.pipeline.slam.map.updates
        if run.last is None or run.waiting is not None or not run.pipeline.scans:
            return
        if self._writer.busy or not self._is_due(updates):
            return
        self._kept_at, self._kept_updates = time.monotonic(), updates
        self._last = Checkpoint(run.pipeline, NOWHERE, self._last)
        saved = Saved(self._last, run.settings, Position.of(run.last), run.annotations, paused)
        self._writer.write(saved, self._close_replaced if self._replaced else lambda: None)
        self.wanted = False

    @property
    def patience(self) -> float | None:
        """Seconds until a checkpoint may be due that does not wait for items; None for ever."""
        return WANTED_S if self.wanted or self._writer.failed else None

    def _is_due(self, updates: int) -> bool:
        age = time.monotonic() - self._kept_at
        soon = updates - self._kept_updates >= BURST or self._writer.failed
        return age >= CHECKPOINT_S or (soon and age >= BURST_S) or (self.wanted and age >= WANTED_S)

    def log(self, entry: dict[str, Any]) -> None:
        """Append an action; a moment later it is on the disk."""
        self._writer.log(json.dumps(entry, default=str, ensure_ascii=False) + "\n")

    def resumed(
        self, settings: Settings, prior_map: PriorMap | None, told: Callable[[str], None] = lambda _: None
    ) -> "Resumed":
        """The run that ended badly: its checkpoint and what came then; an older one if that holds no scan.

        settings, prior_map: for a run without a checkpoint. told: hears how far it is. JournalError without any.
        """
        passed_over: list[str] = []
        while self.past is not None:
            try:
                found = resumed(self.past, self._reopen, settings, prior_map, told)
                return found._replace(left_out="; ".join(filter(None, (*passed_over, found.left_out))))
            except JournalError as error:
                passed_over.append(str(error))
                self.forget_past()
                self._close_replaced()
                self._find_past()
        raise JournalError("; ".join((*passed_over, "There is no run that could be gone on with")))

    def _find_past(self) -> None:
        self.past = journal_files.ended_badly(self._root, self._address)
        self._held = Hold(self.past) if self.past else None

    def give_up_past(self) -> None:
        """The next start does not offer the earlier run; until then it can still be gone on with."""
        if self.past is not None:
            journal_files.mark_closed(self.past)

    def forget_past(self) -> None:
        """The earlier run is gone on with: it is closed once a checkpoint of that is on the disk."""
        if self.past is not None and self._held is not None:
            self._replaced = self.past, self._held
        self.past = self._held = None
        self.wanted = True

    def _close_replaced(self) -> None:
        replaced, self._replaced = self._replaced, None
        if replaced is not None:
            journal_files.mark_closed(replaced[0])
            replaced[1].release()

    def close(self) -> None:
        """The run ended in order."""
        if self._recorder is not None:
            self._recorder.close()
        self._writer.close()
        self._close_replaced()
        journal_files.mark_closed(self.folder)
        self._hold.release()
        if self._held is not None:
            self._held.release()


def resumed(
    folder: Path,
    reopen: Callable[[Path], Source],
    settings: Settings,
    prior_map: PriorMap | None,
    told: Callable[[str], None] = lambda _: None,
) -> Resumed:
    """The run as it was when a journal ended. told: hears how far it is. JournalError if it holds no scan."""
    saved, left_out = _checkpoint(folder)
    if saved is not None:
        pipeline, marks = saved.checkpoint.pipeline(saved.settings), saved.annotations
    else:
        pipeline, marks = Pipeline(settings, None, prior_map, live=True), Annotations()
    scans = pipeline.scans
    try:
        source = reopen(folder)
    except SlamError as error:
        if saved is None:
            raise JournalError(f"{folder} holds nothing that could be gone on with ({error})") from error
        return Resumed(pipeline, 0, marks, left_out)
    with closing(source):
        _process(pipeline, source, saved, told)
    if not pipeline.scans:
        raise JournalError(f"{folder} holds no scan that could be gone on with")
    return Resumed(pipeline, pipeline.scans - scans, marks, left_out)


def _checkpoint(folder: Path) -> tuple[Saved | None, str]:
    """The one of a journal, and why it is left out."""
    try:
        return read_checkpoint(folder), ""
    except JournalError as error:
        return None, str(error)


def _process(pipeline: Pipeline, source: Source, saved: Saved | None, told: Callable[[str], None]) -> None:
    """What came behind a checkpoint. Scans that a pause let go by are let go by again."""
    processed = 0
    for item in behind(source.items(), saved.position if saved else None):
        for measurement in pipeline.admit(item):
            if saved is not None and saved.paused and isinstance(measurement, LaserScan):
                pipeline.skip(PAUSED)
                continue
            pipeline.step(measurement)
            processed += isinstance(measurement, LaserScan)
            if isinstance(measurement, LaserScan) and processed % TOLD == 0:
                told(f"Processing the run before again: {processed} scans")
