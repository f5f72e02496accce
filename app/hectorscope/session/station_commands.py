"""What the operator's station asks of the engine, beyond the commands of every page."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class StationCommand:
    """Of the operator's station."""


@dataclass(frozen=True, slots=True)
class Record(StationCommand):
    """Record the messages of the stream from now on, or no longer."""

    on: bool


@dataclass(frozen=True, slots=True)
class Resume(StationCommand):
    """Go on with the run of this address that ended without being closed."""


@dataclass(frozen=True, slots=True)
class HandOver(StationCommand):
    """A browser of an operator has got control. Sent by the server only. address: of its machine."""

    address: str
