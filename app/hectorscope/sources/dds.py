"""A robot's live topics by DDS, as ROS 2 speaks it without a bridge: one more participant of its domain."""

import os
import threading
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from hectorscope.inputs import SourceError, SourceOptions
from hectorscope.ros.dds import BARRED, FORM, domain, quality, raw_type, type_hash
from hectorscope.ros.dds_names import dds_topic, ros_topic, ros_type
from hectorscope.sources import stream
from hectorscope.sources._backoff import longer
from hectorscope.sources._live import LiveSource
from hectorscope.sources._offers import Event, Offer, Payload, Withdrawal
from hectorscope.sources._ros2_offers import ros2_offer

LOOK_NS = 200_000_000
MOST_TAKEN = 500  # samples of a topic at a time
DEPTH = 5000  # messages of a topic that wait; beyond, the oldest are dropped, and no publisher is held up


@dataclass(slots=True)
class _Topic:
    """One topic in one type. publishers: by their keys, whether each is reliable and latched."""

    name: str
    msgtype: str
    number: int
    publishers: dict[Any, tuple[bool, bool]] = field(default_factory=dict)
    reader: Any = None
    wake: Any = None
    quality: tuple[bool, bool] = (False, False)

    @property
    def offered(self) -> tuple[bool, bool]:
        """What all publishers offer: to ask for more would leave some of them out."""
        reliable, latched = zip(*self.publishers.values(), strict=True)
        return all(reliable), all(latched)


