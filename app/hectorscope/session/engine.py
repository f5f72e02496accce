"""The one owner of the running pipeline: drains commands, steps, publishes snapshots."""

import logging
import threading
from collections.abc import Callable
from functools import partial
from pathlib import Path
from queue import Empty, SimpleQueue

from hectorscope.inputs import Repairable, Source
from hectorscope.run.checkpoints import BUDGET_MB, MEBIBYTE
from hectorscope.run.pipeline import nothing_used
from hectorscope.run.report import Report
from hectorscope.run.settings import Settings
from hectorscope.session.commands import Answer, Command, Quit, Repair
from hectorscope.session.control import Control
from hectorscope.session.downloads import Downloads
from hectorscope.session.examiner import Examiner
from hectorscope.session.mailbox import Mailbox
from hectorscope.session.publisher import SNAPSHOT_S, Publisher, Run, change_of_tracking
from hectorscope.session.saver import Saver
from hectorscope.session.session import Session
from hectorscope.session.snapshot import Snapshot
from hectorscope.session.transport import PAUSED, Transport
from slam_core.errors import SlamError
from slam_core.localization.prior_map import PriorMap
from slam_core.measurements import LaserScan, Measurement

ALIGNING_NS = 2_000_000_000  # of a recording: the initial alignment takes a quarter of it
FETCH_S = 0.02  # how long a command may wait while a source has nothing to give

_logger = logging.getLogger("hectorscope")


