"""What the replay servers share: the flags of their command line, and messages at their times."""

import argparse
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from rosbags.highlevel import AnyReader
from rosbags.interfaces import Connection

LOOK_S = 0.005


def flags() -> argparse.ArgumentParser:
    """Recording, topics, port, speed, begin and end; a server may add its own."""
    parser = argparse.ArgumentParser()
    parser.add_argument("recording", type=Path)
    parser.add_argument("--topics", nargs="+", required=True)
    parser.add_argument("--port", type=int, default=0)
    parser.add_argument("--speed", type=float, default=1.0)
    parser.add_argument("--begin", type=float, default=0.0, help="seconds after the start of the recording")
    parser.add_argument("--end", type=float, help="seconds after the start of the recording")
    return parser


def wait_for(holds: Callable[[], object]) -> None:
    """Until it does. The test that started this program ends it otherwise."""
    while not holds():
        time.sleep(LOOK_S)


def paced(
    reader: AnyReader, connections: Sequence[Connection], args: argparse.Namespace
) -> Iterator[tuple[Connection, int, bytes]]:
    """Connection, stamp in ns and data of every message, each at its time divided by the speed."""
    if not connections:
        return  # the reader would take all of them
    begin_ns = reader.start_time + round(args.begin * 1e9)
    end_ns = None if args.end is None else reader.start_time + round(args.end * 1e9)
    origin = time.monotonic_ns()
    for connection, stamp_ns, data in reader.messages(connections, start=begin_ns, stop=end_ns):
        ahead_ns = origin + (stamp_ns - begin_ns) / args.speed - time.monotonic_ns()
        if ahead_ns > 0:
            time.sleep(ahead_ns * 1e-9)
        yield connection, stamp_ns, bytes(data)


def stay() -> None:
    """Serve on until the process is killed."""
    while True:
        time.sleep(60.0)