class DdsWire:
    """One participant, whose readers DDS itself connects again with publishers that come back."""

    def __init__(self, uri: str) -> None:
        """SourceError for an address of another form, or without the library."""
        self._domain = domain(uri, SourceError)
        self._topics: dict[tuple[str, str], _Topic] = {}
        self._numbers: dict[int, _Topic] = {}
        self._of_key: dict[Any, _Topic] = {}
        self._closed = threading.Event()
        self._participant: Any = None
        self._waitset: Any = None
        self._is_barred = False

    @property
    def status(self) -> str:
        """Why nothing flows right now; empty while somebody publishes."""
        if self._is_barred:
            return f"DDS domain {self._domain} {BARRED}"
        if any(topic.publishers for topic in self._topics.values()):
            return ""
        return (
            f"nobody publishes in DDS domain {self._domain}: start the robot's nodes,"
            " or give the domain of their ROS_DOMAIN_ID"
        )

    @property
    def round_trip_s(self) -> float:
        """DDS does not tell."""
        return 0.0

    def connections(self) -> Iterator[Iterator[Sequence[Event]]]:
        """One, which outlives the loss of every publisher."""
        from cyclonedds.core import DDSException  # noqa: PLC0415
        from cyclonedds.domain import DomainParticipant  # noqa: PLC0415

        pause = 0.0
        while not self._closed.wait(pause):
            try:
                self._participant = DomainParticipant(self._domain)
            except DDSException:
                self._is_barred = True
                pause = longer(pause)
                continue
            self._is_barred = False
            try:
                yield self._batches()
            finally:
                self._leave()
            return

    def _batches(self) -> Iterator[Sequence[Event]]:
        from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication  # noqa: PLC0415
        from cyclonedds.core import WaitSet  # noqa: PLC0415

        publications = BuiltinDataReader(self._participant, BuiltinTopicDcpsPublication)
        self._waitset = WaitSet(self._participant)
        self._watch(publications)
        while not self._closed.is_set():
            yield self._announced(publications.take(MOST_TAKEN))
            yield self._received()
            self._waitset.wait(LOOK_NS)

    def _watch(self, reader: Any) -> Any:
        """Let what comes in wake the loop."""
        from cyclonedds.core import InstanceState, ReadCondition, SampleState, ViewState  # noqa: PLC0415

        every = ViewState.Any | InstanceState.Any | SampleState.NotRead
        condition = ReadCondition(reader, every)
        self._waitset.attach(condition)
        return condition

    def _announced(self, samples: Sequence[Any]) -> list[Event]:
        """Publishers have come or gone; a topic is there as long as one of its publishers is."""
        from cyclonedds.core import InstanceState  # noqa: PLC0415

        events: list[Event] = []
        for sample in samples:
            is_there = sample.sample_info.instance_state == InstanceState.Alive
            events += self._came(sample) if is_there else self._went(sample.key)
        return events

    def _came(self, sample: Any) -> list[Event]:
        from cyclonedds.qos import Policy  # noqa: PLC0415

        name, msgtype = ros_topic(sample.topic_name), ros_type(sample.type_name)
        if name is None or msgtype is None:
            return []
        topic = self._topics.setdefault((name, msgtype), _Topic(name, msgtype, len(self._topics) + 1))
        self._numbers[topic.number] = self._of_key[sample.key] = topic
        is_new = not topic.publishers
        qos = sample.qos
        topic.publishers[sample.key] = (
            qos[Policy.Reliability] != Policy.Reliability.BestEffort,
            qos[Policy.Durability] != Policy.Durability.Volatile,
        )
        if topic.reader is not None and topic.quality != topic.offered:
            self._read(topic)
        if not is_new:
            return []
        told = qos[Policy.Userdata].data if Policy.Userdata in qos else b""
        return [ros2_offer(topic.number, name, msgtype, type_hash(told))]

    def _went(self, key: Any) -> list[Event]:
        topic = self._of_key.pop(key, None)
        if topic is None:
            return []
        del topic.publishers[key]
        return [] if topic.publishers else [Withdrawal(topic.number)]

    def subscribe(self, offers: Sequence[Offer]) -> None:
        """Read topics; of those that are latched, what was sent before, too."""
        for wanted in offers:
            topic = self._numbers[wanted.id]
            if topic.reader is None or topic.quality != topic.offered:
                self._read(topic)

    def _read(self, topic: _Topic) -> None:
        """In place of a reader that asked for more, or less, than the publishers offer now."""
        from cyclonedds.qos import Qos  # noqa: PLC0415
        from cyclonedds.sub import DataReader  # noqa: PLC0415
        from cyclonedds.topic import Topic  # noqa: PLC0415

        if topic.wake is not None:
            self._waitset.detach(topic.wake)
        topic.quality = is_reliable, is_latched = topic.offered
        qos = Qos(*quality(is_reliable=is_reliable, is_latched=is_latched, depth=DEPTH))
        known = Topic(self._participant, dds_topic(topic.name), raw_type(topic.msgtype))
        topic.reader = DataReader(self._participant, known, qos=qos)
        topic.wake = self._watch(topic.reader)

    def _received(self) -> list[Payload]:
        """What waits in all readers, as it was sent."""
        readers = [(topic.number, topic.reader) for topic in self._topics.values() if topic.reader is not None]
        samples = [(number, sample) for number, reader in readers for sample in reader.take(MOST_TAKEN)]
        payloads = [
            Payload(number, sample.sample_info.source_timestamp, sample.data)
            for number, sample in samples
            if sample.sample_info.valid_data
        ]
        return sorted(payloads, key=lambda payload: payload.received_ns)

    def _leave(self) -> None:
        """DDS objects end with the last reference to them."""
        self._closed.set()
        for topic in self._topics.values():
            topic.publishers, topic.reader, topic.wake = {}, None, None
        self._participant = self._waitset = None

    def close(self) -> None:
        """Leave the domain."""
        self._closed.set()


def usual() -> list[str]:
    """The domains where robots are: 0, and that of this terminal; none without the library."""
    known: dict[int, str] = {}
    for number in (os.environ.get("ROS_DOMAIN_ID", "0"), "0"):
        uri = FORM.replace("DOMAIN", number)
        with suppress(SourceError):
            known.setdefault(domain(uri, SourceError), uri)
    return list(known.values())


def _open(uri: str, options: SourceOptions) -> LiveSource:
    return LiveSource(uri, options, DdsWire(uri))


SOURCE = stream(_open, FORM)
