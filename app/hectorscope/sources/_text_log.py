"""Text logs of a laser and wheels, one line a time; each format defines its lines."""

import gzip
import zlib
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from hectorscope.common.paths import absence
from hectorscope.inputs import Item, SourceError, SourceOptions, SourceReport, Stamped
from hectorscope.ros.repairs import Repairs
from hectorscope.ros.roles import ODOMETRY, SCAN, Topic, check_overrides, choose_roles
from hectorscope.ros.stamps import AHEAD, Stamps
from slam_core import geometry
from slam_core.measurements import Float64s, LaserScan, Odometry, Transform, TruthPose

# Over a longer step than this the velocity of the wheels is anybody's guess.
LONGEST_STEP_NS = 2_000_000_000


LONGEST_LINE = 2**20  # bytes; a scan of 1081 beams takes 8 KB
LONGEST_LOG = 2**32  # bytes, unpacked: weeks of a laser with 181 beams
NOT_LATER = "scan that is not later than the one before"
SCANS, WHEELS = "scan", "wheels"


class BadLine(Exception):
    """One line that is left out; the text is the reason."""


@dataclass(frozen=True, slots=True, eq=False)
class Instant:
    """A scan, and where the wheels have taken the robot by then: (3,) x, y, yaw in a frame that drifts."""

    scan: LaserScan
    wheels: Float64s


@dataclass
class _Reading:
    """How far a reading has come: lines, and what of the last one is still to be handed out."""

    lines: int = 0
    ready: tuple[Item, ...] = ()


class TextLog:
    """The measurements of a log, in its order; the wheels come as the velocity up to the scan behind them.

    parse: a line's instant, None for a line that holds something else. truth: poses by the times of scans.
    """

    live = False

    def __init__(self, path: Path, container: str, parse: Callable[[str], Instant | None], options: SourceOptions):
        self.name, self.container = path.name, container
        self.truth: dict[int, Transform] = {}
        self._skipped: Counter[str] = Counter()
        lines = Lines(path)
        self.instants = list(self._parsed(lines, parse))
        self._notes = lines.notes
        if not self.instants:
            why = "; ".join(f"{count} x {reason}" for reason, count in self._skipped.items()) or "no line is one"
            raise SourceError(f"{path} holds no scan of a {container} ({why}): give a recording")
        times = [instant.scan.stamp_ns for instant in self.instants]
        self.span_ns = min(times), max(times)  # a clock may have been set back in between
        self.topics = [Topic(name, kind, len(self.instants)) for name, kind in ((SCANS, SCAN), (WHEELS, ODOMETRY))]
        check_overrides(self.topics, replace(options, truth_topic=None))
        self.roles = choose_roles(self.topics, options)
        self._repairs = Repairs(options)
        self._reading = _Reading()
        self._closed = False

    @property
    def report(self) -> SourceReport:
        """Scans read so far, and lines left out."""
        skipped = dict(self._skipped)
        unusable = sum(skipped.values())
        return SourceReport({SCANS: self._reading.lines}, skipped, notes=self._notes, unusable=unusable)

    clock_offset_ns = 0
    unplaced = put_right = ()
    parts: Mapping[str, str] = {"scan": SCANS, "odometry": WHEELS}

    def stamped(self) -> Iterator[Stamped]:
        """Scans and wheels of each line; a log has no other times than theirs."""
        for instant in self.instants:
            scan = instant.scan
            limits = scan.range_min, scan.range_max
            yield Stamped(SCANS, scan.stamp_ns, ranges=scan.ranges, limits=limits)
            yield Stamped(WHEELS, scan.stamp_ns)

    def items(self) -> Iterator[Item]:
        """Wheels, scan and truth of each line."""
        return self._items(_Reading())

    def place(self) -> object:
        """Where the latest reading is."""
        return replace(self._reading)

    def items_from(self, place: object) -> Iterator[Item]:
        """The measurements behind a place."""
        assert isinstance(place, _Reading)
        return self._items(replace(place))

    def again(self) -> "TextLog":
        """A reading of its own of the same lines."""
        other = copy(self)
        other._reading = _Reading()
        return other

    def _items(self, reading: _Reading) -> Iterator[Item]:
        self._reading = reading
        while not self._closed:
            while reading.ready:
                item, reading.ready = reading.ready[0], reading.ready[1:]
                yield item
            if reading.lines == len(self.instants):
                return
            reading.ready = tuple(self._at(reading.lines))
            reading.lines += 1

    def _at(self, line: int) -> Iterator[Item]:
        instant = self.instants[line]
        if line and self.roles.odometry is not None:
            yield from _velocity(self.instants[line - 1], instant)
        scan = self._repaired(instant.scan)
        yield scan
        if instant.scan.stamp_ns in self.truth:
            yield TruthPose(scan.stamp_ns, self.truth[instant.scan.stamp_ns])

    def close(self) -> None:
        """End `items`; no file is open."""
        self._closed = True

    def _repaired(self, scan: LaserScan) -> LaserScan:
        stamp_ns = scan.stamp_ns - self._repairs.scan_delay_ns
        mount = self._repairs.laser_pose or scan.T_base_laser
        return self._repairs.scan(replace(scan, stamp_ns=stamp_ns, T_base_laser=mount))

    def _parsed(self, lines: Iterable[str], parse: Callable[[str], Instant | None]) -> Iterator[Instant]:
        """What the lines hold, in their order; a line that cannot be used is counted."""
        stamps = Stamps(repeats=False)
        for line in lines:
            try:
                instant = parse(line)
                fault = stamps.fault(instant.scan.stamp_ns) if instant is not None else ""
                if fault:
                    raise BadLine(fault if fault == AHEAD else NOT_LATER)
            except (ValueError, IndexError, OverflowError):
                self._skipped["line cut off or without numbers"] += 1
            except BadLine as reason:
                self._skipped[str(reason)] += 1
            else:
                if instant is not None:
                    yield instant


