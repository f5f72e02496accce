"""The order of messages whose container has no index."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hectorscope.sources import _recording
from hectorscope.sources._recording import Channel, Raw, by_scanning

CHANNEL, OTHER = (
    Channel("/scan", "sensor_msgs/msg/LaserScan", "ros2"),
    Channel("/imu", "sensor_msgs/msg/Imu", "ros2"),
)


@given(st.lists(st.tuples(st.integers(0, 50), st.booleans())))
def test_messages_come_by_time_whatever_their_order_in_the_file(entries: list[tuple[int, bool]]) -> None:
    """Those of one time as they lie in the file."""
    raws = [Raw(OTHER if other else CHANNEL, ns, bytes([i % 256])) for i, (ns, other) in enumerate(entries)]
    recording = by_scanning(Path("run.bag"), "ROS 1 bag", lambda: iter(raws), "")
    for channels in ([CHANNEL], [CHANNEL, OTHER]):
        wanted = [raw for raw in raws if raw.channel in channels]
        assert list(recording.read(channels)) == sorted(wanted, key=lambda raw: raw.log_ns)


def test_only_late_messages_are_waited_for() -> None:
    """Of a long file that is in order but for one message, no more than it is late by is kept."""
    begun = 0

    def scan() -> object:
        nonlocal begun
        for i in range(1000):
            begun += 1
            yield Raw(CHANNEL, 10 * (i if i != 500 else 495), b"")

    recording = by_scanning(Path("run.bag"), "ROS 1 bag", scan, "")  # type: ignore[arg-type]
    begun = 0
    for count, _ in enumerate(recording.read([CHANNEL])):
        assert begun - count <= 8


def test_one_that_is_very_late_does_not_keep_all_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    """A message of the year 1970 at the end of a long file stays late; no more than the limit waits for it."""
    monkeypatch.setattr(_recording, "MOST_KEPT", 100 * (_recording.OVERHEAD + 10))
    begun = 0

    def scan() -> Iterator[Raw]:
        nonlocal begun
        for i in range(1000):
            begun += 1
            yield Raw(CHANNEL, 10 * i if i != 999 else 0, bytes(10))

    recording = by_scanning(Path("run.bag"), "ROS 1 bag", scan, "")
    begun, times = 0, []
    for count, raw in enumerate(recording.read([CHANNEL])):
        assert begun - count <= 102
        times.append(raw.log_ns)
    assert len(times) == 1000 and times.count(0) == 2
