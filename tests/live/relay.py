"""A relay between a Foxglove server and our source that does to the messages what a bad link or robot does."""

import random
import struct
import threading
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Protocol

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect
from websockets.sync.server import ServerConnection, serve
from websockets.typing import Subprotocol

from hectorscope.sources._foxglove_wire import parse
from hectorscope.sources._offers import Offer, Payload

PROTOCOL = Subprotocol("foxglove.sdk.v1")
LATCHED = "/tf_static"  # sent once, by a transport that repeats it until it has arrived
SCAN = "/scan"
# Behind the head of a frame: four bytes of CDR, or the counter of a ROS 1 header; then seconds and nanoseconds.
_STAMP, _STAMP_AT = struct.Struct("<II"), 13 + 4
LATEST = 3  # messages that overtake one which is late


class Fault(Protocol):
    """What becomes of the messages of one connection."""

    def passed(self, topic: str, frame: bytes) -> list[bytes]:
        """The frames that are passed on in place of this one."""


class Scrambled:
    """Of all messages a share is lost, as many come twice, and as many come late, behind one to three others."""

    def __init__(self, seed: int, share: float) -> None:
        self.did: Counter[str] = Counter()
        self._random, self._share = random.Random(seed), share
        self._late: list[tuple[int, bytes]] = []

    def passed(self, topic: str, frame: bytes) -> list[bytes]:
        """By the next number of the generator."""
        due = [late for left, late in self._late if left == 0]
        self._late = [(left - 1, late) for left, late in self._late if left]
        what = self._random.random() / self._share
        if topic == LATCHED or what >= 3.0:
            return [frame, *due]
        word = ("lost", "doubled", "late")[int(what)]
        self.did[word] += 1
        if word == "late":
            self._late.append((self._random.randrange(LATEST), frame))
        return [frame] * (word == "doubled") * 2 + due


class ClockOff:
    """The robot's clock is ahead of ours by `ahead_s` at the first message, and gains `drift` seconds a second."""

    def __init__(self, ahead_s: float, drift: float) -> None:
        self._ahead_s, self._drift = ahead_s, drift
        self._first_ns: int | None = None
        self._offset_ns = 0

    def passed(self, topic: str, frame: bytes) -> list[bytes]:
        """With the stamp of that clock."""
        if topic == LATCHED:
            return [frame]
        stamp_ns = stamp_of(frame)
        if self._first_ns is None:
            self._first_ns = stamp_ns
            self._offset_ns = time.time_ns() + round(self._ahead_s * 1e9) - stamp_ns
        stamp_ns += self._offset_ns + round(self._drift * (stamp_ns - self._first_ns))
        changed = bytearray(frame)
        _STAMP.pack_into(changed, _STAMP_AT, *divmod(stamp_ns, 10**9))
        return [bytes(changed)]


def stamp_of(frame: bytes) -> int:
    """Nanoseconds in the header of a message of ROS 1 or ROS 2 that begins with one."""
    seconds, nanoseconds = _STAMP.unpack_from(frame, _STAMP_AT)
    return int(seconds) * 10**9 + int(nanoseconds)


class Relay:
    """Passes on what is said. sent: messages that left the server, passed: that reached us, by topic.

    last_scan_ns: the newest stamp of a scan that was passed on.
    """

    def __init__(self, upstream: str, fault: Fault) -> None:
        self.sent: Counter[str] = Counter()
        self.passed: Counter[str] = Counter()
        self.last_scan_ns = 0
        self._upstream, self._fault = upstream, fault
        self._topics: dict[int, str] = {}
        self._server = serve(self._serve, "127.0.0.1", 0, subprotocols=[PROTOCOL], compression=None)
        self.uri = f"ws://127.0.0.1:{self._server.socket.getsockname()[1]}"
        threading.Thread(target=self._server.serve_forever, daemon=True).start()

    def close(self) -> None:
        """Serve nobody any more."""
        self._server.shutdown()

    def _serve(self, ours: ServerConnection) -> None:
        with connect(self._upstream, subprotocols=[PROTOCOL], compression=None, max_size=None) as robot:
            asked = threading.Thread(target=self._ask, args=(ours, robot), daemon=True)
            asked.start()
            with suppress(ConnectionClosed):
                for frame in robot:
                    for each in self._frames(frame):
                        ours.send(each)

    def _ask(self, ours: ServerConnection, robot: ClientConnection) -> None:
        with suppress(ConnectionClosed):
            for request in ours:
                robot.send(request)
        robot.close()

    def _frames(self, frame: str | bytes) -> Sequence[str | bytes]:
        """What becomes of a frame of the server."""
        for event in parse(frame):
            if isinstance(event, Offer):
                self._topics[event.id] = event.topic
            if isinstance(event, Payload) and isinstance(frame, bytes):
                topic = self._topics[event.subscription]
                frames = self._fault.passed(topic, frame)
                for each in frames:
                    self._count(each)
                self.sent[topic] += 1  # the last: whoever sees it sees what became of it
                return frames
        return [frame]

    def _count(self, frame: bytes) -> None:
        topic = self._topics[int.from_bytes(frame[1:5], "little")]
        self.passed[topic] += 1
        if topic == SCAN:
            self.last_scan_ns = max(self.last_scan_ns, stamp_of(frame))


@contextmanager
def relayed(upstream: str, fault: Fault) -> Iterator[Relay]:
    """A relay that is closed in any case."""
    relay = Relay(upstream, fault)
    try:
        yield relay
    finally:
        relay.close()
