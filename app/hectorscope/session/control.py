"""Carries out commands, and holds back those that would take something away from everybody, until one agrees."""

from hectorscope.session.commands import (
    Agree,
    ChangeSpeed,
    Command,
    Configure,
    ConfigureAll,
    Decline,
    Examine,
    Export,
    Inspect,
    Pause,
    Play,
    PlayPause,
    Repair,
    Restart,
    Save,
    Seek,
    SetSpeed,
    StepBack,
    StepScan,
    Undo,
)
from hectorscope.session.downloads import Downloads
from hectorscope.session.examiner import Examiner
from hectorscope.session.losses import loss
from hectorscope.session.playback import changed_speed
from hectorscope.session.probes import Probes
from hectorscope.session.questions import Questions
from hectorscope.session.saver import Saver
from hectorscope.session.session import Session
from hectorscope.session.transport import valid_speed
from slam_core.errors import SlamError


class Control:
    """Belongs to the engine's thread. live: whether the source is a stream, which brings nothing back."""

    def __init__(
        self, session: Session, saver: Saver, examiner: Examiner, downloads: Downloads, *, live: bool
    ) -> None:
        self.questions = Questions()
        self.probes = Probes()
        self._session, self._live = session, live
        self._saver, self._examiner, self._downloads = saver, examiner, downloads
        self._transport = session.transport

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
        would_lose = self._live and loss(
            command, session.run.pipeline, session.change, stopped=self._transport.stopped
        )
        if would_lose:
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
            case StepScan() | StepBack() | SetSpeed() | ChangeSpeed() if self._live:
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
            case Configure() | ConfigureAll():
                self._configure(command)
            case Save() | Examine() | Export():
                self._beside(command)
            case Restart() | Repair() | Seek():
                self._begin_again(command)
            case Undo() | Agree() | Decline() | Inspect():
                self._answer(command)

    def _begin_again(self, command: Restart | Repair | Seek) -> None:
        match command:
            case Restart():
                self._session.restart()
            case Repair():
                self._session.repair()
            case Seek(time_ns):
                self._session.seek(time_ns)

    def _answer(self, command: Undo | Agree | Decline | Inspect) -> None:
        match command:
            case Inspect():
                self.probes.obey(command, self._session.run)
            case Undo():
                self.questions.withdraw()  # it was asked about another run
                self._session.undo()
            case Agree(number):
                held = self.questions.agreed(number)
                if held is not None:
                    self._do(held)
            case Decline(number):
                self.questions.declined(number)

    def _pause(self) -> None:
        """Rest, in a recording after one more scan: what it was before that scan is kept for changed settings."""
        on = self._transport.running and not self._live
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
            change = self._session.change(command)
        except SlamError as error:
            self._refuse(str(error))
            return
        if change is not None:
            self._session.configure(change)

    def _beside(self, command: Save | Examine | Export) -> None:
        """Work that goes on beside the run."""
        try:
            match command:
                case Save():
                    self._saver.start(self._session.run, self._session.report)
                case Examine():
                    self._examiner.start()
                case Export():
                    self._downloads.start(command, self._session.run, self._session.report)
        except SlamError as error:
            self._refuse(str(error))

    def _refuse(self, reason: str) -> None:
        self._session.log(reason, "warning", answer=True)
