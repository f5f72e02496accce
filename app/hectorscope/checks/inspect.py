"""What a recording holds and what a run would make of it, found by reading it once as a run does."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

from hectorscope.checks.findings import findings, repairing_options
from hectorscope.checks.inspect_text import rendered
from hectorscope.checks.recording_check import RecordingCheck
from hectorscope.checks.sensor_statistics import Measures, SensorStatistics
from hectorscope.checks.topic_times import FEWEST, TopicTimes
from hectorscope.common.terminal import printable
from hectorscope.inputs import Examinable, Finding, Item, SourceError, SourceOptions, SourceReport
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
class Recorded(Examinable, Protocol):
    """A source that was recorded, and knows what it holds."""

    container: str
    topics: list[Topic]
    roles: Roles


@dataclass(frozen=True, slots=True)
class TopicLine:
    """One topic. rate_hz is 0 or nan with fewer than two messages. nan: not known, as for types of no use.

    jitter_s, delay_s, drift: as of `TopicTimes`. backwards: messages that are stamped before an earlier one.
    """

    name: str
    msgtype: str
    messages: int
    rate_hz: float
    longest_gap_s: float
    jitter_s: float = math.nan
    backwards: int = 0
    delay_s: float = math.nan
    drift: float = math.nan


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
    range_noise: Sequence[tuple[float, float]]
    findings: tuple[Finding, ...]
    repaired: tuple[Finding, ...] = ()
    faults: tuple[Finding, ...] = ()

    def __str__(self) -> str:
        return "\n".join(map(printable, rendered(self)))


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
    statistics = SensorStatistics(with_truth=True)
    counts = dict.fromkeys(_MEASURES.values(), 0)
    first_scan: LaserScan | None = None
    for item in source.items():
        counts[type(item)] += 1
        statistics.take(item)
        if first_scan is None and isinstance(item, LaserScan):
            first_scan = item
    begin_ns, end_ns = source.span_ns
    measures = statistics.measures()
    check = RecordingCheck().take(source.stamped())
    if not check.turns_compare(source, options):
        measures = replace(measures, turn=None)
    return BagReport(
        source.name,
        source.container,
        begin_ns,
        (end_ns - begin_ns) * 1e-9,
        tuple(_topic_lines(source, {topic: times.result for topic, times in check.times.items()})),
        tuple(_part(role, source, counts[kind], first_scan) for role, kind in _MEASURES.items()),
        source.report,
        measures,
        statistics.range_noise(),
        tuple(findings(measures, options)),
        faults=tuple(check.findings_of(source)),
    )


def _topic_lines(source: Recorded, times: Mapping[str, TopicTimes]) -> Iterator[TopicLine]:
    begin_ns, end_ns = source.span_ns or (0, 0)
    for topic in sorted(source.topics, key=lambda topic: topic.name):
        mean_hz = (topic.messages - 1) / max((end_ns - begin_ns) * 1e-9, 1e-9)
        line = TopicLine(topic.name, topic.msgtype, topic.messages, mean_hz, math.nan)
        yield _measured(line, times[topic.name]) if topic.name in times else line


def _measured(line: TopicLine, times: TopicTimes) -> TopicLine:
    clocked = len(times.stamped) >= FEWEST
    return replace(
        line,
        rate_hz=times.rate_hz,
        longest_gap_s=times.longest_gap_s,
        jitter_s=times.jitter_s,
        backwards=len(times.backwards),
        delay_s=times.delay_s,
        drift=times.drift if clocked else math.nan,
    )


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
