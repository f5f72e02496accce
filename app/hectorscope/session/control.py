"""Carries out commands, and holds back those that would take something away from everybody, until one agrees."""

from collections.abc import Callable
from typing import NamedTuple, Protocol

from hectorscope.session.commands import (
    Agree,
    ChangeSpeed,
    Command,
    Configure,
    ConfigureAll,
    Decline,
    Drive,
    Examine,
    Export,
    Follow,
    Inspect,
    ListRecordings,
    Open,
    OpenUploaded,
    Pause,
    Play,
    PlayPause,
    Repair,
    Restart,
    RunCommand,
    Save,
    Seek,
    SetSpeed,
    SetUp,
    StepBack,
    StepScan,
    Undo,
)
from hectorscope.session.downloads import Downloads
from hectorscope.session.examiner import Examiner
from hectorscope.session.following import Following
from hectorscope.session.library import Library
from hectorscope.session.losses import loss
from hectorscope.session.playback import changed_speed
from hectorscope.session.probes import Probes
from hectorscope.session.questions import Questions
from hectorscope.session.run_commands import RunCommands
from hectorscope.session.saver import Saver
from hectorscope.session.session import Session
from hectorscope.session.station_commands import StationCommand
from hectorscope.session.transport import valid_speed
from hectorscope.steering import Drivable, Request
from slam_core.errors import SlamError


class Obeys(Protocol):
    """Carries out the commands of the operator's station."""

    def obey(self, command: StationCommand) -> None:
        """One of them."""


NEEDS_RECORDING = (Restart, Seek, StepScan, StepBack, Repair, Save)
# What is done at the time that is shown; all else is done to the run, which may be further.
SHOWN = (
    Play, Pause, StepScan, StepBack, SetSpeed, ChangeSpeed, Seek, Save, Export, Examine, Inspect, ListRecordings,
    Drive,
)  # fmt: skip


class BackgroundWork(NamedTuple):
    """What works on threads of its own, beside the run."""

    saver: Saver
    examiner: Examiner
    downloads: Downloads


