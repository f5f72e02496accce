"""The run that is shown and those put aside: begun again, sought in, taken back."""

from contextlib import ExitStack
from pathlib import Path

from hectorscope.inputs import Repairable, Source, SourceReport, merged
from hectorscope.run.checkpoints import Checkpoint, Checkpoints
from hectorscope.run.fingerprint import map_sha256
from hectorscope.run.headless import Observer
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from hectorscope.session.active_run import ActiveRun
from hectorscope.session.ahead import RunsAhead
from hectorscope.session.event_log import EventLog
from hectorscope.session.intake import Intake
from hectorscope.session.look_back import LookBack
from hectorscope.session.no_recording import NoRecording
from hectorscope.session.publisher import LogLevel, Publisher, change_of_tracking
from hectorscope.session.runs import first_difference
from hectorscope.session.session_runs import SessionRuns
from hectorscope.session.session_settings import SessionSettings
from hectorscope.session.snapshot import LogEntry
from hectorscope.session.transport import Transport
from hectorscope.session.undo import Kept, KeptRun, UndoStack
from slam_core.localization.prior_map import PriorMap
from slam_core.results import StepResult

COMPARED_SHARE = 4  # of the budget of the checkpoints one such part more goes to a compared run
NOW_NS = 500_000_000  # of a stream: so near to its end somebody wants to see it as it is
PROGRESS_S = 0.2  # how often it is told how far the run ahead is


