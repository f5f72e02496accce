"""A live run through faults of the robot, the link, or the server before us, each against the truth.

    python -m benchmarks.faults [--seconds 30]

A drive through the arena, 361 beams at 20 Hz (at 100 Hz where there are too many scans), is replayed on a real
Foxglove server in a process of its own. Between it and the run stands a relay that loses, doubles and delays
messages, or sets their stamps by another clock; or the server is killed. Prints the error of the last pose, and
what became of the scans. It ends with an error where those that came are not the sum of those used, dropped and
skipped.
"""

import argparse
import tempfile
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

from benchmarks.tables import table
from hectorscope.panels._truth_error import truth_error
from hectorscope.run.settings import Settings
from hectorscope.run.warmup import load_everything
from hectorscope.session.snapshot import Snapshot
from hectorscope.simulation import SimulateOptions, simulate
from tests.engines import running, until
from tests.live.conftest import started
from tests.live.measurements import TOPICS, opened
from tests.live.relay import SCAN, ClockOff, Fault, Scrambled, relayed

SHARE = 0.1  # of the messages: lost, as many doubled, and as many late
AHEAD_S, DRIFT = 3600.0, 0.05 / 60.0  # seconds; seconds a second
SEED = 1
TOO_MANY_HZ, TOO_FAST = 100.0, 30.0  # of the laser; times real time
KILLS = 10
LAST_S = 0.5  # at the end of the drive, of which no scan may come
BACKLOG = ("--backlog", "1000000")  # of the server, which else drops by itself
GAP_S = 0.2  # of the drive that is missed at each kill
PATIENCE_S = 120.0
HEAD = ("fault", "error of the last pose", "scans that came", "used", "dropped", "skipped", "errors")


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of a run. error_m: of the last pose, in the plane. covered_s: from the first pose to the last.

    given: messages that reached us by topic, where the relay has counted them. read, skipped, dropped: as in a
    SourceReport. used: scans with a result. failures: errors in the log of the page. clock_s: how far the robot's
    clock is said to be ahead.
    """

    error_m: float
    covered_s: float
    given: Mapping[str, int]
    read: Mapping[str, int]
    skipped: Mapping[str, int]
    dropped: int
    used: int
    failures: tuple[str, ...]
    clock_s: float | None


def drive(folder: Path, seconds: float, scan_rate: float = 20.0) -> Path:
    """A drive through the arena."""
    path = folder / f"drive_{scan_rate:g}.mcap"
    if not path.exists():
        simulate(SimulateOptions(scenario="arena", duration=seconds, scan_rate=scan_rate, beams=361, out=path))
    return path


def scrambled(folder: Path, seconds: float) -> Outcome:
    """Messages are lost, doubled and late."""
    return _relayed(drive(folder, seconds), Scrambled(SEED, SHARE))


def clock_off(folder: Path, seconds: float) -> Outcome:
    """The robot's clock is ahead, and gains."""
    return _relayed(drive(folder, seconds), ClockOff(AHEAD_S, DRIFT))


def too_many(folder: Path, seconds: float) -> Outcome:
    """Scans come faster than they can be processed."""
    recording = drive(folder, seconds, TOO_MANY_HZ)
    given = Counter(_topics(recording))
    server = started(recording, *TOPICS, "--speed", str(TOO_FAST), *BACKLOG)
    try:
        with opened(server.uri) as source, running(source, Settings()) as engine:
            now = until(engine, lambda now: now.report.read == given and is_settled(now), PATIENCE_S)
    finally:
        server.kill()
    return outcome(now, given)


def killed(folder: Path, seconds: float, kills: int = KILLS) -> Outcome:
    """The server is killed while it sends, and another one takes its place, so many times."""
    recording, piece = drive(folder, seconds), seconds / (kills + 1)
    server = started(recording, *TOPICS)
    port = ("--port", str(server.port))
    try:
        with opened(server.uri) as source, running(source, Settings()) as engine:
            begin_ns = until(engine, lambda now: now.scans, PATIENCE_S).playback.start_ns
            for begin in (piece * number for number in range(1, kills + 1)):
                ends_ns = begin_ns + round((begin - GAP_S) * 1e9)
                until(engine, reached(ends_ns), PATIENCE_S)
                server.kill()
                server = started(recording, *TOPICS, *port, "--begin", str(begin))
            until(engine, reached(begin_ns + round((seconds - LAST_S) * 1e9)), PATIENCE_S)
            now = until(engine, is_settled, PATIENCE_S)
    finally:
        server.kill()
    return outcome(now, {})


def _relayed(recording: Path, fault: Fault) -> Outcome:
    given = Counter(_topics(recording))
    server = started(recording, *TOPICS)
    try:
        with (
            relayed(server.uri, fault) as relay,
            opened(relay.uri) as source,
            running(source, Settings()) as engine,
        ):
            until(engine, lambda _: relay.sent == given, PATIENCE_S)
            now = until(engine, lambda now: now.report.read == relay.passed and is_settled(now), PATIENCE_S)
    finally:
        server.kill()
    return outcome(now, relay.passed)


def reached(time_ns: int) -> Callable[[Snapshot], bool]:
    """Whether a run has come so far."""
    return lambda now: now.playback.time_ns >= time_ns


def is_settled(now: Snapshot) -> bool:
    """Whether every scan that was read was used, dropped or skipped."""
    return now.scans + now.report.dropped + scans_skipped(now.report.skipped) == now.report.read.get(SCAN)


def scans_skipped(skipped: Mapping[str, int]) -> int:
    """Those of all reasons that are reasons of scans."""
    return sum(count for why, count in skipped.items() if why.startswith(("scan", SCAN)))


def outcome(now: Snapshot, given: Mapping[str, int]) -> Outcome:
    """The figures of a run."""
    report = now.report
    return Outcome(
        error_m=float(truth_error(now)["error"][-1]),
        covered_s=float(now.trajectory[-1, 0] - now.trajectory[0, 0]),
        given=dict(given),
        read=report.read,
        skipped=report.skipped,
        dropped=report.dropped,
        used=now.scans,
        failures=tuple(entry.text for entry in now.log if entry.level == "error"),
        clock_s=None if report.link is None else report.link.clock_offset_s,
    )


def _topics(recording: Path) -> list[str]:
    """The topic of every message."""
    with AnyReader([recording], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
        return [connection.topic for connection, *_ in reader.messages() if connection.topic in TOPICS]


FAULTS: Mapping[str, Callable[[Path, float], Outcome]] = {
    "10 % lost, 10 % doubled, 10 % late": scrambled,
    "robot's clock an hour ahead, gains 50 ms a minute": clock_off,
    "3000 scans a second": too_many,
    "server killed and started again 10 times": killed,
}


def row(name: str, run: Outcome) -> tuple[str, ...]:
    """Of the table."""
    counts = run.read[SCAN], run.used, run.dropped, scans_skipped(run.skipped)
    return name, f"{1e3 * run.error_m:.1f} mm", *map(str, counts), str(len(run.failures))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=30.0)
    given = parser.parse_args()
    load_everything()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for name, fault in FAULTS.items():
            rows.append(row(name, fault(Path(folder), given.seconds)))
            print(" | ".join(rows[-1]), flush=True)
    print(table(HEAD, rows))


if __name__ == "__main__":
    main()
