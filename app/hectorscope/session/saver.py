"""Writes the results of runs on a thread of its own, each run to a place of its own."""

from collections.abc import Callable
from pathlib import Path

from hectorscope.exporters import clear, prepare, saving
from hectorscope.inputs import SourceReport
from hectorscope.session.active_run import ActiveRun
from hectorscope.session.background_task import BackgroundTask
from hectorscope.session.commands import Answer


class Saver:
    """The first run that is saved goes to `out`, those that began later to folders in it: none replaces another.

    What an earlier program left in such a folder is set aside first.

    answer: hears from any thread how a saving ended.
    """

    def __init__(self, out: Path | None, answer: Callable[[Answer], None]) -> None:
        self.out = out
        self._task = BackgroundTask(
            "save", answer, busy="The results are being saved already", failed="Saving failed", daemon=False
        )
        self._runs = 0

    def start(self, run: ActiveRun, report: SourceReport) -> None:
        """Collect the results and write them beside the run; SlamError if that cannot be."""
        self._task.check_idle()
        self._task.start(self._saving(run, report))

    def finish(self, run: ActiveRun, report: SourceReport) -> str:
        """Save now, after what is being written; the sentence for the log. SlamError if that fails."""
        self._task.wait()
        if not run.pipeline.scans:
            return "Nothing was saved, as no scan was used"
        return self._saving(run, report)()

    def _saving(self, run: ActiveRun, report: SourceReport) -> Callable[[], str]:
        if run.folder is None and self.out is not None:
            folder = self.out / f"run-{self._runs + 1}" if self._runs else self.out
            write = saving(run.pipeline, report, folder, run.annotations.marks)
            if folder != self.out:
                prepare(folder)
            moved = clear(folder)
            self._runs, run.folder = self._runs + 1, folder
            return (lambda: f"{write()}. {moved}") if moved else write
        return saving(run.pipeline, report, run.folder, run.annotations.marks)
