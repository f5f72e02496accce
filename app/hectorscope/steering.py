"""What a hand asks of a simulated robot, and what a page shows of it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

Place = tuple[float, float]
"""x, y in the map, metres."""


@dataclass(frozen=True, slots=True)
class Fault:
    """An error of a sensor, or the sway of the robot, that a hand sets. Range and default in `unit`."""

    title: str
    unit: str
    low: float
    high: float
    default: float

    def clamped(self, value: float) -> float:
        """Within the range; the default for what is no number."""
        return min(max(value, self.low), self.high) if math.isfinite(value) else self.default


FAULTS: Mapping[str, Fault] = {
    "range_noise": Fault("Range noise (sigma)", "m", 0.0, 0.2, 0.01),
    "gyro_bias": Fault("Gyro bias, each axis", "°/s", -2.0, 2.0, 0.0),
    "gyro_noise": Fault("Gyro noise (sigma)", "°/s", 0.0, 3.0, 0.3),
    "accel_bias": Fault("Accelerometer bias, forward", "m/s²", -1.0, 1.0, 0.0),
    "accel_noise": Fault("Accelerometer noise (sigma)", "m/s²", 0.0, 1.0, 0.03),
    "sway": Fault("Sway in roll and pitch", "°", 0.0, 20.0, 0.0),
}


@dataclass(frozen=True, slots=True)
class Steer:
    """Drive: shares of the full speed and of the full turn rate, -1 to 1; left turns are positive."""

    forward: float
    turn: float


@dataclass(frozen=True, slots=True)
class SetFault:
    """Another size of an error, by its name in FAULTS."""

    name: str
    value: float


@dataclass(frozen=True, slots=True)
class SetDoor:
    """Open or close the door of this number."""

    number: int
    open: bool


@dataclass(frozen=True, slots=True)
class PutBox:
    """Put the box of this number at a place; None puts it ahead of the robot."""

    number: int
    place: Place | None


@dataclass(frozen=True, slots=True)
class TakeBox:
    """Take the box of this number out of the world."""

    number: int


Request = Steer | SetFault | SetDoor | PutBox | TakeBox


@dataclass(frozen=True, slots=True)
class DriveState:
    """faults: by the names in FAULTS. doors: which are open. boxes: where they stand, None for one taken away."""

    world: str
    faults: Mapping[str, float]
    doors: tuple[bool, ...]
    boxes: tuple[Place | None, ...]


@runtime_checkable
class Drivable(Protocol):
    """A source whose robot is driven by hand."""

    @property
    def state(self) -> DriveState:
        """What a page shows of it."""

    def drive(self, request: Request) -> str:
        """Obey from the next step on, from any thread; a sentence if that cannot be, else empty."""
