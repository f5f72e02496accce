"""Figures of the run for monitors, in the text format of Prometheus."""

from collections.abc import Iterable, Iterator, Mapping
from importlib.metadata import version
from typing import get_args

from hectorscope.page.static_files import File
from hectorscope.session.snapshot import PlaybackState, Snapshot
from slam_core.results import Tracking

METRICS = "/metrics"
KIND = "text/plain; version=0.0.4; charset=utf-8"
MOST_REASONS = 50

Sample = tuple[Mapping[str, str], float]


def metrics(snapshot: Snapshot | None, browsers: int) -> File:
    """All of them at this moment."""
    lines = (line for family in families(snapshot or Snapshot(), browsers) for line in text(*family))
    return File(KIND, ("\n".join(lines) + "\n").encode())


def families(now: Snapshot, browsers: int) -> Iterator[tuple[str, str, str, Iterable[Sample]]]:
    """Name without the prefix, type, help, samples: labels and value."""
    report, playback, result = now.report, now.playback, now.result
    yield "build_info", "gauge", "The version of the program.", [({"version": version("hectorscope")}, 1.0)]
    yield "browsers", "gauge", "Browsers that show the page.", [({}, browsers)]
    yield "scans_total", "counter", "Scans of the run that gave a result.", [({}, now.scans)]
    yield "map_updates_total", "counter", "Scans that were written into the map.", [({}, now.map_updates)]
    yield (
        "scans_dropped_total",
        "counter",
        "Scans given up because the pipeline was too slow.",
        [({}, report.dropped)],
    )
    reasons = list(report.skipped.items())[:MOST_REASONS]
    yield (
        "messages_skipped_total",
        "counter",
        "Messages that were not used.",
        [({"reason": why}, count) for why, count in reasons],
    )
    yield (
        "messages_read_total",
        "counter",
        "Messages that were read.",
        [({"topic": topic}, count) for topic, count in report.read.items()],
    )
    yield "scan_rate_hertz", "gauge", "Scans that are processed each second.", [({}, playback.scan_rate)]
    yield "last_scan_timestamp_seconds", "gauge", "Stamp of the last scan.", [({}, playback.time_ns / 1e9)]
    if report.connected is not None:
        yield "robot_connected", "gauge", "Whether there is a link to the robot.", [({}, report.connected)]
    if (link := report.link) is not None and link.clock_offset_s is not None:
        ahead = "How far the clock of the robot is ahead."
        yield "robot_clock_offset_seconds", "gauge", ahead, [({}, link.clock_offset_s)]
        late = [({"topic": name}, topic.latency_s) for name, topic in link.topics.items()]
        yield "topic_latency_seconds", "gauge", "From the stamp of a message to its arrival, the median.", late
    yield "warnings", "gauge", "What is wrong at this moment.", [({}, len(now.warnings))]
    yield "recorded_bytes_total", "counter", "Recorded of the stream.", [({}, now.station.recorded)]
    yield "state", "gauge", "1 for the state of the run.", one_hot(get_args(PlaybackState), playback.state)
    tracking = result.tracking if result else None
    yield "tracking", "gauge", "1 for the state of the pose.", one_hot(get_args(Tracking), tracking)


def one_hot(words: Iterable[str], word: str | None) -> list[Sample]:
    """A sample for each state, of which one is 1."""
    return [({"state": each}, each == word) for each in words]


def text(name: str, kind: str, help_: str, samples: Iterable[Sample]) -> Iterator[str]:
    """The lines of one metric."""
    full = f"hectorscope_{name}"
    yield f"# HELP {full} {help_}"
    yield f"# TYPE {full} {kind}"
    for labels, value in samples:
        inside = ",".join(f'{label}="{escaped(word)}"' for label, word in labels.items())
        yield f"{full}{{{inside}}} {float(value)!r}" if inside else f"{full} {float(value)!r}"


def escaped(word: str) -> str:
    """As the value of a label."""
    return word.replace("\\", r"\\").replace('"', r"\"").replace("\n", r"\n")
