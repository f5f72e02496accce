"""The one owner of a running pipeline: drains commands, steps, publishes snapshots."""

import logging
import threading
from collections import deque
from collections.abc import Callable, Mapping
from functools import partial
from operator import methodcaller
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any

from hectorscope.exporters import saving
from hectorscope.inputs import Repairable, Source, SourceReport, merged
from hectorscope.run.pipeline import Pipeline, nothing_used
from hectorscope.run.report import Report
from hectorscope.run.settings import Setting, Settings, value_of
from hectorscope.session.commands import (
    Answer,
    ChangeSpeed,
    Command,
    Configure,
    ConfigureAll,
    Pause,
    Play,
    PlayPause,
    Quit,
    Repair,
    Restart,
    Save,
    Seek,
    SetSpeed,
    StepScan,
)
from hectorscope.session.feeder import Feeder
from hectorscope.session.mailbox import Mailbox
from hectorscope.session.playback import changed_speed
from hectorscope.session.publisher import SNAPSHOT_S, LogLevel, Publisher, Run, change_of_tracking
from hectorscope.session.rework import Rework
from hectorscope.session.snapshot import LogEntry, Snapshot
from hectorscope.session.transport import Transport, valid_speed
from slam_core.config import MapConfig, needs_restart
from slam_core.errors import SlamError
from slam_core.localization.prior_map import PriorMap
from slam_core.mapping.pyramid import check_room
from slam_core.measurements import LaserScan, Measurement

ALIGNING_NS = 2_000_000_000  # of a recording: the initial alignment takes a quarter of it
FETCH_S = 0.02  # how long a command may wait while a source has nothing to give

_logger = logging.getLogger("hectorscope")