class Engine:
    """Runs one source through a pipeline, on a thread of its own; closes the source at the end.

    prior_map: the map that every run begins with. out: the folder for Save. checkpoints: MiB for them.
    prepare: called on the engine's thread
    before anything is read, with what shows on the page what the run waits for, then or later, from any thread.
    A setting moved by hand acts from its time on, also when the run begins again. That is the next scan, or, while
    the run rests, the scan that is shown, which is processed again.
    What would take the map of a stream away is not done before a person agrees, and what was taken away can be
    brought back for a minute.
    The engine survives a failing source or core: it reports the state "failed" with the reason, and Play, Restart
    or Seek begin again.
    """

    def __init__(
        self,
        source: Source,
        settings: Settings | None = None,
        prior_map: PriorMap | None = None,
        *,
        autoplay: bool = True,
        speed: float = 1.0,
        out: Path | None = None,
        checkpoints: int = BUDGET_MB,
        prepare: Callable[[Report], None] = lambda _: None,
    ) -> None:
        self._source = source
        self._prepare = prepare
        self._commands: SimpleQueue[Command] = SimpleQueue()
        self._sending = threading.Lock()
        self._sent = self._obeyed = 0
        self._thread = threading.Thread(target=self._run, name="engine", daemon=True)
        self._publisher = Publisher(source)
        self._transport = Transport(source.live, autoplay, speed)
        start, budget = settings or Settings(), checkpoints * MEBIBYTE
        self._session = Session(source, start, prior_map, self._transport, self._publisher, budget)
        self._saver = Saver(out, self._commands.put)
        self._examiner = Examiner(source, self._commands.put)
        self._downloads = Downloads(source, prior_map, self._commands.put)
        beside = self._saver, self._examiner, self._downloads
        self._control = Control(self._session, *beside, live=source.live)
        self._is_ready = False

    @property
    def mailbox(self) -> Mailbox[Snapshot]:
        """The newest snapshot."""
        return self._publisher.mailbox

    def start(self) -> None:
        """Begin to read and to step."""
        self._thread.start()

    @property
    def sent(self) -> int:
        """How many commands were sent so far: all are obeyed once `Snapshot.obeyed` is as many."""
        return self._sent

    @property
    def started(self) -> bool:
        """Whether it ever began."""
        return self._thread.ident is not None

    def send(self, command: Command) -> None:
        """Enqueue a command; returns at once, from any thread."""
        with self._sending:
            self._commands.put(command)
            self._sent += 1

    def stop(self) -> None:
        """End the threads, close the source, and wait for it."""
        self.send(Quit())
        if self.started:
            self._thread.join(timeout=10.0)

    def save(self) -> str:
        """Save the results so far; the sentence for the log. SlamError if that fails. Only once it has stopped."""
        return self._saver.finish(self._session.run, self._source.report)

    # ------------------------------------------------------------------------------------ the engine's thread

    def _run(self) -> None:
        self._guard(partial(self._publish, resting=True))
        self._guard(self._get_ready)
        while not isinstance(command := self._next_command(), Quit):
            if command is None:
                self._guard(self._advance)
            elif isinstance(command, Answer):
                self._session.log(command.text, "warning" if command.failed else "info", answer=True)
            else:
                self._guard(partial(self._control.obey, command))
                self._obeyed += 1
                self._publisher.touch()
                if self._commands.empty():
                    self._guard(self._session.process_again)
        self._source.close()
        self._session.intake.close()

    def _get_ready(self) -> None:
        try:
            self._prepare(self._report_preparing)
        finally:
            self._is_ready = True
            self._report_preparing("")

    def _report_preparing(self, text: str, share: float | None = None) -> None:
        """What the run waits for: this thread does while the kernels are prepared, or when it calls one."""
        self._transport.preparing, self._transport.prepared = text, share
        self._publisher.touch()
        if not self._is_ready or threading.current_thread() is self._thread:
            self._publish(resting=True)

    def _guard(self, action: Callable[[], None]) -> None:
        try:
            action()
        except SlamError as error:
            self._fail(str(error))
        except Exception as error:  # a bug or a broken input must not take the page away
            _logger.exception("the run stopped at an unexpected error")
            self._fail(f"{type(error).__name__}: {error}; restart, or look at the terminal for the details")

    def _next_command(self) -> Command | None:
        """The next command, or None when it is time to advance."""
        while True:
            if self._control.lapse():
                self._publisher.touch()
            waiting = self._session.run.waiting
            patience = self._transport.patience(waiting.stamp_ns if waiting and self._is_paced(waiting) else None)
            self._guard(partial(self._publish, resting=patience is None or patience > SNAPSHOT_S))
            if patience == 0.0 and self._commands.empty():
                return None
            lapse = self._control.patience
            sooner = patience if lapse is None or (patience is not None and patience <= lapse) else lapse
            try:
                return self._commands.get(timeout=sooner)
            except Empty:
                if sooner == patience:
                    return None

    def _is_paced(self, waiting: Measurement) -> bool:
        """Whether it is a scan that waits for its time; there is nothing to see before the filter is aligned."""
        if not isinstance(waiting, LaserScan):
            return False
        pipeline = self._session.run.pipeline
        aligning = not pipeline.scans and waiting.stamp_ns - (pipeline.start_ns or 0) < ALIGNING_NS
        return not (aligning and self._transport.running)

    def _advance(self) -> None:
        """One item read, or one measurement stepped."""
        waiting = self._session.run.waiting
        if waiting is None:
            self._fetch()
        elif isinstance(waiting, LaserScan):
            self._scan(waiting.stamp_ns)
        else:
            self._session.run.step()

    def _fetch(self) -> None:
        self._session.keep()
        run, intake = self._session.run, self._session.intake
        item = intake.get(FETCH_S)
        if item is not None:
            run.admit(item)
        elif intake.done:
            run.flush()
            if run.waiting is None:
                self._end()

    def _scan(self, stamp_ns: int) -> None:
        self._publisher.touch()
        if self._transport.arrives(stamp_ns):
            return
        if self._transport.unwanted:
            self._session.run.skip(PAUSED)
        else:
            self._step(stamp_ns)
        self._transport.passed(stamp_ns)

    def _step(self, stamp_ns: int) -> None:
        run, before = self._session.run, self._session.run.pipeline.result
        result = run.step_scan(rests=self._transport.may_rest_after(stamp_ns))
        if result is None and run.pipeline.searching and not run.sought:
            run.sought = True
            self._session.log(f"The robot is not found in the map yet: {run.pipeline.searching}", "warning")
        if change := change_of_tracking(before, result):
            self._session.log(*change)

    def _end(self) -> None:
        session = self._session
        session.intake.check()
        if not (pipeline := session.run.pipeline).scans:
            raise nothing_used(self._source.name, session.report.skipped, pipeline.slam)
        self._transport.end()
        self._publisher.touch()
        self._publisher.log_once(session.entry(f"The recording ended after {pipeline.scans} scans"))

    def _fail(self, reason: str) -> None:
        self._transport.fail(reason)
        self._session.log(reason, "error")
        if isinstance(self._source, Repairable) and self._source.repairs and self._source.report.findings:
            self.send(Repair())

    def _publish(self, resting: bool) -> None:
        if not self._publisher.due(resting):
            return
        session = self._session
        run = Run(
            pipeline=session.run.pipeline,
            transport=self._transport,
            config=session.run.settings.at(session.now_ns),
            report=session.report,
            epoch=session.epoch,
            saves=self._saver.out is not None,
            obeyed=self._obeyed,
            question=self._control.questions.open,
            undo=session.undone.offer,
            behind=session.intake.behind,
            examined=self._examiner.found,
            downloads=self._downloads.ready,
            views=self._control.probes.views(session.run),
        )
        self._publisher.publish(run, complete=resting)
