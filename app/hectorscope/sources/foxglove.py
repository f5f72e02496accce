"""A robot's live topics, by the Foxglove WebSocket protocol that bridges of ROS 1 and ROS 2 speak."""

import threading
from collections.abc import Iterator
from dataclasses import replace

from hectorscope.inputs import Item, SourceOptions, SourceReport
from hectorscope.ros.converter import Converter
from hectorscope.ros.messages import BadMessage
from hectorscope.sources import SourceKind
from hectorscope.sources._foxglove_channels import ChannelError, Channels
from hectorscope.sources._foxglove_link import Link
from hectorscope.sources._foxglove_wire import Malformed, Offer, Payload, Withdrawal, parse, subscribe


class FoxgloveSource:
    """Subscribes to what the pipeline uses, as it is offered, and comes back whenever the connection is lost.

    Times are those in the messages' headers; the server's own clock only stands in where a header has none.
    """

    live = True
    span_ns = None

    def __init__(self, uri: str, options: SourceOptions) -> None:
        self.name = uri
        self._link = Link(uri)
        self._channels = Channels(options)
        self._converter = Converter(self._channels.roles, options)
        self._lock = threading.Lock()  # `report` is asked for by another thread than the one in `items`

    @property
    def report(self) -> SourceReport:
        """Counters so far; `waiting` while the connection or the laser is missing."""
        with self._lock:
            return replace(
                self._converter.report,
                waiting=self._link.status or self._channels.missing(),
                connected=not self._link.status,
                scan_topic=self._channels.roles.scan or "",
            )

    def items(self) -> Iterator[Item]:
        """Measurements as they arrive, over any number of connections, until `close`."""
        for frames in self._link.connections():
            with self._lock:
                self._channels.reset()
            for frame in frames:
                with self._lock:
                    items = self._take(frame)
                yield from items

    def close(self) -> None:
        """Hang up."""
        self._link.close()

    def _take(self, frame: str | bytes) -> list[Item]:
        items: list[Item] = []
        for event in parse(frame):
            match event:
                case Payload():
                    items += self._convert(event)
                case Offer():
                    self._channels.add(event)
                case Withdrawal():
                    self._channels.remove(event.id)
                case Malformed():
                    self._converter.skip(self.name, event.reason)
        if isinstance(frame, str):
            self._subscribe()
        return items

    def _convert(self, payload: Payload) -> list[Item]:
        known = self._channels.decode(payload.subscription)
        if known is None:
            self._converter.skip(self.name, "message of a channel that was not asked for")
            return []
        topic, msgtype, decode = known
        try:
            return self._converter.convert(topic, msgtype, decode(payload.data), payload.received_ns)
        except BadMessage as reason:
            self._converter.skip(topic, str(reason))
            return []

    def _subscribe(self) -> None:
        wanted: list[int] = []
        while offers := self._channels.choose():  # a part that a refused channel held may go to another one
            for offer in offers:
                try:
                    self._channels.prepare(offer)
                    wanted.append(offer.id)
                except ChannelError as reason:
                    self._converter.skip(offer.topic, str(reason))
                    self._channels.refuse(offer)
        if wanted:
            self._converter.assign(self._channels.roles)
            self._link.send(subscribe(wanted))


def _accepts(uri: str) -> bool:
    return "://" in uri


SOURCE = SourceKind(accepts=_accepts, open=FoxgloveSource)
