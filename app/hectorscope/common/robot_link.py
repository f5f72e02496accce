"""What the link to a robot is like: clocks, and the rate and latency of each topic."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple


class TopicLink(NamedTuple):
    """A topic of a stream: messages a second, median time from stamp to arrival, time since the last one."""

    rate_hz: float
    latency_s: float
    age_s: float


class RobotLink(NamedTuple):
    """What a link to a robot is like. clock_offset_s: how far its clock is ahead of ours; None before any message.

    round_trip_s: of the link, 0 where its protocol does not measure it.
    """

    clock_offset_s: float | None = None
    round_trip_s: float = 0.0
    topics: Mapping[str, TopicLink] = MappingProxyType({})
