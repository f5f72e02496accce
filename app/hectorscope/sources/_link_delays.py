"""How long the messages of a robot are on their way, and how far its clock is from ours."""

from collections import deque
from typing import NamedTuple

from hectorscope.common.robot_link import RobotLink, TopicLink

RECENT = 64  # messages of a topic, of which rate and latency are the median
BIN_S, BINS = 10.0, 6  # the fastest message is looked for in the last minute: clocks drift
MOST_TOPICS = 64


class _Arrival(NamedTuple):
    at_s: float
    delay_s: float  # from the stamp, by two clocks


class LinkDelays:
    """Notes when messages come. Times are seconds of our clock.

    What lies between stamp and arrival is the delay less the offset of the robot's clock, and no single message
    tells which is which. The fastest one of a minute is taken to have needed half of the round trip.
    """

    def __init__(self) -> None:
        self._topics: dict[str, deque[_Arrival]] = {}
        self._fastest: deque[tuple[int, float]] = deque(maxlen=BINS)  # number of the bin, its smallest delay

    def note(self, topic: str, stamp_ns: int, at_ns: int) -> None:
        """A message came. stamp_ns: of its header, by the robot's clock."""
        if topic not in self._topics and len(self._topics) == MOST_TOPICS:
            return
        arrival = _Arrival(at_ns / 1e9, (at_ns - stamp_ns) / 1e9)
        self._topics.setdefault(topic, deque(maxlen=RECENT)).append(arrival)
        number = int(arrival.at_s // BIN_S)
        if self._fastest and self._fastest[-1][0] == number:
            number, smallest = self._fastest.pop()
            self._fastest.append((number, min(smallest, arrival.delay_s)))
        else:
            self._fastest.append((number, arrival.delay_s))

    def link(self, now_ns: int, round_trip_s: float) -> RobotLink:
        """As it is by the last messages."""
        newest = now_ns / 1e9 // BIN_S
        fastest = [delay for number, delay in self._fastest if number > newest - BINS]
        if not fastest:
            return RobotLink(round_trip_s=round_trip_s)
        offset_s = round_trip_s / 2 - min(fastest)
        topics = {name: _topic(arrivals, now_ns / 1e9, offset_s) for name, arrivals in self._topics.items()}
        return RobotLink(offset_s, round_trip_s, topics)


def _topic(arrivals: deque[_Arrival], now_s: float, offset_s: float) -> TopicLink:
    delays = sorted(arrival.delay_s for arrival in arrivals)
    spent = arrivals[-1].at_s - arrivals[0].at_s
    rate = (len(arrivals) - 1) / spent if spent > 0.0 else 0.0
    return TopicLink(rate, delays[len(delays) // 2] + offset_s, max(0.0, now_s - arrivals[-1].at_s))
