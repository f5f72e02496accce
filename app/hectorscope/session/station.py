"""The operator's station beside the run of a stream: what is recorded, the journal, the log of actions."""

import math
import time
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

from hectorscope.inputs import Source, Tappable
from hectorscope.ros.stream_recorder import RecordError, StreamRecorder
from hectorscope.run.annotations import AnnotationError
from hectorscope.run.pictures import picture_of
from hectorscope.session import journal_files
from hectorscope.session.commands import Command, Export, GoLive, Inspect, ListRecordings, Seek
from hectorscope.session.control import Control
from hectorscope.session.journal import Journal
from hectorscope.session.session import Session
from hectorscope.session.station_commands import (
    EditMark,
    GiveUpPast,
    HandOver,
    PutMark,
    PutPicture,
    Record,
    RemoveMark,
    Resume,
    SetPose,
    ShowReturn,
    StationCommand,
)
from hectorscope.session.station_state import StationState
from hectorscope.session.undo import KeptMarks
from hectorscope.session.way_back import WayBack
from slam_core.config import SlamConfig, leaves
from slam_core.errors import SlamError
from slam_core.geometry import heading
from slam_core.results import PlanarGaussian

POSE_SIGMAS = (0.3, 0.3, 0.2)  # m, m, rad: of a pose that a hand shows
OFFERED_S = 600.0  # seconds that an earlier run is offered
MarkCommand = PutMark | EditMark | PutPicture | RemoveMark
UNLOGGED = (Inspect, Seek, GoLive, ListRecordings, Export)  # a look changes nothing


