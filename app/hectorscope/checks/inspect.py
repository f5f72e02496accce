"""What a recording holds and what a run would make of it, found by reading it once as a run does."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from itertools import pairwise
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

from hectorscope.checks.findings import findings, remedy, repairing_options
from hectorscope.checks.sensor_statistics import Measures, SensorStatistics
from hectorscope.common.terminal import printable
from hectorscope.inputs import Finding, Item, Source, SourceError, SourceOptions, SourceReport
from hectorscope.ros.roles import Roles, Topic
from hectorscope.sources import open_source
from hectorscope.sources.bag import SOURCE as BAG
from hectorscope.sources.bag import open_bag
from slam_core.geometry import to_euler
from slam_core.measurements import (
    Attitude,
    GpsPosition,
    GpsVelocity,
    GroundDistance,
    Height,
    Imu,
    LaserScan,
    MagneticField,
    Odometry,
    TruthPose,
)

_Row = tuple[str, ...]
_MEASURES: Mapping[str, type[Item]] = {
    "scan": LaserScan,
    "imu": Imu,
    "attitude": Attitude,
    "odometry": Odometry,
    "height": Height,
    "ground": GroundDistance,
    "magnetic": MagneticField,
    "gps": GpsPosition,
    "gps_velocity": GpsVelocity,
    "truth": TruthPose,
}


@runtime_checkable
class Recorded(Source, Protocol):
    """A source that was recorded, and knows what it holds."""

    container: str
    topics: list[Topic]
    roles: Roles

    def log_times_ns(self) -> dict[str, list[int]]:
        """When the messages of each topic of use were recorded."""


@dataclass(frozen=True, slots=True)
class TopicLine:
    """One topic. rate_hz is 0 or nan with fewer than two messages, longest_gap_s nan for a type of no use."""

    name: str
    msgtype: str
    messages: int
    rate_hz: float
    longest_gap_s: float


@dataclass(frozen=True, slots=True)
class Part:
    """What plays one part: the topic (None: nothing does), the measurements it gives, and words on them."""

    role: str
    topic: str | None
    measurements: int
    detail: str = ""


@dataclass(frozen=True, slots=True)
class BagReport:
    """The answer of `hectorscope inspect`; as a string it is laid out for a terminal."""

    name: str
    container: str
    start_ns: int
    duration_s: float
    topics: tuple[TopicLine, ...]
    parts: tuple[Part, ...]
    source: SourceReport
    measures: Measures
    findings: tuple[Finding, ...]
    repaired: tuple[Finding, ...] = ()

    def __str__(self) -> str:
        return "\n".join(map(printable, _render(self)))


def inspect_bag(path: Path, options: SourceOptions, *, repair: bool = False) -> BagReport:
    """Read a recording without mapping; SourceError if it cannot be read. A bag without a laser is welcome.

    repair: read it again with what is wrong put right.
    """
    report = _inspected(path, options)
    if not (repair and report.findings):
        return report
    changed: dict[str, Any] = repairing_options(report.findings)
    return replace(_inspected(path, replace(options, **changed)), repaired=report.findings)


def _inspected(path: Path, options: SourceOptions) -> BagReport:
    source = open_bag(path, options) if BAG.accepts(str(path)) else open_source(str(path), options)
    if not isinstance(source, Recorded) or source.span_ns is None:
        raise SourceError(f"{path} is no recording: give one")
    evidence = SensorStatistics()
    counts = dict.fromkeys(_MEASURES.values(), 0)
    first_scan: LaserScan | None = None
    for item in source.items():
        counts[type(item)] += 1
        evidence.take(item)
        if first_scan is None and isinstance(item, LaserScan):
            first_scan = item
    begin_ns, end_ns = source.span_ns
    measures = evidence.measures()
    return BagReport(
        source.name,
        source.container,
        begin_ns,
        (end_ns - begin_ns) * 1e-9,
        tuple(_topic_lines(source)),
        tuple(_part(role, source, counts[kind], first_scan) for role, kind in _MEASURES.items()),
        source.report,
        measures,
        tuple(findings(measures, options)),
    )


def _topic_lines(source: Recorded) -> Iterator[TopicLine]:
    times = source.log_times_ns()
    begin_ns, end_ns = source.span_ns or (0, 0)
    for topic in sorted(source.topics, key=lambda topic: topic.name):
        mean_hz = (topic.messages - 1) / max((end_ns - begin_ns) * 1e-9, 1e-9)
        rate_hz, gap_s = _rhythm(times[topic.name]) if topic.name in times else (mean_hz, math.nan)
        yield TopicLine(topic.name, topic.msgtype, topic.messages, rate_hz, gap_s)


def _rhythm(times_ns: list[int]) -> tuple[float, float]:
    """(mean rate, longest gap) of one topic."""
    if len(times_ns) < 2 or times_ns[-1] == times_ns[0]:
        return math.nan, math.nan
    rate_hz = (len(times_ns) - 1) / ((times_ns[-1] - times_ns[0]) * 1e-9)
    return rate_hz, max(b - a for a, b in pairwise(times_ns)) * 1e-9


def _part(role: str, source: Recorded, measurements: int, first_scan: LaserScan | None) -> Part:
    topic: str | None = getattr(source.roles, role)
    if role == "attitude" and topic is None and measurements:
        topic = "/tf"
    detail = _scan_detail(first_scan) if role == "scan" and first_scan is not None else ""
    return Part(role, topic, measurements, detail)


def _scan_detail(scan: LaserScan) -> str:
    n = len(scan.ranges)
    field = math.degrees(abs(scan.angle_increment) * (n - 1))
    sweep = f"sweep {(scan.end_ns - scan.stamp_ns) * 1e-6:.1f} ms" if scan.time_increment else "no beam timing"
    x, y, z = scan.T_base_laser.translation
    angles = (math.degrees(angle) for angle in to_euler(scan.T_base_laser.rotation))
    mount = f"{x:z.3f} {y:z.3f} {z:z.3f} m, " + " ".join(f"{angle:z.1f}" for angle in angles) + "°"
    return f"{n} beams over {field:.0f}°, {scan.range_min:g} to {scan.range_max:g} m, {sweep}, mount {mount}"


def _date(time_ns: int) -> str:
    """A time for people; as it is where no calendar has it."""
    try:
        return f"{datetime.fromtimestamp(time_ns * 1e-9, UTC):%Y-%m-%d %H:%M:%S} UTC"
    except (ValueError, OverflowError, OSError):
        return f"{time_ns} ns, a time of no calendar"


def _render(report: BagReport) -> Iterator[str]:
    yield f"{report.name}: {report.container}, {report.duration_s:.1f} s from {_date(report.start_ns)}"
    yield ""
    rows: list[_Row] = [("topic", "type", "messages", "rate", "longest gap")]
    for line in report.topics:
        rate = f"{line.rate_hz:.1f} Hz" if line.rate_hz > 0.0 else "-"
        gap = "-" if math.isnan(line.longest_gap_s) else f"{line.longest_gap_s:.3f} s"
        rows.append((line.name, line.msgtype, str(line.messages), rate, gap))
    yield from _table(rows, right=(2, 3, 4))
    yield ""
    used: list[_Row] = [
        (part.role, part.topic or "-", str(part.measurements or "-"), part.detail) for part in report.parts
    ]
    yield from _table([("part", "played by", "used", ""), *used], right=(2,))
    for title, lines in (
        ("devices", list(_devices(report.measures))),
        ("repaired", [f"{finding.fact}: {finding.repair}" for finding in report.repaired]),
        ("wrong with them", list(_wrong(report.findings))),
        ("warnings", report.source.warnings),
        ("notes", report.source.notes),
        ("skipped", _skipped(report.source)),
    ):
        if lines:
            yield from ("", title, *(f"  {line}" for line in lines))


def _devices(measures: Measures) -> Iterator[str]:
    """What the data shows of the sensors, right or wrong."""
    felt = measures.gravity
    if felt is not None:
        up = " ".join(f"{part:z.2f}" for part in felt.up)
        yield f"gravity: {felt.norm:.4g}, up is {up} in the base, steady to {felt.steadiness:.2f}"
    for name, turn in (
        ("gyroscope against the scans", measures.turn),
        ("gyroscope against gravity", measures.tilt),
        ("odometry against the scans", measures.wheels),
    ):
        if turn is not None:
            late = f", the scans {turn.lag:z.2f} s late" if turn is measures.turn else ""
            yield f"{name}: turns {turn.ratio:z.2f} times as far, correlation {turn.correlation:z.2f}{late}"


def _wrong(found: tuple[Finding, ...]) -> Iterator[str]:
    yield from (finding.fact for finding in found)
    if found:
        yield f"repair: --repair, or {remedy(found)}"


def _skipped(report: SourceReport) -> list[str]:
    return [f"{count} x {reason}" for reason, count in report.skipped.items()]


def _table(rows: list[_Row], right: tuple[int, ...]) -> Iterator[str]:
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    for row in rows:
        cells = (
            c.rjust(w) if i in right else c.ljust(w) for i, (c, w) in enumerate(zip(row, widths, strict=True))
        )
        yield "  ".join(cells).rstrip()
