"""The one owner of the running pipeline: drains commands, steps, publishes snapshots."""

import logging
import threading
from collections.abc import Callable
from functools import partial
from pathlib import Path
from queue import Empty

from hectorscope.inputs import Repairable, Source
from hectorscope.run.checkpoints import BUDGET_MB, MEBIBYTE
from hectorscope.run.headless import Observer
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.report import Report
from hectorscope.run.settings import Settings
from hectorscope.session.commands import Answer, Command, Identified, Quit, Repair
from hectorscope.session.composed import composed
from hectorscope.session.control import BackgroundWork, Control
from hectorscope.session.downloads import Downloads
from hectorscope.session.examiner import Examiner
from hectorscope.session.exchange import Exchange
from hectorscope.session.intake import Intake
from hectorscope.session.library import Library
from hectorscope.session.mailbox import Mailbox
from hectorscope.session.no_recording import NoRecording
from hectorscope.session.publisher import SNAPSHOT_S, Publisher
from hectorscope.session.saver import Saver
from hectorscope.session.session import Session
from hectorscope.session.snapshot import Snapshot
from hectorscope.session.spare_time import use_time
from hectorscope.session.station import Station
from hectorscope.session.stepping import Stepping
from hectorscope.session.transport import Transport
from slam_core.errors import SlamError
from slam_core.localization.prior_map import PriorMap
from slam_core.measurements import LaserScan, Measurement
from slam_core.results import StepResult

ALIGNING_NS = 2_000_000_000  # of a recording: the initial alignment takes a quarter of it
LOOK_BACK_S = 300.0

_logger = logging.getLogger("hectorscope")


