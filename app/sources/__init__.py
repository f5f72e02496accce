"""Where measurements come from. One file an input; each has `SOURCE`, a `SourceKind`."""

import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal, Protocol

from app.registry import members
from app.snapshot import SourceReport
from slam_core.errors import SlamError
from slam_core.measurements import Measurement, TruthPose

Item = Measurement | TruthPose


class SourceError(SlamError):
    """The input cannot be used: the message names it and the remedy."""


@dataclass(frozen=True, slots=True)
class SourceOptions:
    """What a person may override; None lets the source find it by message type, or believe the message.

    Of what is stated here nothing is doubted any more (see app.devices).
    """

    scan_topic: str | None = None
    imu_topic: str | None = None
    attitude_topic: str | None = None
    odometry_topic: str | None = None
    height_topic: str | None = None
    ground_topic: str | None = None
    magnetic_topic: str | None = None
    gps_topic: str | None = None
    gps_velocity_topic: str | None = None
    truth_topic: str | None = None
    base_frame: str | None = None
    laser_pose: tuple[float, float, float, float, float, float] | None = None  # x y z [m] roll pitch yaw [rad]
    imu_accel_unit: Literal["m/s2", "g", "mg"] | None = None
    imu_gyro_unit: Literal["rad/s", "deg/s"] | None = None
    imu_inverted: Literal["accel", "gyro"] | None = None
    imu_rotation: tuple[float, float, float] | None = None  # roll pitch yaw [rad] of the device, on top of tf
    imu_delay: float | None = None  # s by which its stamps are late
    scan_mirrored: bool | None = None
    scan_delay: float | None = None


class Source(Protocol):
    """An open input."""

    name: str
    live: bool

    @property
    def span_ns(self) -> tuple[int, int] | None:
        """First and last time of a recording; None for a stream."""

    @property
    def report(self) -> SourceReport:
        """Counters so far, of the latest call of `items`."""

    def items(self) -> Iterator[Item]:
        """Every measurement in order of arrival, from the beginning; a stream never ends by itself."""

    def close(self) -> None:
        """Let go of files and sockets; `items` ends."""


@dataclass(frozen=True, slots=True)
class SourceKind:
    """How one kind of input is recognised and opened. `open` raises SourceError."""

    accepts: Callable[[str], bool]
    open: Callable[[str, SourceOptions], Source]


def open_source(uri: str, options: SourceOptions) -> Source:
    """The source for a path or address; SourceError when no kind accepts it."""
    kinds: list[SourceKind] = members(sys.modules[__name__], "SOURCE")
    for kind in kinds:
        if kind.accepts(uri):
            return kind.open(uri, options)
    raise SourceError(f"{uri} is neither a recording nor an address: give a bag, a CARMEN log or ws://HOST:PORT")
