"""What the operator's station asks of the engine, beyond the commands of every page."""

from dataclasses import dataclass

from hectorscope.session.commands import Command


@dataclass(frozen=True, slots=True)
class StationCommand(Command):
    """Of the operator's station."""


@dataclass(frozen=True, slots=True)
class Record(StationCommand):
    """Record the messages of the stream from now on, or no longer."""

    on: bool


@dataclass(frozen=True, slots=True)
class Resume(StationCommand):
    """Go on with the run of this address that ended without being closed."""


@dataclass(frozen=True, slots=True)
class GiveUpPast(StationCommand):
    """Do not offer that run at the next start again."""


@dataclass(frozen=True, slots=True)
class HandOver(StationCommand):
    """A browser of an operator has got control. Sent by the server only. address: of its machine."""

    address: str


@dataclass(frozen=True, slots=True)
class PutMark(StationCommand):
    """Set a mark at x, y in the map, metres."""

    kind: str
    x: float
    y: float
    text: str = ""


@dataclass(frozen=True, slots=True)
class EditMark(StationCommand):
    """Another kind and text for the mark of this number."""

    number: int
    kind: str
    text: str


@dataclass(frozen=True, slots=True)
class PutPicture(StationCommand):
    """A picture for the mark of this number, as a browser sent it."""

    number: int
    content: bytes


@dataclass(frozen=True, slots=True)
class RemoveMark(StationCommand):
    """Take away the mark of this number; it can be brought back for a minute."""

    number: int


@dataclass(frozen=True, slots=True)
class SetPose(StationCommand):
    """The robot of a stream is at x, y [m] in the map, and looks along yaw [rad]."""

    x: float
    y: float
    yaw: float


@dataclass(frozen=True, slots=True)
class ShowReturn(StationCommand):
    """Show the way back to the start, or no longer."""

    on: bool
