"""The answer of `hectorscope inspect` laid out for a terminal."""

import math
from collections.abc import Iterator, Sequence
from datetime import UTC, datetime
from typing import TYPE_CHECKING

from hectorscope.checks.beam_times import BeamTimes
from hectorscope.checks.findings import remedy
from hectorscope.checks.sensor_statistics import Measures
from hectorscope.inputs import Finding, SourceReport
from slam_core.config import ScanConfig

if TYPE_CHECKING:
    from hectorscope.checks.inspect import BagReport, TopicLine

Row = tuple[str, ...]


def _date(time_ns: int) -> str:
    """A time for people; as it is where no calendar has it."""
    try:
        return f"{datetime.fromtimestamp(time_ns * 1e-9, UTC):%Y-%m-%d %H:%M:%S} UTC"
    except (ValueError, OverflowError, OSError):
        return f"{time_ns} ns, a time of no calendar"


def rendered(report: "BagReport") -> Iterator[str]:
    """Line by line."""
    yield f"{report.name}: {report.container}, {report.duration_s:.1f} s from {_date(report.start_ns)}"
    yield ""
    head = ("topic", "type", "messages", "rate", "longest gap", "jitter", "out of order", "delay", "drift")
    yield from _table([head, *map(_topic_row, report.topics)], right=tuple(range(2, len(head))))
    yield ""
    used: list[Row] = [
        (part.role, part.topic or "-", str(part.measurements or "-"), part.detail) for part in report.parts
    ]
    yield from _table([("part", "played by", "used", ""), *used], right=(2,))
    for title, lines in (
        ("sensors", [*_sensors(report.measures), *_noise(report.range_noise)]),
        ("repaired", [f"{finding.fact}: {finding.repair}" for finding in report.repaired]),
        ("sensor contradictions", list(_wrong(report.findings))),
        ("faults of the recording", [_fault(fault, report.start_ns) for fault in report.faults]),
        ("warnings", report.source.warnings),
        ("notes", report.source.notes),
        ("skipped", _skipped(report.source)),
    ):
        if lines:
            yield from ("", title, *(f"  {line}" for line in lines))


def _topic_row(line: "TopicLine") -> Row:
    def shown(value: float, form: str) -> str:
        return "-" if math.isnan(value) else form.format(value)

    return (
        line.name,
        line.msgtype,
        str(line.messages),
        f"{line.rate_hz:.1f} Hz" if line.rate_hz > 0.0 else "-",
        shown(line.longest_gap_s, "{:.3f} s"),
        shown(1e3 * line.jitter_s, "{:.1f} ms"),
        str(line.backwards),
        shown(line.delay_s, "{:z.3f} s"),
        shown(1e6 * line.drift, "{:z.0f} ppm"),
    )


def _fault(fault: Finding, start_ns: int) -> str:
    """The fact, its time in the run, and what to do."""
    when = "" if fault.time_ns is None else f" (at {(fault.time_ns - start_ns) * 1e-9:.2f} s)"
    return f"{fault.fact}{when}: {fault.remedy}"


def _sensors(measures: Measures) -> Iterator[str]:
    """What the data shows of the sensors, right or wrong."""
    measured = measures.gravity
    if measured is not None:
        up = " ".join(f"{part:z.2f}" for part in measured.up)
        yield f"gravity: {measured.norm:.4g}, up is {up} in the base, steady to {measured.steadiness:.2f}"
    for name, turn, is_timed in (
        ("gyroscope against the scans", measures.turn, True),
        ("gyroscope against gravity", measures.tilt, False),
        ("odometry against the scans", measures.wheels, False),
        ("truth against the scans", measures.truth, True),
    ):
        if turn is not None:
            late = f", the scans {turn.lag:z.2f} s late" if is_timed else ""
            yield f"{name}: turns {turn.ratio:z.2f} times as far, correlation {turn.correlation:z.2f}{late}"
    if (times := measures.times) is not None:
        yield _beam_times(times)


def _beam_times(times: BeamTimes) -> str:
    """What the scans of turns show of when their beams are measured."""
    best, stated, sure = times.sweep_s, times.stated_s, "" if times.is_sure else ": not sure"
    if stated:
        given, turned = (times.residual, times.other) if best == stated else (times.other, times.residual)
        return (
            f"order of the beams: mean residual {given:.3f} as stated, {turned:.3f} with the last beam as the"
            f" first{sure}"
        )
    if best:
        return (
            f"no beam timing: the scans fit best as sweeps of {best:.2g} s (mean residual {times.residual:.3f},"
            f" taken at once {times.other:.3f}){sure}"
        )
    return f"no beam timing: the scans fit best as if each was taken at once (mean residual {times.residual:.3f})"


def _noise(known: Sequence[tuple[float, float]]) -> Iterator[str]:
    """What the scans show of the noise of their ranges: near, in the middle and far."""
    if not known:
        return
    shown = sorted({0, len(known) // 2, len(known) - 1})
    at = ", ".join(f"{1e3 * known[i][1]:.0f} mm at {known[i][0]:.2g} m" for i in shown)
    limit = ScanConfig().smooth_noise
    smoothed = (
        f"; where many have more than {1e3 * limit:.0f} mm, they are smoothed" if known[-1][1] > limit else ""
    )
    yield f"noise of the ranges: {at}{smoothed}"


def _wrong(found: tuple[Finding, ...]) -> Iterator[str]:
    yield from (finding.fact for finding in found)
    if found:
        yield f"repair: --repair, or {remedy(found)}"


def _skipped(report: SourceReport) -> list[str]:
    return [f"{count} x {reason}" for reason, count in report.skipped.items()]


def _table(rows: list[Row], right: tuple[int, ...]) -> Iterator[str]:
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    for row in rows:
        cells = (
            c.rjust(w) if i in right else c.ljust(w) for i, (c, w) in enumerate(zip(row, widths, strict=True))
        )
        yield "  ".join(cells).rstrip()
