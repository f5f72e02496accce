"""A robot's live topics, by the Foxglove WebSocket protocol that bridges of ROS 1 and ROS 2 speak."""

from collections.abc import Iterator, Sequence

from hectorscope.inputs import LinkOptions, SourceOptions
from hectorscope.sources import stream
from hectorscope.sources._foxglove_wire import SUBPROTOCOLS, parse, subscribe
from hectorscope.sources._live import LiveSource
from hectorscope.sources._offers import Event, Offer
from hectorscope.sources._websocket import Link, Peer

ADDRESSES = ("ws://HOST:PORT", "wss://HOST:PORT")
PEER = Peer(
    what="a Foxglove WebSocket server, such as foxglove_bridge (port 8765 by default)",
    remedy="start the bridge there (foxglove_bridge)",
    addresses=ADDRESSES,
    subprotocols=SUBPROTOCOLS,
)


class FoxgloveWire:
    """The frames of the protocol, over a connection that is made again whenever it is lost."""

    def __init__(self, uri: str, options: LinkOptions | None = None) -> None:
        self._link = Link(uri, PEER, options=options)

    @property
    def status(self) -> str:
        """Why nothing flows right now; empty while connected."""
        return self._link.status

    @property
    def round_trip_s(self) -> float:
        """Of the connection."""
        return self._link.round_trip_s

    def connections(self) -> Iterator[Iterator[Sequence[Event]]]:
        """The events of each connection, frame by frame."""
        return (map(parse, frames) for frames in self._link.connections())

    def subscribe(self, offers: Sequence[Offer]) -> None:
        """Ask for channels."""
        self._link.send(subscribe([offer.id for offer in offers]))

    def close(self) -> None:
        """Hang up."""
        self._link.close()


def _open(uri: str, options: SourceOptions) -> LiveSource:
    return LiveSource(uri, options, FoxgloveWire(uri, options.link))


SOURCE = stream(_open, *ADDRESSES)