class Engine:
    """Runs a source through a pipeline, on a thread of its own, until another one is opened; closes it at the end.

    source: None shows nothing yet. exchange: with the page, if that is there already.
    prior_map: the map that every run begins with. out: the folder for Save. checkpoints: MiB for them.
    ahead_after: seconds from the first item of a recording until it is run to its end, in the time to spare,
    ahead of what is shown; None: never.
    look_back: seconds of a stream that are kept, to be shown again while the run goes on.
    A setting moved by hand acts from its time on, also when the run begins again. That is the next scan, or, while
    the run rests, the scan that is shown, which is processed again.
    What would take the map of a stream away is not done before a person agrees, and what was taken away can be
    brought back for a minute.
    The engine survives a failing source or core: it reports the state "failed" with the reason, and Play, Restart
    or Seek begin again.
    """

    def __init__(
        self,
        source: Source | None = None,
        settings: Settings | None = None,
        prior_map: PriorMap | None = None,
        *,
        exchange: Exchange | None = None,
        autoplay: bool = True,
        speed: float = 1.0,
        out: Path | None = None,
        checkpoints: int = BUDGET_MB,
        ahead_after: float | None = 0.0,
        look_back: float = LOOK_BACK_S,
    ) -> None:
        source = source or NoRecording()
        self._prepare: Callable[[Report], None] = lambda _: None
        self._exchange = exchange or Exchange()
        self._commands = self._exchange.commands
        self._obeyed = 0
        self._thread = threading.Thread(target=self._run, name="engine", daemon=True)
        self._publisher = Publisher(self._exchange.mailbox)
        self._transport = Transport(source.live, autoplay, speed)
        start, budget = settings or Settings(), checkpoints * MEBIBYTE
        self._session = Session(
            Intake(source),
            start,
            prior_map,
            self._transport,
            self._publisher,
            budget,
            ahead_after=ahead_after,
            look_back=look_back,
        )
        tell = self._commands.put
        self._background = BackgroundWork(Saver(out, tell), Examiner(tell), Downloads(prior_map, tell))
        self.offer(Library())
        self._is_ready = False
        self._stepping = Stepping(self._session, lambda: not self._commands.empty(), self._show)
        self.attach(Station())

    @property
    def mailbox(self) -> Mailbox[Snapshot]:
        """The newest snapshot."""
        return self._exchange.mailbox

    def offer(self, library: Library) -> None:
        """Let pages open what is in it; before the start. Its `shown` is where the source lies."""
        self._library, self._session.intake.path = library, library.shown
        library.identities.told = partial(self._commands.put, Identified())
        self._control = Control(self._session, library, self._background, self._show_opening)

    def observe(self, observer: Observer) -> None:
        """Call it with every result of the run of this source, on the engine's thread; before the start."""
        session, observed = self._session, self._session.source

        def observe(pipeline: Pipeline, result: StepResult) -> None:
            if session.source is observed:
                observer(pipeline, result)

        session.observe = observe

    def attach(self, station: Station) -> None:
        """Keep on the disk what it says; before the start."""
        self._station = station
        station.attach(self._session)

    def start(self, prepare: Callable[[Report], None] | None = None) -> None:
        """Begin to read and to step.

        prepare: called on the engine's thread before anything is read, with what shows on the page what the run
        waits for, then or later, from any thread.
        """
        self._prepare = prepare or self._prepare
        self._thread.start()

    @property
    def sent(self) -> int:
        """How many commands were sent so far: all are obeyed once `Snapshot.obeyed` is as many."""
        return self._exchange.sent

    @property
    def started(self) -> bool:
        """Whether it ever began."""
        return self._thread.ident is not None

    def send(self, command: Command) -> None:
        """Enqueue a command; returns at once, from any thread."""
        self._exchange.send(command)

    def stop(self) -> None:
        """End the threads, close the source, and wait for it."""
        self.send(Quit())
        if self.started:
            self._thread.join(timeout=10.0)

    @property
    def saves(self) -> bool:
        """Whether there is something to save, and a folder for it."""
        return self.started and self._background.saver.out is not None and not self._transport.empty

    def save(self) -> str:
        """Save the results so far; the sentence for the log. SlamError if that fails. Only once it has stopped."""
        return self._background.saver.finish(self._session.past.newest, self._session.source.report)

    # ------------------------------------------------------------------------------------ the engine's thread

    def _run(self) -> None:
        self._guard(partial(self._publish, resting=True))
        self._guard(self._get_ready)
        self._guard(partial(self._station.begin, self._control))
        while not isinstance(command := self._next_command(), Quit):
            if command is None:
                self._guard(self._stepping.advance)
            elif isinstance(command, Answer):
                self._session.log(command.text, "warning" if command.failed else "info", answer=True)
            elif isinstance(command, Identified):
                self._publisher.touch()
            else:
                self._guard(partial(self._station.logged, self._control.obey, command))
                self._obeyed += 1
                self._publisher.touch()
                if self._commands.empty():
                    self._guard(self._session.settings.process_again)
        self._guard(self._session.close)
        self._guard(self._station.close)

    def _show_opening(self, text: str) -> None:
        """What a command opens at this moment, which may take a while; empty once it has."""
        self._transport.opening = text
        self._show()

    def _show(self) -> None:
        """Show at once how things are."""
        self._publisher.touch()
        self._publish(resting=True)

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
            self._guard(self._station.keep)
            waiting = self._session.run.waiting
            patience = self._transport.patience(waiting.stamp_ns if waiting and self._is_paced(waiting) else None)
            self._guard(partial(self._publish, resting=patience is None or patience > SNAPSHOT_S))
            if patience == 0.0 and self._commands.empty():
                return None
            turn = use_time(self._session, patience, self._guard) if self._commands.empty() else None
            left = (patience, self._control.patience, self._station.patience, turn)
            sooner = min((seconds for seconds in left if seconds is not None), default=None)
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

    def _fail(self, reason: str) -> None:
        self._session.log(reason, "error")
        if self._session.past.front:  # if it is the run itself that fails, it will again
            self._session.past.go_live()
            return
        self._transport.fail(reason)
        source = self._session.source
        if isinstance(source, Repairable) and source.repairs and source.report.findings:
            self.send(Repair())

    def _publish(self, resting: bool) -> None:
        if self._transport.hurries or not self._publisher.due(resting=resting, live=self._session.source.live):
            return
        session = self._session
        snapshot = composed(session, self._library, self._control, self._obeyed, self._station.state)
        self._publisher.publish(snapshot, session.run.pipeline, complete=resting)
