"""Messages as they come, which wait while it is not known by which clocks they are stamped."""

from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, NamedTuple

from hectorscope.ros import messages
from hectorscope.ros.clocks import TOGETHER_NS, Clocks
from hectorscope.ros.repairs import Repairs
from hectorscope.ros.roles import SCAN, TF_TYPES, Roles, is_static_tf

MOST_WAITING = 20_000  # messages
MOST_POSTDATED_NS = 5_000_000_000  # transforms are stamped ahead on purpose, so that they hold for a while
MOST_SECONDS = 1e5  # days are told beyond


class Arrival(NamedTuple):
    """A message as it came. receive_ns: when it was recorded or received. own_ns: its stamp, by its own clock."""

    topic: str
    msgtype: str
    message: Any
    receive_ns: int
    own_ns: int

    @property
    def is_transforms(self) -> bool:
        """Whether it is one of tf."""
        return self.msgtype in TF_TYPES


class Arrivals:
    """Knows by which clock each stream of messages is: a topic, or a frame of tf, as each has its publisher.

    own_frame: whose transforms come from here.
    """

    def __init__(self, roles: Roles, repairs: Repairs, own_frame: str | None) -> None:
        self._repairs, self._own_frame = repairs, own_frame
        self._clocks = Clocks(roles.scan)
        self._waiting: deque[Arrival] = deque()
        self.assign(roles)

    def assign(self, roles: Roles) -> None:
        """The topics of `roles` from now on."""
        self._clocks.lead = roles.scan
        stated = dict.fromkeys((roles.imu, roles.attitude, roles.magnetic), self._repairs.imu_delay_ns)
        self._delays_ns = {**stated, roles.scan: self._repairs.scan_delay_ns}

    def push(self, arrival: Arrival) -> Iterable[Arrival]:
        """The messages that need not wait any more, now that one more has come."""
        if not arrival.is_transforms:
            self._note(arrival)
        elif not is_static_tf(arrival.topic):
            self._note_frames(arrival)
        waits = self._clocks.waits and len(self._waiting) < MOST_WAITING
        if not (waits or self._waiting):
            return (arrival,)
        self._waiting.append(arrival)
        return () if waits else self._passed()

    def flush(self) -> Iterator[Arrival]:
        """Those that still wait, at the end."""
        if self._clocks.waits:
            self._clocks.settle()
        return self._passed()

    def stamp_ns(self, arrival: Arrival) -> int:
        """The message's time by the clock of the scans."""
        return arrival.own_ns + self._clocks.shift_ns(arrival.topic)

    def frame_stamp_ns(self, arrival: Arrival, stamped: Any) -> int:
        """The time of one transform of a message of tf, by the clock of the scans."""
        shift_ns = self._clocks.shift_ns(_stream(arrival.topic, stamped))
        return messages.stamp_ns(stamped, arrival.receive_ns) + shift_ns

    @property
    def put_right(self) -> tuple[str, ...]:
        """The streams whose clocks are apart from that of the scans."""
        return tuple(self._clocks.shifts_ns)

    def warnings(self) -> tuple[str, ...]:
        """The same for people: a sentence for each clock."""
        clocks: list[tuple[int, list[str]]] = []
        for name, shift_ns in self._clocks.shifts_ns.items():
            known = next((names for ns, names in clocks if abs(ns - shift_ns) < TOGETHER_NS), None)
            if known is None:
                clocks.append((shift_ns, [name]))
            else:
                known.append(name)
        return tuple(_words(names, shift_ns) for shift_ns, names in clocks)

    def _passed(self) -> Iterator[Arrival]:
        while self._waiting:
            yield self._waiting.popleft()

    def _note(self, arrival: Arrival) -> None:
        stamp_ns = arrival.own_ns - self._delays_ns.get(arrival.topic, 0)
        lasts_ns = self._repairs.sweep_ns(messages.sweep_ns(arrival.message)) if arrival.msgtype == SCAN else 0
        self._clocks.note(arrival.topic, stamp_ns, lasts_ns, arrival.receive_ns)

    def _note_frames(self, arrival: Arrival) -> None:
        for stamped in arrival.message.transforms:
            if messages.frame_id(stamped) != self._own_frame:
                stamp_ns = messages.stamp_ns(stamped, arrival.receive_ns)
                name = _stream(arrival.topic, stamped)
                self._clocks.note(name, stamp_ns, 0, arrival.receive_ns, MOST_POSTDATED_NS)


def _words(names: Sequence[str], shift_ns: int) -> str:
    apart_s = abs(shift_ns) * 1e-9
    apart = f"{apart_s:.2f} s" if apart_s < MOST_SECONDS else f"{apart_s / 86400.0:.4g} days"
    return (
        f"the clock of {', '.join(names)} is {apart} {'behind' if shift_ns > 0 else 'ahead of'} that of the scans:"
        " stamps are put right by when messages came; keep the clocks together by NTP or PTP"
    )


def _stream(topic: str, stamped: Any) -> str:
    return f"{topic} {stamped.child_frame_id.strip('/')}"
