"""Recordings of either ROS generation: .bag, rosbag2 folders, bare .mcap and .db3."""

from collections import deque
from collections.abc import Collection, Iterator, Mapping
from copy import copy, deepcopy
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from hectorscope.common.paths import exists
from hectorscope.inputs import Item, SourceError, SourceOptions, SourceReport, Stamped
from hectorscope.ros.converter import Converter
from hectorscope.ros.decode import BadDefinition, Decode, decoder
from hectorscope.ros.messages import BadMessage, stamp_ns, stamped
from hectorscope.ros.roles import (
    ROLE_TYPES,
    SCAN,
    TF_TYPES,
    Topic,
    check_overrides,
    choose_roles,
    is_static_tf,
)
from hectorscope.sources import SourceKind
from hectorscope.sources._containers import SUFFIXES, open_recording
from hectorscope.sources._recording import Channel, Passed, Raw, Recording

USABLE_TYPES = frozenset(name for names in (*ROLE_TYPES.values(), TF_TYPES) for name in names)


@dataclass(eq=False)
class _Reading:
    """How far a reading has come: what converts, the messages of the two parts, and what is ready."""

    converter: Converter
    passed: tuple[Passed, Passed] = field(default_factory=lambda: (Passed(), Passed()))
    ready: deque[Item] = field(default_factory=deque)


class BagSource:
    """A recording from its beginning to its end. Every call of `items` reads it anew, with new counters."""

    live = False

    def __init__(self, recording: Recording, options: SourceOptions) -> None:
        self.name = recording.path.name
        self.recording = recording
        self.container = recording.container
        self._options = options
        self._closed = False
        self._failure = ""
        self._decoders, self._refused = _decoders(recording)
        scans = self._first_scans()
        self.topics = _topics(self._usable(), {topic: len(m.ranges) for topic, (m, _) in scans.items()})
        check_overrides(self.topics, options)
        self.roles = choose_roles(self.topics, options)
        self.has_scans = self.roles.scan in scans
        self.span_ns = self._span_ns(scans)
        self._reading = _Reading(Converter(self.roles, options))

    @property
    def report(self) -> SourceReport:
        """Counters of the latest reading; what is wrong with the file is among the notes."""
        report = self._reading.converter.report
        scans = next((topic.messages for topic in self.topics if topic.name == self.roles.scan), None)
        unusable = sum(n for why, n in report.skipped.items() if why.startswith(f"{self.roles.scan}: "))
        report = replace(report, warnings=(*report.warnings, *self.refused), scans=scans, unusable=unusable)
        damage = self._failure or self.recording.damage
        if not damage:
            return report
        return replace(
            report, notes=(f"{self.name} is cut off or damaged ({damage}): read as far as it goes", *report.notes)
        )

    @property
    def refused(self) -> tuple[str, ...]:
        """The topics whose messages cannot be decoded, a sentence each."""
        return tuple(f"{channel.topic} is not used: {reason}" for channel, reason in self._refused.items())

    @property
    def damage(self) -> str:
        """Why the recording is known not to be whole; empty if it is."""
        return self._failure or self.recording.damage

    def items(self) -> Iterator[Item]:
        """Measurements in the order of recording. The static transforms go ahead: they hold for all times."""
        return self._items(_Reading(Converter(self.roles, self._options)))

    def place(self) -> object:
        """Where the latest reading is."""
        return deepcopy(self._reading)

    def items_from(self, place: object) -> Iterator[Item]:
        """The measurements behind a place."""
        assert isinstance(place, _Reading)
        return self._items(deepcopy(place))

    def again(self) -> "BagSource":
        """A reading of its own in the same files, which stay open when it is closed."""
        other = copy(self)
        other.recording, other._failure = replace(self.recording, close=lambda: None), ""
        other._reading = _Reading(Converter(self.roles, self._options))
        return other

    def _items(self, reading: _Reading) -> Iterator[Item]:
        self._failure = ""
        self._reading, converter = reading, reading.converter
        wanted = [channel for channel in self._decoders if channel.topic in self.roles.topics()]
        static = [channel for channel in wanted if is_static_tf(channel.topic)]
        rest = [channel for channel in wanted if channel not in static]
        yield from _handed_out(reading.ready)
        for channels, passed in zip((static, rest), reading.passed, strict=True):
            for raw, message in self._decoded(channels, converter, passed):
                topic, msgtype = raw.channel.topic, raw.channel.msgtype
                reading.ready.extend(converter.convert(topic, msgtype, message, raw.log_ns))
                yield from _handed_out(reading.ready)
        reading.ready.extend(converter.flush())
        yield from _handed_out(reading.ready)

    def close(self) -> None:
        """End the readings that are under way; no file stays open."""
        self._closed = True
        self.recording.close()

    @property
    def clock_offset_ns(self) -> int:
        """From the recorder's clock to that of the scans."""
        return self.span_ns[0] - self.recording.span_ns[0]

    @property
    def parts(self) -> Mapping[str, str]:
        """The topics in use, by their parts."""
        roles = {role: getattr(self.roles, role) for role in ROLE_TYPES}
        return {role: topic for role, topic in roles.items() if topic is not None}

    @property
    def unplaced(self) -> tuple[str, ...]:
        """Frames of sensors that tf did not place in the latest reading."""
        return self._reading.converter.mounts.unplaced

    @property
    def put_right(self) -> tuple[str, ...]:
        """Topics whose clocks were put beside that of the scans in the latest reading."""
        return self._reading.converter.put_right

    def reopened(self) -> "BagSource":
        """The same recording."""
        return open_bag(self.recording.path, self._options)

    def stamped(self) -> Iterator[Stamped]:
        """Every message that can be of use and decoded, by its times, in the order of recording."""
        for raw, message in self._decoded(self._decoders, None):
            yield stamped(raw.channel.topic, message, raw.log_ns)

    def _usable(self) -> dict[Channel, int]:
        """The channels that were not refused, with their messages."""
        return {channel: n for channel, n in self.recording.messages.items() if channel not in self._refused}

    def _decoded(
        self, channels: Collection[Channel], converter: Converter | None, passed: Passed | None = None
    ) -> Iterator[tuple[Raw, Any]]:
        for raw in self._raw(channels, converter, passed):
            if self._closed:
                return
            try:
                message = self._decoders[raw.channel](raw.data)
            except BadMessage as reason:
                if converter is not None:
                    converter.skip(raw.channel.topic, str(reason))
                continue
            yield raw, message

    def _raw(
        self,
        channels: Collection[Channel],
        converter: Converter | None = None,
        passed: Passed | None = None,
    ) -> Iterator[Raw]:
        """Messages up to where the file can be read; a database may hold anything in place of one.

        passed: what was read before, to which these are added.
        """
        passed = Passed() if passed is None else passed
        try:
            for raw in self.recording.read(channels, passed):
                passed.note(raw)
                if type(raw.log_ns) is int and isinstance(raw.data, bytes | memoryview):
                    yield raw
                elif converter is not None:
                    converter.skip(raw.channel.topic, "entry whose time or data is none")
        except Exception as error:  # the parsers' ways to stumble over a damaged file are many
            self._failure = f"{type(error).__name__}: {error}".splitlines()[0]
            return
        for channel in channels:  # some parsers stop at damage without a word
            promised = self.recording.messages[channel]
            if (read := passed.read[channel]) < promised:
                self._failure = f"{read} of {promised} messages of {channel.topic} are there"

    def _first_scans(self) -> dict[str, tuple[Any, int]]:
        """The first scan of each scanner that can be decoded, and when it was recorded."""
        scans = {}
        for channel in self._decoders:
            if channel.msgtype == SCAN:
                found = next(self._decoded([channel], None), None)
                if found is not None:
                    scans[channel.topic] = (found[1], found[0].log_ns)
        return scans

    def _span_ns(self, scans: dict[str, tuple[Any, int]]) -> tuple[int, int]:
        """First and last time by the clock of the scans, which need not be that of the recorder."""
        begin_ns, end_ns = self.recording.span_ns
        message, log_ns = scans.get(self.roles.scan or "", (None, 0))
        offset_ns = stamp_ns(message, log_ns) - log_ns
        return begin_ns + offset_ns, end_ns + offset_ns


