"""The journal of a live run: its messages, its newest checkpoint and its actions are on the disk at all times."""

import json
import os
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from hectorscope.inputs import Item, Source, Tappable
from hectorscope.ros.stream_recorder import RecordError, StreamRecorder
from hectorscope.run.annotations import Annotations
from hectorscope.run.checkpoints import Checkpoint, Place
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from hectorscope.session import journal_files
from hectorscope.session.active_run import ActiveRun
from hectorscope.session.journal_files import Hold, JournalError, Position, Saved
from slam_core.errors import SlamError
from slam_core.localization.prior_map import PriorMap

CHECKPOINT_S = 60.0
BURST, BURST_S = 60, 10.0  # so many keyframes more are worth a checkpoint of their own, but not more often
NOWHERE = Place(0, None)


class Resumed(NamedTuple):
    """A run that is gone on with. again: scans that were processed again for that."""

    pipeline: Pipeline
    again: int
    annotations: Annotations


class Journal:
    """Belongs to the engine's thread. What goes wrong is told by `warning`, and the run goes on.

    reopen: opens the messages of an earlier run. past: the folder of the run of this address that ended badly.
    """

    def __init__(self, root: Path, address: str, reopen: Callable[[Path], Source]) -> None:
        """JournalError if nothing can be written there."""
        self._root, self._reopen = root, reopen
        self.past = journal_files.ended_badly(root, address)
        self._held = Hold(self.past) if self.past else None
        self.folder = journal_files.begin(root, address)
        self._hold = Hold(self.folder)
        journal_files.forget_old(root)
        self.warning = ""
        self._last: Checkpoint | None = None
        self._kept_at, self._kept_updates = 0.0, 0
        self._thread: threading.Thread | None = None
        try:
            self._recorder: StreamRecorder | None = StreamRecorder(self.folder)
        except RecordError as error:
            self._recorder, self.warning = None, str(error)

    def listen(self, source: Source) -> None:
        """Keep what a stream brings from now on."""
        if isinstance(source, Tappable) and self._recorder is not None:
            source.tap(self._recorder)

    def keep(self, run: ActiveRun, last: Item, *, now: bool = False) -> None:
        """Write a checkpoint beside the run if it is time; last: the item that it had last."""
        pipeline = run.pipeline
        if not pipeline.scans or (self._thread is not None and self._thread.is_alive()):
            return
        age, updates = time.monotonic() - self._kept_at, pipeline.slam.map.updates
        burst = updates - self._kept_updates >= BURST and age >= BURST_S
        if not (now or burst or age >= CHECKPOINT_S):
            return
        self._kept_at, self._kept_updates = time.monotonic(), updates
        self._last = Checkpoint(pipeline, NOWHERE, self._last)
        saved = Saved(self._last, run.settings, Position.of(last), run.annotations)
        self._thread = threading.Thread(target=self._write, args=(saved,), name="journal")
        self._thread.start()

    def _write(self, saved: Saved) -> None:
        try:
            journal_files.write_checkpoint(self.folder, saved)
            self.warning = ""
        except OSError as error:
            self.warning = (
                f"the journal cannot be kept ({self.folder}: {error.strerror}): make room, it is tried again"
            )

    def log(self, entry: dict[str, Any]) -> None:
        """Append an action, and have it on the disk."""
        line = json.dumps(entry, default=str, ensure_ascii=False) + "\n"
        try:
            with (self.folder / journal_files.ACTIONS).open("a", encoding="utf-8") as file:
                file.write(line)
                file.flush()
                os.fsync(file.fileno())
        except OSError as error:
            self.warning = f"actions cannot be logged ({self.folder}: {error.strerror}): make room"

    def resumed(self, settings: Settings, prior_map: PriorMap | None) -> "Resumed":
        """The run that ended badly: its checkpoint and what came then.

        settings, prior_map: for a run without a checkpoint. JournalError if nothing can be read.
        """
        if self.past is None:
            raise JournalError("There is no run that could be gone on with")
        return resumed(self.past, self._reopen, settings, prior_map)

    def forget_past(self) -> None:
        """The earlier run is gone on with or given up."""
        if self._held is not None and self.past is not None:
            _mark_closed(self.past)
            self._held.release()
        self.past = self._held = None

    def close(self) -> None:
        """The run ended in order."""
        if self._recorder is not None:
            self._recorder.close()
        if self._thread is not None:
            self._thread.join()
        _mark_closed(self.folder)
        self._hold.release()
        if self._held is not None:
            self._held.release()


def _mark_closed(folder: Path) -> None:
    try:
        journal_files.write_durably(folder / journal_files.CLOSED, b"")
    except OSError:  # it is offered once more: better than lost
        return


def resumed(
    folder: Path, reopen: Callable[[Path], Source], settings: Settings, prior_map: PriorMap | None
) -> Resumed:
    """The run as it was when a journal ended."""
    try:
        saved = journal_files.read_checkpoint(folder)
    except JournalError:
        saved = None
    if saved is not None:
        pipeline = saved.checkpoint.pipeline(saved.settings)
    else:
        pipeline = Pipeline(settings, None, prior_map, live=True)
    scans, marks = pipeline.scans, saved.annotations if saved else Annotations()
    try:
        source = reopen(folder)
    except SlamError as error:
        if saved is None:
            raise JournalError(f"{folder} holds nothing that could be gone on with ({error})") from error
        return Resumed(pipeline, 0, marks)
    try:
        for item in journal_files.behind(source.items(), saved.position if saved else None):
            for measurement in pipeline.admit(item):
                pipeline.step(measurement)
    finally:
        source.close()
    return Resumed(pipeline, pipeline.scans - scans, marks)