class Station:
    """Belongs to the engine's thread, but for its making.

    record: folder for the messages of the stream, begun at once. journal: None keeps none. resume: go on with the
    run that ended badly, instead of offering that.
    """

    def __init__(
        self, record: Path | None = None, journal: Journal | None = None, *, resume: bool = False
    ) -> None:
        """RecordError if the folder is of no use."""
        self._folder, self._journal, self._resumes = record, journal, resume
        self._recorder = StreamRecorder(record) if record else None
        self._tapped: Tappable | None = None
        self._way_back = WayBack()

    def attach(self, session: Session) -> None:
        """Belong to a session."""
        self._session = session

    def begin(self, control: Control) -> None:
        """The run is about to begin: listen to its source, and offer the run before it."""
        session, self._control = self._session, control
        control.station = self
        if not session.source.live:
            return
        if self._recorder is not None:
            self._listen(self._recorder, tappable(session.intake.source))
        if self._journal is None:
            return
        self._journal.listen(session.intake.source)
        if self._journal.past is None:
            return
        if self._resumes:
            self.obey(Resume())
        else:
            begun = journal_files.begun(self._journal.past)
            control.questions.ask(
                Resume(),
                f"The run of {begun} ended without being closed. Its map is kept: go on with it?",
                f"Go on with the map of {begun}",
                "Begin a new map",
                patience_s=OFFERED_S,
                otherwise=GiveUpPast(),
            )

    @property
    def state(self) -> StationState:
        """For the page."""
        records = None if self._folder is None else self._recorder is not None and not self._recorder.failed
        told = (self._journal.warning if self._journal else "",)
        run = self._session.run
        return StationState(
            annotations=run.annotations.marks,
            way_back=self._way_back.path if self._way_back.shown else None,
            records=records,
            recorded=self._recorder.written if self._recorder else 0,
            warnings=tuple(filter(None, told)),
            past=self._session.source.live and self._journal is not None and self._journal.past is not None,
        )

    def keep(self) -> None:
        """Before each turn of the engine: leave a checkpoint if it is time, and nothing is half done."""
        session = self._session
        self._way_back.follow(session.past.newest.pipeline)
        if self._journal is not None and session.source.live and not session.past.front:
            self._journal.keep(session.run, paused=session.transport.unwanted)

    @property
    def patience(self) -> float | None:
        """Seconds until `keep` may have more to do, also if nothing comes any more; None for ever."""
        return self._journal.patience if self._journal else None

    def logged(self, act: Callable[[Command], None], command: Command) -> None:
        """Carry a command out, and log it with what it changed."""
        if self._journal is None or isinstance(command, UNLOGGED):
            act(command)
            return
        before = self._seen()
        act(command)
        pairs = zip(before.items(), self._seen().values(), strict=True)
        changed = {name: [old, new] for (name, old), new in pairs if old != new}
        self._journal.log(
            {
                "time": time.time(),
                "role": "operator",
                "action": type(command).__name__,
                "values": plain(command),
                "changed": changed,
            }
        )
        self._journal.wanted |= bool(changed)

    def _seen(self) -> dict[str, Any]:
        session, transport = self._session, self._session.transport
        return {
            **values(session.run.settings.at(session.now_ns)),
            "run": session.run.number,
            "pose": self._pose(),
            "running": transport.running,
            "speed": transport.speed,
            "records": self.state.records,
            "marks": [mark.told(0) for mark in session.run.annotations.marks],
            "question": self._control.questions.open is not None,
        }

    def _pose(self) -> list[float] | None:
        """x, y [m] and heading [rad] in the map, as known now; None before the first scan."""
        slam = self._session.past.newest.pipeline.slam
        if slam.now_ns is None:
            return None
        motion = slam.motion_at([slam.now_ns])[0]
        return [*motion[:2].tolist(), heading(motion[3:7])]

    def obey(self, command: StationCommand) -> None:
        """Carry a command of the station out; what cannot be done is told in the log of the page."""
        try:
            match command:
                case Record(on):
                    self._record(on)
                case HandOver(address):
                    self._session.log(f"The operator at {address} is in control")
                case Resume():
                    self._resume()
                case GiveUpPast():
                    if self._journal is not None:
                        self._journal.give_up_past()
                case PutMark() | EditMark() | PutPicture() | RemoveMark():
                    self._mark(command)
                case SetPose():
                    self._set_pose(command)
                case ShowReturn(on):
                    self._way_back.show(on)
        except SlamError as error:
            self._session.log(str(error), "warning", answer=True)

    def _mark(self, command: MarkCommand) -> None:
        run, before = self._session.run, self._session.run.annotations
        result = run.pipeline.result
        match command:
            case PutMark(kind, x, y, text):
                if result is None:
                    raise AnnotationError("There is no map yet to set a mark in: wait for the first scan")
                px, py, yaw = result.fused.mean.tolist()
                run.annotations = before.put(kind, run.pipeline.time_ns, (x, y), (px, py, yaw), text)
                what = f"mark {run.annotations.given}"
            case EditMark(number, kind, text):
                run.annotations, what = before.edited(number, kind, text), f"edited mark {number}"
            case PutPicture(number, content):
                run.annotations = before.pictured(number, picture_of(content))
                what = f"picture of mark {number}"
            case RemoveMark(number):
                run.annotations, what = before.removed(number), f"removed mark {number}"
        self._session.undone.push(what, KeptMarks(before))
        self._session.log(f"{what[:1].upper()}{what[1:]}: {sentence(command)}")

    def _set_pose(self, command: SetPose) -> None:
        session = self._session
        pose = PlanarGaussian(np.array([command.x, command.y, command.yaw]), np.diag(np.square(POSE_SIGMAS)))
        if not (session.source.live and session.run.pipeline.slam.reset_pose(pose)):
            raise SlamError("The pose can be set of a stream only, once it has a map and a scan came")
        session.run.checkpoints.forget_from(0)  # what was kept would lead past it
        degrees = math.degrees(command.yaw)
        session.log(f"The pose was set to x {command.x:.2f} m, y {command.y:.2f} m, {degrees:.0f}°")

    def _record(self, on: bool) -> None:
        if self._folder is None:
            raise RecordError("There is no folder for recordings: start the program with --record DIR")
        source = tappable(self._session.intake.source) if on else None
        recorder = StreamRecorder(self._folder) if on else None
        if self._recorder is not None:
            if self._tapped is not None:
                self._tapped.untap(self._recorder)
            self._recorder.close()
        self._recorder = self._tapped = None
        if recorder is not None and source is not None:
            self._listen(recorder, source)
        self._session.log(
            f"The stream is {'' if on else 'no longer '}recorded in {self._folder.name}", answer=True
        )

    def _listen(self, recorder: StreamRecorder, source: Tappable) -> None:
        source.tap(recorder)
        self._recorder, self._tapped = recorder, source

    def _resume(self) -> None:
        if self._journal is None:
            raise SlamError("There is no journal: start the program without --journal off")
        if not self._session.source.live:
            raise SlamError("Only a stream can go on with the run before: go back to it first")
        session, told = self._session, self._control.opening
        told("Processing the run before again")
        try:
            found = self._journal.resumed(session.run.settings, session.prior_map, told)
        finally:
            told("")
        session.adopt(found.pipeline, "going on with the run before")
        session.run.annotations = found.annotations
        self._journal.forget_past()
        if found.left_out:
            session.log(found.left_out, "warning")
        session.log(
            f"Goes on with the map of {found.pipeline.scans} scans; {found.again} of them were processed again",
            answer=True,
        )

    def close(self) -> None:
        """The run ended in order."""
        if self._recorder is not None:
            self._recorder.close()
        if self._journal is not None:
            self._journal.close()


def tappable(source: Source) -> Tappable:
    """RecordError for a source that is no stream."""
    if not isinstance(source, Tappable):
        raise RecordError("Only a stream can be recorded: a recording is one already")
    return source


def values(config: SlamConfig) -> dict[str, Any]:
    """Every setting by its dotted name."""
    return {leaf.name: leaf.value for leaf in leaves(config)}


def sentence(command: MarkCommand) -> str:
    """What a mark is, for the log."""
    if isinstance(command, RemoveMark):
        return "it can be brought back for a minute"
    if isinstance(command, PutPicture):
        return "it is kept with the mark"
    return f"{command.kind} {command.text}".strip()


def plain(value: Any) -> Any:
    """A command as something that JSON holds."""
    if is_dataclass(value):
        return {field.name: plain(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, bytes):
        return f"{len(value)} bytes"
    return value if isinstance(value, str | int | float | bool | None) else str(value)