def _handed_out(ready: deque[Item]) -> Iterator[Item]:
    while ready:
        yield ready.popleft()


def open_bag(path: Path, options: SourceOptions) -> BagSource:
    """The recording at a path, whatever is in it; SourceError if it cannot be read."""
    return BagSource(open_recording(path), options)


def _open(uri: str, options: SourceOptions) -> BagSource:
    """The recording at a path; SourceError if it cannot be used for mapping."""
    source = open_bag(Path(uri), options)
    if source.roles.scan is None:
        held = ", ".join(f"{topic.name} ({topic.msgtype})" for topic in source.topics) or "nothing of use"
        raise SourceError(
            "; ".join([f"{uri} has no laser scan (sensor_msgs/LaserScan): it holds {held}", *source.refused])
        )
    if not source.has_scans:
        because = f" ({source.damage})" if source.damage else ""
        raise SourceError(f"{uri}: no scan of {source.roles.scan} can be read{because}: record it again")
    return source


def _accepts(uri: str) -> bool:
    """Paths that end like a recording or have no suffix, as folders; whether they exist is found on opening."""
    path = Path(uri)
    return "://" not in uri and (path.suffix in ("", *SUFFIXES) or (exists(path) and path.is_dir()))


def _decoders(recording: Recording) -> tuple[dict[Channel, Decode], dict[Channel, str]]:
    """For the channels that can be of use, and why others of their types cannot be decoded."""
    decoders: dict[Channel, Decode] = {}
    refused: dict[Channel, str] = {}
    for channel, messages in recording.messages.items():
        if messages and channel.msgtype in USABLE_TYPES:
            try:
                decode = decoder(channel.generation, channel.msgtype, channel.definition, channel.form)
            except BadDefinition as reason:
                refused[channel] = str(reason)
                continue
            if decode is not None:
                decoders[channel] = decode
    return decoders, refused


def _topics(channels: Mapping[Channel, int], beams: dict[str, int]) -> list[Topic]:
    return [
        Topic(channel.topic, channel.msgtype, messages, beams.get(channel.topic, 0))
        for channel, messages in channels.items()
        if messages
    ]


SOURCE = SourceKind(_accepts, _open, SUFFIXES)
