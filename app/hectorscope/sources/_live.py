"""A robot's live topics, whatever the protocol: which are wanted, and how they become measurements."""

import threading
import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Protocol

from hectorscope.inputs import Item, MessageListener, SourceOptions, SourceReport
from hectorscope.ros import messages
from hectorscope.ros.converter import Converter
from hectorscope.ros.messages import BadMessage
from hectorscope.ros.mounts import BASE_NAMES
from hectorscope.sources._channels import ChannelError, Channels
from hectorscope.sources._link_delays import LinkDelays
from hectorscope.sources._listeners import Listeners
from hectorscope.sources._offers import Event, Malformed, Offer, Payload, Withdrawal
from slam_core.measurements import Transform


class Wire(Protocol):
    """One protocol of live streams. status: why nothing flows right now, with the remedy; empty while it does."""

    @property
    def status(self) -> str: ...

    @property
    def round_trip_s(self) -> float | None:
        """Of the link; 0 where that is not measured, None where messages do not come as they are made."""

    def connections(self) -> Iterator[Iterator[Sequence[Event]]]:
        """What is said over one connection after another, until `close` or the end of the stream."""

    def subscribe(self, offers: Sequence[Offer]) -> None:
        """Ask for channels of this connection. A subscription has the number of its channel."""

    def close(self) -> None:
        """End `connections`, from any thread."""


class LiveSource:
    """Subscribes to what the pipeline uses, as it is offered, over any number of connections.

    Times are those in the messages' headers; the other side's own clock only stands in where a header has none.
    """

    live = True
    span_ns = None

    def __init__(self, uri: str, options: SourceOptions, wire: Wire) -> None:
        self.name = uri
        self._wire = wire
        self._channels = Channels(options)
        self._converter = Converter(self._channels.roles, options)
        self._listeners = Listeners()
        self._delays = LinkDelays()
        self._is_heard = False
        self._lock = threading.Lock()  # `report` is asked for by another thread than the one in `items`

    @property
    def report(self) -> SourceReport:
        """Counters so far; `waiting` while the connection or the laser is missing."""
        with self._lock:
            status, round_trip_s = self._wire.status, self._wire.round_trip_s
            report = self._converter.report
            return replace(
                report,
                warnings=(*report.warnings, *self._listeners.warnings),
                waiting=status or (self._channels.missing() if self._is_heard else ""),
                connected=not status,
                scan_topic=self._channels.roles.scan or "",
                link=None if round_trip_s is None else self._delays.link(time.time_ns(), round_trip_s),
            )

    def items(self) -> Iterator[Item]:
        """Measurements as they arrive, until `close` or the end of the stream."""
        for batches in self._wire.connections():
            with self._lock:
                self._channels.reset()
                self._is_heard = True
            for events in batches:
                with self._lock:
                    items = self._take(events)
                yield from items

    def root(self, time_ns: int) -> tuple[str, Transform]:
        """The frame above the base to which tf leads, and T_root_base; the base itself if tf knows none."""
        with self._lock:
            base, tree = self._converter.mounts.guess_base() or BASE_NAMES[0], self._converter.tree
            root = tree.climb(base)[-1]
            return root, tree.lookup(root, base, time_ns) or Transform()

    def close(self) -> None:
        """Hang up."""
        self._wire.close()

    @property
    def offered(self) -> dict[str, str]:
        """The message types of the robot's topics."""
        with self._lock:
            return self._channels.offered

    def tap(self, listener: MessageListener) -> None:
        """Pass it the static transforms so far, and from now on every message that is used."""
        with self._lock:
            self._listeners.add(listener)

    def untap(self, listener: MessageListener) -> None:
        """It gets nothing any more."""
        with self._lock:
            self._listeners.remove(listener)

    def _take(self, events: Iterable[Event]) -> list[Item]:
        items: list[Item] = []
        is_new = False
        for event in events:
            match event:
                case Payload():
                    items += self._convert(event)
                case Offer():
                    self._channels.add(event)
                    is_new = True
                case Withdrawal():
                    self._channels.remove(event.id)
                    is_new = True
                case Malformed():
                    self._converter.skip(self.name, event.reason)
        if is_new:
            self._subscribe()
        return items

    def _convert(self, payload: Payload) -> list[Item]:
        known = self._channels.decode(payload.subscription)
        if known is None:
            self._converter.skip(self.name, "message of a channel that was not asked for")
            return []
        topic, msgtype, decode = known
        try:
            message = self._channels.message(payload)
            self._listeners.take(message)
            decoded = decode(message.data)
            items = self._converter.convert(topic, msgtype, decoded, payload.received_ns)
        except BadMessage as reason:
            self._converter.skip(topic, str(reason))
            return []
        if stamp_ns := messages.stamp_ns(decoded, 0):
            self._delays.note(topic, stamp_ns, time.time_ns())
        return items

    def _subscribe(self) -> None:
        wanted: list[Offer] = []
        while offers := self._channels.choose():  # a part that a refused channel held may go to another one
            for offer in offers:
                try:
                    self._channels.prepare(offer)
                    wanted.append(offer)
                except ChannelError as reason:
                    self._converter.skip(offer.topic, str(reason))
                    self._channels.refuse(offer)
        if wanted:
            self._converter.assign(self._channels.roles)
            self._wire.subscribe(wanted)