class Session:
    """Belongs to the engine's thread. epoch: grows whenever what was drawn is no longer true.

    observe: called with every result of the run as it is now.
    given: the settings that the recording was opened with; others were set by hand since.
    named: the runs of the list, of which this is one. settings: changes those of the shown run.
    """

    def __init__(
        self,
        intake: Intake,
        settings: Settings,
        prior_map: PriorMap | None,
        transport: Transport,
        publisher: Publisher,
        budget: int,
        *,
        ahead_after: float | None = 0.0,
        look_back: float = 0.0,
    ) -> None:
        """budget: bytes of checkpoints. ahead_after: seconds from the first item of a recording until it is run
        ahead of what is shown; None: never.

        look_back: seconds of a stream that are kept.
        """
        self.transport = transport
        self.observe: Observer = lambda _pipeline, _result: None
        self._look_back, self._ahead_after = look_back, ahead_after
        self._read(intake)
        self.undone = UndoStack(self._drop)
        self.epoch = 0
        self.prior_map, self.publisher = prior_map, publisher
        self.map_sha256 = map_sha256(prior_map)
        self._budget = budget
        self.given = settings
        self.named = SessionRuns(self, budget // COMPARED_SHARE)
        self.settings = SessionSettings(self)
        self.run = self._new_run(intake.source, settings, None, self.named.runs.new())

    def _new_run(self, source: Source, settings: Settings, now_ns: int | None, slot: int) -> ActiveRun:
        start_ns = source.span_ns[0] if source.span_ns else now_ns
        kept = Checkpoints(self._budget)
        return ActiveRun(settings, start_ns, self.prior_map, live=source.live, checkpoints=kept, slot=slot)

    @property
    def source(self) -> Source:
        """What the shown run reads."""
        return self.shown_intake.source

    @property
    def shown_intake(self) -> Intake:
        """Where the items of the shown run come from."""
        return self.past.front[1] if self.past.front else self.intake

    @property
    def now_ns(self) -> int:
        """The time of a change made now."""
        return self.run.now_ns(running=self.transport.running)

    @property
    def report(self) -> SourceReport:
        """Counters of the source, the queue and the core."""
        return merged(self.source.report, self.past.newest.pipeline.skipped, self.shown_intake.dropped)

    def log(self, text: str, level: LogLevel = "info", *, answer: bool = False) -> None:
        """A line for the page, at the present time of the recording."""
        self.publisher.log(self.entry(text, level, answer=answer))

    def entry(self, text: str, level: LogLevel = "info", *, answer: bool = False) -> LogEntry:
        """The same, to be logged later."""
        pipeline = self.past.newest.pipeline
        return LogEntry(pipeline.time_ns, text, level, pipeline.scans, answer)

    def tell(self, before: StepResult | None, result: StepResult | None) -> None:
        """Of the run as it is now, after a scan: observe the result, and log a pose that was lost or found."""
        if result is not None:
            self.observe(self.past.newest.pipeline, result)
        if change := change_of_tracking(before, result):
            self.log(*change)

    # ---------------------------------------------------------------------------------------------- beginning

    def restart(self) -> None:
        """An empty map or the prior map, at the beginning; a stream that still flows goes on."""
        self.begin(self.run.settings, "restart")
        self.log(f"Started again with {'the saved' if self.prior_map else 'an empty'} map")

    def repair(self) -> None:
        """Begin again with what the sensor check found put right; the source tells what, in its notes."""
        source = self.source
        if not isinstance(source, Repairable) or not source.repair():
            self.log("The sensor check has found nothing that could be repaired", "warning", answer=True)
            return
        self.run.put_aside()
        self.intake.close()
        self.begin(self.run.settings, "repair")

    def begin(self, settings: Settings, what: str = "", slot: int | None = None) -> None:
        """A new run takes the place of the present one, which is kept for a minute if `what` says why.

        slot: its number in the list of runs; None for that of the present one.
        """
        now_ns = self.run.pipeline.time_ns or None
        slot = self.run.slot if slot is None else slot
        run = self._new_run(self.source, settings, now_ns, slot)  # may want more memory than there is
        if not self.source.live:  # marks stay with a recording, whatever run of it is shown
            run.annotations = self.run.annotations
        self._put_aside(what)
        self._begin(run)

    def adopt(self, pipeline: Pipeline, what: str) -> None:
        """A pipeline that comes from elsewhere takes the place of the present run of a stream."""
        run = self._new_run(self.source, pipeline.settings, pipeline.start_ns, self.run.slot)
        run.pipeline = pipeline
        self._put_aside(what)
        self._begin(run)

    def switch(self, settings: Settings, slot: int) -> None:
        """Another run of the list and of the recording takes the place of the present one, which stays there."""
        run = self._new_run(self.source, settings, None, slot)
        run.checkpoints = self.run.checkpoints.until(first_difference(self.run.settings, settings))
        run.annotations = self.run.annotations
        self._put_aside("")
        self.undone.forget_values()
        self._begin(run)
        if self.named.compared_with == slot:
            self.named.end_comparison()

    def _begin(self, run: ActiveRun) -> None:
        self.run = run
        self.intake.begin()
        self.transport.begin()
        self.show_anew()

    def open(
        self,
        source: Source,
        path: Path,
        settings: Settings | None = None,
        slot: int | None = None,
        name: str = "",
    ) -> None:
        """Another recording, with the settings of now from its start, or others; the run is kept for a minute.

        slot: its number in the list of runs; None for one more, of this name.
        """
        given = settings or Settings(self.run.settings.at(self.now_ns))
        with ExitStack() as refused:
            refused.callback(source.close)
            slot = self.named.new_slot(name) if slot is None else slot
            run = self._new_run(source, given, None, slot)
            refused.pop_all()
        self.given = given
        self.named.end_comparison()
        self._put_aside(f"opening {source.name}")
        before, self.run, self.publisher.event_log = self.intake, run, EventLog()
        before.begin()
        self._read(Intake(source, path))
        self._let_go(before)
        self.transport.begin()
        self.show_anew()

    def _read(self, intake: Intake) -> None:
        self.intake = intake
        self.transport.live, self.transport.empty = intake.source.live, isinstance(intake.source, NoRecording)
        self.past = LookBack(self, self._look_back if intake.source.live else 0.0)
        intake.keeps = self.past.items
        self._ahead = RunsAhead(intake, self._ahead_after)

    def _put_aside(self, what: str) -> None:
        """Another run is shown from now on; keep the present one for a minute if `what` says why."""
        self.run.put_aside()
        if what and self.run.pipeline.scans:
            aside, log = self.intake.put_aside(), self.publisher.event_log
            self.undone.push(what, KeptRun(self.run, self.intake, aside, self.transport.stand, log))

    def _let_go(self, intake: Intake) -> None:
        """Close a recording once no run needs it any more."""
        if intake is not self.intake and not self.undone.keeps(intake):
            intake.end()

    def close(self) -> None:
        """Close what is read, and what is kept for an undo."""
        self.past.go_live()
        self.named.end_comparison()
        self.run.put_aside()
        self.undone.clear()
        self.intake.end()

    def undo(self) -> None:
        """Bring back what the last action took away."""
        kept = self.undone.pop()
        if kept is None:
            self.log("There is nothing to undo any more: a minute has passed", "warning", answer=True)
            return
        what, before = kept
        before.restore(self, what)

    def bring_back(self, kept: KeptRun) -> None:
        """Show a run again that was put aside."""
        self.named.note()
        self.run.put_aside()
        self.run, self.publisher.event_log = kept.run, kept.event_log
        left = self.intake
        if left is not kept.intake:
            self._read(kept.intake)
        if left is not kept.intake or self.named.compared_with == self.run.slot:
            self.named.end_comparison()
        self._let_go(left)
        self.named.note()
        self.intake.resume(kept.aside)
        self.transport.resume(kept.stand)
        self.show_anew()

    def _drop(self, kept: Kept) -> None:
        if isinstance(kept, KeptRun):
            kept.intake.forget(kept.aside)
            self._let_go(kept.intake)

    def show_anew(self) -> None:
        """What was drawn is no longer true."""
        self.epoch += 1
        self.publisher.touch()

    def seek(self, time_ns: int) -> None:
        """Go to a time of a recording, from the last checkpoint before it if that is nearer than the run.

        While a seek is about to arrive, the newest wanted time waits for it: each drag of a hand shows something.
        """
        span = self.source.span_ns or self.past.kept_ns
        if span is None:
            self.log("Nothing of the stream is kept yet: nothing was sought", "warning", answer=True)
            return
        self.named.expected = None
        time_ns = min(max(time_ns, span[0]), span[1])
        if self.transport.hurries:
            self.transport.wanted_ns = time_ns
            return
        if self.source.live:
            if time_ns > span[1] - NOW_NS:
                self.past.go_live()
                return
            self.past.leave_now()
        checkpoint = self.run.checkpoints.before(time_ns)
        now_ns = self.run.pipeline.time_ns
        back = bool(self.transport.failure) or time_ns < now_ns
        if back or (checkpoint and checkpoint.time_ns > now_ns):
            rests = self.transport.stopped
            self._go_to(checkpoint)
            if rests:  # a jump from the end is to look there, not to go on to the end again
                self.transport.pause()
        self.transport.seek(time_ns)

    def step_back(self) -> None:
        """Go to the scan before the last one, if there is one."""
        pipeline = self.run.pipeline
        seconds = pipeline.trajectory[-2:, 0]
        if len(seconds) == 2:  # between both, so that rounding does not matter
            self.seek((pipeline.start_ns or 0) + round(1e9 * float(seconds.mean())))

    def _go_to(self, checkpoint: Checkpoint | None) -> None:
        """The same run at a checkpoint, or at its beginning."""
        self.run.go_to(checkpoint)
        if checkpoint is None:
            self.intake.begin()
        else:
            self.intake.go_to(checkpoint.place)
        self.transport.begin()
        self.show_anew()

    def keep(self) -> None:
        """Keep a checkpoint if the run is at a place where it can be gone on from."""
        if self.past.front is None:
            self.past.keep(self.run, self.intake)

    def run_ahead(self, seconds: float) -> float | None:
        """Run on with the compared run, or ahead of what is shown, for about so long.

        In how many seconds there is more to do; None if never.
        """
        if self.named.advance(seconds):
            self.publisher.touch()
            return 0.0
        turn = self._ahead.advance(self.run, seconds)
        if turn == 0.0 and (self.publisher.age >= PROGRESS_S or (self.run.head and self.run.head.done)):
            self.publisher.touch()
        return turn
