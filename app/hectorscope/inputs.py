"""The words that sources and the readers of messages share: items, options, counters, errors."""

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal, NamedTuple, Protocol, runtime_checkable

from hectorscope.common.robot_link import RobotLink
from slam_core.errors import SlamError
from slam_core.measurements import Float32s, Measurement, Transform, TruthPose

Item = Measurement | TruthPose


class SourceError(SlamError):
    """The input cannot be used: the message names it and the remedy."""


@dataclass(frozen=True, slots=True)
class LinkOptions:
    """How a robot is reached. ca: a trusted issuer's certificate, a file. headers: of the handshake."""

    ca: str | None = None
    headers: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True, slots=True)
class SourceOptions:
    """What a person may override; None: found by message type, or as the message states.

    What is stated here is not checked any more (see hectorscope.checks.findings).
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
    scan_sweep: float | None = None  # s from the first beam to the last; negative: the last one is the first
    own_frame: str | None = None  # whose transforms come from here: what tf says of frames in it is left out
    link: LinkOptions | None = None


OptionValue = str | bool | float | tuple[float, ...]

# What `SourceOptions` state about the sensors themselves, and so what can be repaired.
SENSOR_OPTIONS = (
    "imu_topic", "odometry_topic", "imu_accel_unit", "imu_gyro_unit", "imu_inverted", "imu_rotation", "imu_delay",
    "scan_mirrored", "scan_delay", "scan_sweep",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Finding:
    """What is wrong with a sensor or a recording: the fact with its value, and the options that repair it, if any.

    grave: it spoils a run. remedy: what a person can do, where no option repairs it. time_ns: when it begins.
    """

    fact: str
    options: Mapping[str, OptionValue] = field(default_factory=dict)
    grave: bool = True
    remedy: str = ""
    time_ns: int | None = None

    def moved(self, by_ns: int) -> "Finding":
        """The same by another clock."""
        return self if self.time_ns is None else replace(self, time_ns=self.time_ns + by_ns)

    @property
    def repair(self) -> str:
        """The same options as flags of the command line."""
        return flags(self.options)


def flags(options: Mapping[str, OptionValue]) -> str:
    """Options as flags of the command line."""
    return " ".join(f"--{name.replace('_', '-')} {_words(value)}" for name, value in options.items())


def _words(value: OptionValue) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, tuple):
        return " ".join(f"{part:g}" for part in value)
    return value if isinstance(value, str) else f"{value:g}"


@dataclass(frozen=True, slots=True)
class SourceReport:
    """Counters of a source: nothing is lost in silence.

    skipped: reason (with the topic's name and the remedy) -> how often. dropped: scans given up to keep up with a
    live stream. scans: how many a recording holds, if that is known. unusable: how many of its scans were left out
    by the source. waiting: why nothing flows at this moment, and the remedy; empty while all is well. connected:
    whether there is a link to the robot; None for a recording.
    scan_topic: where its scans are expected from.
    findings: what the sensor check found and nobody has repaired. repaired: what was found and repaired.
    sensors: the `SENSOR_OPTIONS` that are stated by now, for whoever runs it again.
    origin: latitude and longitude in degrees, altitude over the ellipsoid in metres, from which the positions of
    the satellites count; None before the first.
    notes: sentences on what was found or assumed (a mount, a choice among topics, a cut file). warnings: sentences
    on what is wrong, with the remedies. link: of a stream whose clock runs beside ours.
    """

    read: Mapping[str, int] = field(default_factory=dict)
    skipped: Mapping[str, int] = field(default_factory=dict)
    dropped: int = 0
    scans: int | None = None
    unusable: int = 0
    waiting: str = ""
    notes: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    connected: bool | None = None
    scan_topic: str = ""
    findings: tuple[Finding, ...] = ()
    repaired: tuple[Finding, ...] = ()
    sensors: Mapping[str, OptionValue] = field(default_factory=dict)
    origin: tuple[float, float, float] | None = None
    link: RobotLink | None = None


class Stamped(NamedTuple):
    """A message of a recording, by its times.

    log_ns: when it was recorded. stamp_ns, frame: of its header; None without one. lasts_ns: how long after its
    stamp the measurement ended. ranges: (n,) of a laser scan, metres, as the message has them; limits: range_min
    and range_max of the message.
    """

    topic: str
    log_ns: int
    stamp_ns: int | None = None
    frame: str = ""
    lasts_ns: int = 0
    ranges: Float32s | None = None
    limits: tuple[float, float] = (0.0, math.inf)


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


@runtime_checkable
class Seekable(Source, Protocol):
    """A recording whose items can go on at any one of them."""

    def place(self) -> object:
        """Where `items` or `items_from` is, by the thread that reads; never changed later. None: not known."""

    def items_from(self, place: object) -> Iterator[Item]:
        """The items behind that place, with the counters as they were there."""


@runtime_checkable
class Rereadable(Source, Protocol):
    """A recording that can be read at several places at the same time."""

    def again(self) -> "Seekable | None":
        """The same recording, with a place and counters of its own; close it first. None: not possible."""


@runtime_checkable
class Examinable(Source, Protocol):
    """A recording that can be examined as such, apart from a run.

    clock_offset_ns: from the recorder's clock to that of the scans.
    """

    clock_offset_ns: int

    @property
    def parts(self) -> Mapping[str, str]:
        """The topics in use, by what they are used for."""

    @property
    def unplaced(self) -> Sequence[str]:
        """Frames of sensors that tf does not place, once `items` were read."""

    @property
    def put_right(self) -> Sequence[str]:
        """Topics whose clocks were put beside that of the scans, once `items` were read."""

    def stamped(self) -> Iterator[Stamped]:
        """Every message of a topic that has a use, in the order of recording."""


@runtime_checkable
class Reopenable(Source, Protocol):
    """An input that can be opened once more, to be read apart from the run."""

    def reopened(self) -> Source:
        """The same, from its beginning; whoever asks for it closes it. SourceError."""


@runtime_checkable
class Framed(Source, Protocol):
    """A stream of a robot with coordinate frames of its own."""

    def root(self, time_ns: int) -> tuple[str, Transform]:
        """The frame that the robot's own tree begins with, and T_root_base at a time; from any thread."""


@runtime_checkable
class Repairable(Source, Protocol):
    """An input whose sensors are checked, and that can be opened again with what was found put right.

    repairs: whether that was asked for from the start.
    """

    repairs: bool

    def repair(self) -> tuple[Finding, ...]:
        """Repair what was found; that, or nothing. The input is opened again: `items` begins anew. SourceError."""


class Message(NamedTuple):
    """A serialised message of a live stream, as it came.

    encoding: "cdr" or "ros1". definition: of its type, in the format `form`; "" for the standard one.
    received_ns: when the other side got it, by its clock.
    """

    topic: str
    encoding: str
    msgtype: str
    definition: str
    form: str
    received_ns: int
    data: bytes


class MessageListener(Protocol):
    """Gets every message that a live source uses, on the thread that reads it: it must not wait for anything."""

    @property
    def warning(self) -> str:
        """Why messages are not kept at this moment, with the remedy; empty while all is well."""

    def take(self, message: Message) -> None:
        """One more."""


@runtime_checkable
class Tappable(Source, Protocol):
    """A live input whose messages are passed on as they came."""

    def tap(self, listener: MessageListener) -> None:
        """Pass it the static transforms so far, and from now on every message."""

    def untap(self, listener: MessageListener) -> None:
        """It gets nothing any more."""


@runtime_checkable
class OffersTopics(Source, Protocol):
    """A live input that tells what there is."""

    @property
    def offered(self) -> Mapping[str, str]:
        """The message types by their topics."""


def merged(report: SourceReport, skipped: Counter[str], dropped: int) -> SourceReport:
    """The source's counters with those of the queue and the core."""
    counted = dict(Counter(report.skipped) + skipped)
    return replace(report, skipped=counted, dropped=report.dropped + dropped)
