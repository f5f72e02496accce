"""Recordings that are broken on purpose: a gap, a wrong unit, a slipping clock, each made of a whole one.

    python -m benchmarks.broken demo_bags/arena.bag DIR

docs/broken-recordings.md finds the cause of each; tests/unit/hectorscope/checks/test_recording_check.py does, too.
"""

import argparse
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from rosbags.highlevel import AnyReader

from hectorscope.ros.recorder import Recorder

GAP_FROM_S, GAP_S = 20.0, 1.5
SLIP = 0.004  # seconds a second by which the clock of the scans is slow
STANDARD_GRAVITY = 9.80665

Entry = tuple[str, Any, int]
"""Topic, message, when it was recorded."""
Break = Callable[[Iterator[Entry], int], Iterator[Entry]]
"""What is left of the messages; the number is when the recording begins."""


def gap(entries: Iterator[Entry], begin_ns: int) -> Iterator[Entry]:
    """The disk was full for a while: nothing is there from GAP_FROM_S on for GAP_S seconds."""
    for topic, message, log_ns in entries:
        if not GAP_FROM_S <= (log_ns - begin_ns) * 1e-9 < GAP_FROM_S + GAP_S:
            yield topic, message, log_ns


def unit(entries: Iterator[Entry], begin_ns: int) -> Iterator[Entry]:
    """The accelerometer's driver gives g in the place of m/s²."""
    for topic, message, log_ns in entries:
        if hasattr(message, "linear_acceleration"):
            felt = message.linear_acceleration
            felt.x, felt.y, felt.z = (part / STANDARD_GRAVITY for part in (felt.x, felt.y, felt.z))
        yield topic, message, log_ns


def clock(entries: Iterator[Entry], begin_ns: int) -> Iterator[Entry]:
    """The clock of the laser is slow: its stamps fall behind, more and more."""
    for topic, message, log_ns in entries:
        if hasattr(message, "ranges"):
            stamp = message.header.stamp
            own_ns = stamp.sec * 10**9 + stamp.nanosec - round(SLIP * (log_ns - begin_ns))
            stamp.sec, stamp.nanosec = divmod(own_ns, 10**9)
        yield topic, message, log_ns


BREAKS: dict[str, Break] = {"gap": gap, "unit": unit, "clock": clock}


def make(whole: Path, broken: Path, how: str) -> Path:
    """Write a recording broken as one of BREAKS; its path."""
    return broken_by(BREAKS[how], whole, broken)


def broken_by(how: Break, whole: Path, broken: Path) -> Path:
    """Write a recording broken in any way; its path."""
    with AnyReader([whole]) as reader, Recorder(broken) as recorder:
        entries = ((c.topic, reader.deserialize(raw, c.msgtype), log_ns) for c, log_ns, raw in reader.messages())
        for topic, message, log_ns in how(entries, reader.start_time):
            recorder.write(topic, message, log_ns)
    return broken


def main() -> None:
    """All three into a folder."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("whole", type=Path)
    parser.add_argument("folder", type=Path)
    args = parser.parse_args()
    args.folder.mkdir(parents=True, exist_ok=True)
    for how in BREAKS:
        print(make(args.whole, args.folder / f"{how}.bag", how))


if __name__ == "__main__":
    main()