class Control:
    """Belongs to the engine's thread. opening: hears what is opened at this moment, and "" once it is."""

    def __init__(
        self, session: Session, library: Library, background: BackgroundWork, opening: Callable[[str], None]
    ) -> None:
        self.questions = Questions()
        self.probes = Probes()
        self.background = background
        self.station: Obeys | None = None
        self._session, self._library, self.opening = session, library, opening
        self._following = Following(session, library, opening)
        self._runs = RunCommands(session, library, self._following)
        self._transport = session.transport

    @property
    def _live(self) -> bool:
        """Whether the source is a stream, which brings nothing back."""
        return self._transport.live

    def lapse(self) -> bool:
        """Withdraw questions and give up what was kept, once their time is over; whether something was."""
        return any((self.questions.lapse(), self._session.undone.lapse()))

    @property
    def patience(self) -> float | None:
        """Seconds until `lapse` has something to do; None for ever."""
        return min(
            (left for left in (self.questions.left, self._session.undone.left) if left is not None), default=None
        )

    def obey(self, command: Command) -> None:
        """Carry a command out, refuse it in the log, or ask first."""
        if isinstance(command, PlayPause):
            command = Pause() if self._transport.running else Play()
        session = self._session
        if not isinstance(command, SHOWN):
            session.past.go_live()  # which is all that `GoLive` asks for
        would_lose = self._following.loss(command.link) if isinstance(command, Follow) else None
        if self._live and not would_lose:
            would_lose = loss(
                command, session.run.pipeline, session.settings.planned, stopped=self._transport.stopped
            )
        if self._transport.empty and isinstance(command, NEEDS_RECORDING):
            self._refuse("No recording is open: open one first")
        elif would_lose:
            self.questions.ask(command, would_lose.text, would_lose.agree, would_lose.decline)
        else:
            self._do(command)

    def _do(self, command: Command) -> None:
        match command:
            case Play():
                if self._transport.stopped:
                    self._session.restart()
                self._transport.play()
            case Pause():
                self._pause()
            case StepScan() | StepBack() | SetSpeed() | ChangeSpeed():
                self._pace(command)
            case Configure() | ConfigureAll():
                self._configure(command)
            case Save() | Examine() | Export():
                self._begin_work(command)
            case Restart() | Repair() | Seek():
                self._begin_again(command)
            case Drive(request):
                self._drive(request)
            case Undo() | Agree() | Decline() | Inspect():
                self._answer(command)
            case StationCommand():
                if self.station is not None:
                    self.station.obey(command)
            case ListRecordings() | Open() | OpenUploaded() | Follow() | SetUp() | RunCommand():
                self._show_other(command)

    def _drive(self, request: Request) -> None:
        source = self._session.source
        if isinstance(source, Drivable) and (why := source.drive(request)):
            self._refuse(why)

    def _pace(self, command: StepScan | StepBack | SetSpeed | ChangeSpeed) -> None:
        match command:
            case _ if self._live:
                self._refuse("A live stream has its own pace: there are no steps and no other speed")
            case StepScan():
                self._transport.step()
            case StepBack():
                self._transport.pause()
                self._session.step_back()
            case SetSpeed(speed):
                self._set_speed(speed)
            case ChangeSpeed(notches):
                self._set_speed(changed_speed(self._transport.speed, notches))

    def _begin_again(self, command: Restart | Repair | Seek) -> None:
        match command:
            case Restart():
                self._session.restart()
            case Repair():
                self._session.repair()
            case Seek(time_ns):
                self._session.seek(time_ns)

    def _show_other(self, command: ListRecordings | Open | OpenUploaded | Follow | SetUp | RunCommand) -> None:
        source = self._session.source
        try:
            match command:
                case ListRecordings():
                    self._library.refresh()
                case Open(key):
                    self._open(key)
                case OpenUploaded(path, name):
                    self._open(self._library.add(path, name))
                case Follow(link):
                    self._following.follow(link)
                case SetUp():
                    self._following.set_up(command)
                case _:
                    self._runs.obey(command)
        except SlamError as error:
            self._refuse(str(error))
        finally:
            self.opening("")
        if self._session.source is not source:
            self.questions.withdraw()  # it was asked about the run of that

    def _open(self, key: str) -> None:
        if run := self._library.kept_run(key):
            self._following.follow_kept(run)
            return
        self.opening(f"Opening {self._library.name(key)}")
        self._session.open(*self._library.open(key))

    def _answer(self, command: Undo | Agree | Decline | Inspect) -> None:
        match command:
            case Inspect():
                self.probes.obey(command, self._session.run)
            case Undo():
                self.questions.withdraw()  # it was asked about another run
                self._session.undo()
            case Agree(number):
                self._do_if(self.questions.agreed(number))
            case Decline(number):
                self._do_if(self.questions.declined(number))

    def _do_if(self, command: Command | None) -> None:
        if command is not None:
            self._do(command)

    def _pause(self) -> None:
        """Rest, in a recording after one more scan: what it was before that scan is kept for changed settings."""
        on = self._transport.running and not self._transport.live
        self._transport.pause()
        if on:
            self._transport.step()

    def _set_speed(self, speed: float) -> None:
        if valid_speed(speed):
            self._transport.speed = speed
        else:
            self._refuse(f"The speed {speed} was refused: give 0.1 to inf")

    def _configure(self, command: Configure | ConfigureAll) -> None:
        try:
            change = self._session.settings.planned(command)
        except SlamError as error:
            self._refuse(str(error))
            return
        if change is not None:
            self._session.settings.change(change)

    def _begin_work(self, command: Save | Examine | Export) -> None:
        """Work that goes on beside the run."""
        try:
            session = self._session
            match command:
                case Save():
                    self.background.saver.start(session.past.newest, session.report)
                case Examine():
                    self.background.examiner.start(session.source)
                case Export():
                    self.background.downloads.start(command, session.source, session.run, session.report)
        except SlamError as error:
            self._refuse(str(error))

    def _refuse(self, reason: str) -> None:
        self._session.log(reason, "warning", answer=True)