class Lines:
    """The lines of a file, unpacked, up to where it is damaged or too long; `notes` says so after them.

    SourceError without a file. A line that is too long to be one comes in pieces.
    """

    def __init__(self, path: Path) -> None:
        if why := absence(path):
            raise SourceError(f"{path} {why}: check the path")
        self.notes: tuple[str, ...] = ()
        self._path = path

    def __iter__(self) -> Iterator[str]:
        """From the beginning."""
        size, path = 0, self._path
        try:
            with gzip.open(path) if path.suffix == ".gz" else path.open("rb") as file:
                while line := file.readline(LONGEST_LINE):
                    size += len(line)
                    if size > LONGEST_LOG:
                        self.notes = (f"{path.name} holds more than {LONGEST_LOG} bytes: the rest is left out",)
                        return
                    yield line.decode("ascii", "replace")
        except (OSError, EOFError, zlib.error) as error:
            self.notes = (f"{path.name} is cut off or damaged ({error}): read as far as it goes",)


def floats(words: Sequence[str], count: int) -> Float64s:
    """(count,) finite numbers; ValueError if there are fewer."""
    values = np.array(words[:count], np.float64)
    if len(values) < count or not np.isfinite(values).all():
        raise ValueError("numbers are missing")
    return values


def _velocity(before: Instant, now: Instant) -> Iterator[Odometry]:
    """The mean velocity between two instants: it holds from the first one on."""
    step_ns = now.scan.stamp_ns - before.scan.stamp_ns
    if not 0 < step_ns <= LONGEST_STEP_NS:
        return
    forward, left, turn = _mean_twist(before.wheels, now.wheels) / (step_ns * 1e-9)
    yield Odometry(before.scan.stamp_ns, np.array([forward, left]), float(turn))


def _mean_twist(a: Float64s, b: Float64s) -> Float64s:
    """Metres forward and left, and radians, from pose a to pose b, seen from the heading half way."""
    turn = geometry.wrap(b[2] - a[2])
    c, s = np.cos(a[2] + 0.5 * turn), np.sin(a[2] + 0.5 * turn)
    dx, dy = b[:2] - a[:2]
    return np.array([c * dx + s * dy, c * dy - s * dx, turn])