class Engine:
    """Runs one source through a pipeline, on a thread of its own; closes the source at the end.

    prior_map: the map that every run begins with. out: the folder for Save. prepare: called on the engine's thread
    before anything is read, with what shows on the page what the run waits for, then or later, from any thread.
    A setting moved by hand acts from its time on, also when the run begins again. That is the next scan, or, while
    the run rests, the scan that is shown, which is processed again.
    The engine survives a failing source or core: it reports the state "failed" with the reason, and Play, Restart
    or Seek begin again.
    """

    _settings: Settings
    _pipeline: Pipeline
    _rework: Rework | None
    _sought: bool

    def __init__(
        self,
        source: Source,
        settings: Settings | None = None,
        prior_map: PriorMap | None = None,
        *,
        autoplay: bool = True,
        speed: float = 1.0,
        out: Path | None = None,
        prepare: Callable[[Report], None] = lambda _: None,
    ) -> None:
        self._source = source
        self._prior_map = prior_map
        self._out = out
        self._prepare = prepare
        self._commands: SimpleQueue[Command] = SimpleQueue()
        self._sending = threading.Lock()
        self._sent = self._obeyed = 0
        self._thread = threading.Thread(target=self._run, name="engine", daemon=True)
        self._publisher = Publisher(source)
        self._saver: threading.Thread | None = None
        self._transport = Transport(source.live, autoplay, speed)
        self._feeder: Feeder | None = None
        self._is_ready = False
        self._epoch = -1
        self._begin(settings or Settings())

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
        if self._saver is not None:
            self._saver.join()
        return saving(self._pipeline, self._source.report, self._out)()

    # ------------------------------------------------------------------------------------ the engine's thread

    def _run(self) -> None:
        self._guard(partial(self._publish, resting=True))
        self._guard(self._get_ready)
        while not isinstance(command := self._next_command(), Quit):
            if command is None:
                self._guard(self._advance)
            elif isinstance(command, Answer):
                self._log(command.text, "warning" if command.failed else "info", answer=True)
            else:
                self._guard(partial(self._obey, command))
                self._obeyed += 1
                self._publisher.touch()
                if self._commands.empty():
                    self._guard(self._process_again)
        self._source.close()
        if self._feeder is not None:
            self._feeder.close()

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
        head = self._ready[0] if self._ready else None
        patience = self._transport.patience(head.stamp_ns if head and self._is_paced(head) else None)
        self._guard(partial(self._publish, resting=patience is None or patience > SNAPSHOT_S))
        if patience == 0.0 and self._commands.empty():
            return None
        try:
            return self._commands.get(timeout=patience)
        except Empty:
            return None

    def _is_paced(self, head: Measurement) -> bool:
        """Whether it is a scan that waits for its time; there is nothing to see before the filter is aligned."""
        if not isinstance(head, LaserScan):
            return False
        aligning = not self._pipeline.scans and head.stamp_ns - (self._pipeline.start_ns or 0) < ALIGNING_NS
        return not (aligning and self._transport.running)

    def _advance(self) -> None:
        """One item read, or one measurement stepped."""
        if not self._ready:
            self._fetch()
        elif isinstance(self._ready[0], LaserScan):
            self._scan(self._ready[0])
        else:
            self._give(methodcaller("step", self._ready.popleft()))

    def _give(self, act: Callable[[Pipeline], Any]) -> Any:
        """Give the pipeline something, and keep it for when the last scan is processed again."""
        if self._rework is not None:
            self._rework.note(act)
        return act(self._pipeline)

    def _fetch(self) -> None:
        if self._feeder is None:
            self._feeder = Feeder(self._source)
        item = self._feeder.get(FETCH_S)
        if item is not None:
            self._ready.extend(self._give(methodcaller("admit", item)))
        elif self._feeder.done:
            self._ready.extend(self._give(methodcaller("flush")))
            if not self._ready:
                self._end(self._feeder)

    def _scan(self, scan: LaserScan) -> None:
        self._publisher.touch()
        if self._transport.arrives(scan.stamp_ns):
            return
        self._ready.popleft()
        if self._transport.unwanted:
            self._pipeline.skip("scan while the stream was paused")
        else:
            self._step(scan)
        self._transport.passed(scan.stamp_ns)

    def _step(self, scan: LaserScan) -> None:
        before = self._pipeline.result
        rests = self._transport.may_rest_after(scan.stamp_ns)
        self._rework = Rework(self._pipeline, scan.stamp_ns) if rests else None
        result = self._give(methodcaller("step", scan))
        if result is None and self._pipeline.searching and not self._sought:
            self._sought = True
            self._log(f"The robot is not found in the map yet: {self._pipeline.searching}", "warning")
        if change := change_of_tracking(before, result):
            self._log(*change)

    def _end(self, feeder: Feeder) -> None:
        feeder.check()
        if not self._pipeline.scans:
            raise nothing_used(self._source.name, self._report.skipped, self._pipeline.slam)
        self._transport.end()
        self._publisher.touch()
        self._publisher.log_once(self._entry(f"The recording ended after {self._pipeline.scans} scans"))

    def _fail(self, reason: str) -> None:
        self._transport.fail(reason)
        self._log(reason, "error")
        if isinstance(self._source, Repairable) and self._source.repairs and self._source.report.findings:
            self.send(Repair())

    # --------------------------------------------------------------------------------------------- commands

    def _obey(self, command: Command) -> None:
        match command:
            case Play():
                if self._transport.stopped:
                    self._restart()
                self._transport.play()
            case Pause():
                self._pause()
            case PlayPause():
                self._obey(Pause() if self._transport.running else Play())
            case StepScan():
                self._transport.step()
            case SetSpeed(speed):
                self._set_speed(speed)
            case ChangeSpeed(notches):
                self._set_speed(changed_speed(self._transport.speed, notches))
            case Restart():
                self._restart()
            case Seek(time_ns):
                self._seek(time_ns)
            case Configure(name, value, throughout):
                self._configure({name: value}, "", throughout)
            case ConfigureAll(title, values, throughout):
                self._configure(values, title, throughout)
            case Save() | Repair():
                (self._save if isinstance(command, Save) else self._repair)()

    def _pause(self) -> None:
        """Rest, in a recording after one more scan: what it was before that scan is kept for changed settings."""
        on = self._transport.running and not self._source.live
        self._transport.pause()
        if on:
            self._transport.step()

    def _set_speed(self, speed: float) -> None:
        if valid_speed(speed):
            self._transport.speed = speed
        else:
            self._log(f"The speed {speed} was refused: give 0.1 to inf", "warning", answer=True)

    def _save(self) -> None:
        """Collect the results, and write them beside the run."""
        if self._saver is not None and self._saver.is_alive():
            self._log("The results are being saved already: wait for the end", "warning", answer=True)
            return
        try:
            write = saving(self._pipeline, self._source.report, self._out)
        except SlamError as error:
            self._log(str(error), "warning", answer=True)
            return
        self._saver = threading.Thread(target=self._write, args=(write,), name="save")
        self._saver.start()

    def _write(self, write: Callable[[], str]) -> None:
        """On a thread of its own; the engine tells how it ended."""
        try:
            self._commands.put(Answer(write()))
        except SlamError as error:
            self._commands.put(Answer(str(error), failed=True))

    def _restart(self) -> None:
        self._begin(self._settings)
        self._log(f"Started again with {'the saved' if self._prior_map else 'an empty'} map")

    def _repair(self) -> None:
        """Begin again with what the sensor check found put right; the source tells what, in its notes."""
        source = self._source
        if not isinstance(source, Repairable) or not source.repair():
            self._log("The sensor check has found nothing that could be repaired", "warning", answer=True)
            return
        if self._feeder is not None:
            self._feeder.close()
            self._feeder = None
        self._begin(self._settings)

    def _seek(self, time_ns: int) -> None:
        span = self._source.span_ns
        if span is None:
            self._log("A live stream has no other times: nothing was sought", "warning", answer=True)
            return
        time_ns = min(max(time_ns, span[0]), span[1])
        if self._transport.failure or time_ns < self._pipeline.time_ns:
            rests = self._transport.stopped
            self._begin(self._settings)
            if rests:  # a jump from the end is to look there, not to go on to the end again
                self._transport.pause()
        self._transport.seek(time_ns)

    def _configure(self, values: Mapping[str, Setting], title: str, throughout: bool) -> None:
        """Change settings; one line of the log has the change of the one, or how many changed."""
        before, now_ns = self._settings, self._now_ns
        throughout = throughout and not self._source.live
        try:
            after = before.changed_all(None if throughout else now_ns, values)
            if any(name.startswith("map.") for name in values):
                self._check_map(after.at(now_ns).map)
        except SlamError as error:
            self._log(str(error), "warning", answer=True)
            return
        old, new = before.at(now_ns), after.at(now_ns)
        lines = [
            f"{name}: {value_of(old, name)} → {value_of(new, name)}"
            for name in values
            if value_of(old, name) != value_of(new, name)
        ]
        if after == before or not (lines or throughout):
            return
        text = f"{title}: {len(lines)} settings changed" if title or not lines else lines[0]
        entry = self._entry(f"{text}, for the whole run" if throughout else text)
        if throughout or needs_restart(before.start, after.start):
            self._rebuild(after)
        else:
            self._settings = self._pipeline.settings = after
            self._outdated = now_ns <= self._pipeline.time_ns
        self._publisher.log(entry)

    def _process_again(self) -> None:
        """Process the scan at which the run rested, with the settings that changed meanwhile."""
        outdated, self._outdated = self._outdated, False
        if outdated and self._rework is not None:
            self._pipeline = self._rework.again(self._settings)
            self._transport.processed_again = True
            self._epoch += 1

    def _check_map(self, config: MapConfig) -> None:
        """Refuse what the next run could not begin with."""
        check_room(config)
        if self._prior_map:
            self._prior_map.check(config)

    def _rebuild(self, settings: Settings) -> None:
        """The same instant with another map; a stream cannot go back, so its map begins anew."""
        target_ns = self._transport.target_ns or self._pipeline.time_ns
        self._begin(settings)
        if self._source.live:
            self._log("A new map was begun: a live stream cannot be run again", "warning")
        else:
            self._transport.seek(target_ns)

    def _begin(self, settings: Settings) -> None:
        """An empty map or the prior map at the beginning; a stream that still flows goes on."""
        if self._feeder is not None and (not self._source.live or self._feeder.done):
            self._feeder.close()
            self._feeder = None
        span = self._source.span_ns
        now_ns = (self._pipeline.time_ns or None) if self._epoch >= 0 else None
        # may want more memory than there is
        self._pipeline = Pipeline(settings, span[0] if span else now_ns, self._prior_map)
        self._settings = settings
        self._ready: deque[Measurement] = deque()
        self._rework = None
        self._outdated = False
        self._sought = False
        self._epoch += 1
        self._transport.begin()
        self._publisher.touch()

    # ------------------------------------------------------------------------------------------- reporting

    @property
    def _now_ns(self) -> int:
        """The time of a change made now: of the scan that can be processed again, or right after the last one."""
        if self._rework is not None and not self._transport.running:
            return self._rework.scan_ns
        return self._pipeline.time_ns + (self._pipeline.last_scan_ns is not None)

    @property
    def _report(self) -> SourceReport:
        dropped = self._feeder.dropped if self._feeder else 0
        return merged(self._source.report, self._pipeline.skipped, dropped)

    def _log(self, text: str, level: LogLevel = "info", *, answer: bool = False) -> None:
        self._publisher.log(self._entry(text, level, answer=answer))

    def _entry(self, text: str, level: LogLevel = "info", *, answer: bool = False) -> LogEntry:
        """At the present time of the recording."""
        return LogEntry(self._pipeline.time_ns, text, level, self._pipeline.scans, answer)

    def _publish(self, resting: bool) -> None:
        if self._publisher.due(resting):
            config, saves = self._settings.at(self._now_ns), self._out is not None
            run = Run(self._pipeline, self._transport, config, self._report, self._epoch, saves, self._obeyed)
            self._publisher.publish(run, complete=resting)
