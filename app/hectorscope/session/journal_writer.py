"""Writes a journal beside the run: checkpoints and the log of actions, on a thread of its own."""

import threading
from collections.abc import Callable
from functools import partial
from pathlib import Path

from hectorscope.session.checkpoint_file import Saved, write_checkpoint
from hectorscope.session.journal_files import append_durably
from hectorscope.session.row_files import RowFiles

LOST = "actions cannot be logged ({}): make room"
LATER = "the journal cannot be kept ({}): make room, it is tried again"


class JournalWriter:
    """What is handed over is on the disk a moment later. failed: whether the last checkpoint was not written."""

    def __init__(self, folder: Path) -> None:
        self.failed = False
        self._folder = folder
        self._rows = RowFiles(folder)
        self._lines: list[str] = []
        self._saved: Saved | None = None
        self._then: Callable[[], None] = lambda: None
        self._warnings: dict[str, str] = {}
        self._changed = threading.Condition()
        self._closing = False
        self._thread = threading.Thread(target=self._run, name="journal", daemon=True)
        self._thread.start()

    @property
    def busy(self) -> bool:
        """Whether a checkpoint is still to be written."""
        return self._saved is not None

    @property
    def warning(self) -> str:
        """What could not be written the last time, with the remedy; empty while all is well."""
        return "; ".join(self._warnings.copy().values())

    def write(self, saved: Saved, then: Callable[[], None]) -> None:
        """Replace the checkpoint, only while not busy; `then` is called behind that, on this thread."""
        with self._changed:
            self._saved, self._then = saved, then
            self._changed.notify()

    def log(self, line: str) -> None:
        """Add a line to the log of actions."""
        with self._changed:
            self._lines.append(line)
            self._changed.notify()

    def close(self) -> None:
        """Write what waits; waits for it."""
        with self._changed:
            self._closing = True
            self._changed.notify()
        self._thread.join()

    def _run(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._lines or self._saved or self._closing)
                lines, self._lines = self._lines, []
                saved = self._saved
            if lines:
                self._write(LOST, partial(append_durably, self._folder, lines))
            elif saved is not None:
                self._checkpoint(saved)
            else:
                return

    def _checkpoint(self, saved: Saved) -> None:
        self.failed = not self._write(LATER, partial(write_checkpoint, self._folder, saved, self._rows))
        if not self.failed:
            self._then()
        self._saved = None

    def _write(self, fault: str, act: Callable[[], None]) -> bool:
        """Whether it went well; told if not."""
        try:
            act()
        except Exception as error:  # the thread has to outlive it, and nobody else would tell
            reason = getattr(error, "strerror", None) or f"{type(error).__name__}: {error}"
            self._warnings[fault] = fault.format(f"{self._folder}: {reason}")
            return False
        self._warnings.pop(fault, None)
        return True
