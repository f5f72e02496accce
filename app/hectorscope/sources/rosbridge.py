"""A robot's live topics, by the rosbridge protocol that web pages of ROS 1 and ROS 2 use."""

import time
from collections.abc import Iterator, Sequence

from hectorscope.inputs import LinkOptions, SourceOptions
from hectorscope.sources import stream
from hectorscope.sources._live import LiveSource
from hectorscope.sources._offers import Event, Offer
from hectorscope.sources._rosbridge_wire import Conversation, ask_topics, subscribe
from hectorscope.sources._websocket import Link, Peer

ADDRESSES = ("rosbridge://HOST:PORT", "rosbridges://HOST:PORT")
PEER = Peer(
    what="a rosbridge server (port 9090 by default)",
    remedy="start the bridge there (rosbridge_websocket)",
    addresses=ADDRESSES,
)
AGAIN_S = 2.0  # topics are asked for this often: the protocol does not tell of new ones


class RosbridgeWire:
    """The frames of the protocol, over a connection that is made again whenever it is lost."""

    def __init__(self, uri: str, options: LinkOptions | None = None) -> None:
        self._link = Link(uri, PEER, patience=AGAIN_S, options=options)
        self._conversation = Conversation()

    @property
    def status(self) -> str:
        """Why nothing flows right now; empty while connected."""
        return self._link.status or self._conversation.failure

    @property
    def round_trip_s(self) -> float:
        """Of the connection."""
        return self._link.round_trip_s

    def connections(self) -> Iterator[Iterator[Sequence[Event]]]:
        """The events of each connection, frame by frame."""
        for frames in self._link.connections():
            self._conversation = Conversation()
            yield self._events(frames)

    def _events(self, frames: Iterator[str | bytes]) -> Iterator[Sequence[Event]]:
        asked = time.monotonic()
        self._link.send(ask_topics())
        for frame in frames:
            if time.monotonic() - asked >= AGAIN_S:
                asked = time.monotonic()
                self._link.send(ask_topics())
            yield self._conversation.parse(frame)

    def subscribe(self, offers: Sequence[Offer]) -> None:
        """Ask for channels."""
        for offer in offers:
            self._conversation.subscribed(offer)
            self._link.send(subscribe(offer))

    def close(self) -> None:
        """Hang up."""
        self._link.close()


def _open(uri: str, options: SourceOptions) -> LiveSource:
    return LiveSource(uri, options, RosbridgeWire(uri, options.link))


SOURCE = stream(_open, *ADDRESSES)
