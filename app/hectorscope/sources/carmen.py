"""CARMEN logs, as text or packed: each FLASER line holds a scan and where the wheels took the robot by then.

FLASER n range_1 .. range_n  x y yaw  x y yaw by the wheels  time  host  time since the start of the log
"""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from hectorscope.inputs import SourceError, SourceOptions, SourceReport
from hectorscope.ros.roles import NOTHING
from hectorscope.sources import SourceKind
from hectorscope.sources._text_log import NOT_LATER, BadLine, Instant, Lines, TextLog, floats
from slam_core import geometry
from slam_core.measurements import FARTHEST_LASER, Float32s, LaserScan, Transform

SUFFIXES = (".clf", ".log", ".carmen")
CONTAINER = "CARMEN log"
NO_RETURN = 80.0  # m: what came back from nowhere is written as 81.9 and the like
MOST_BEAMS = 20_000


class _Line:
    """One FLASER line in numbers. pose, wheels: (3,) x, y, yaw."""

    def __init__(self, words: list[str]) -> None:
        if words[:1] != ["FLASER"]:
            raise BadLine("no FLASER")
        n = int(words[1])
        if not 2 <= n <= MOST_BEAMS:
            raise BadLine("FLASER with no scan")
        values = floats(words[2:], n + 7)
        self.ranges = values[:n].astype(np.float32)
        self.pose, self.wheels = values[n : n + 3], values[n + 3 : n + 6]
        self.stamp_ns = round(values[n + 6] * 1e9)


class _Parser:
    """Lines to instants; remembers where the laser sits."""

    def __init__(self) -> None:
        self._laser = Transform()

    def __call__(self, line: str) -> Instant | None:
        words = line.split()
        if words[:2] == ["PARAM", "robot_frontlaser_offset"]:
            (forward,) = floats(words[2:], 1)
            if abs(forward) > FARTHEST_LASER:
                raise BadLine(f"laser more than {FARTHEST_LASER:g} m from the base")
            self._laser = Transform(np.array([forward, 0.0, 0.0]))
        if words[:1] != ["FLASER"]:
            return None
        parsed = _Line(words)
        ranges = np.where(parsed.ranges < NO_RETURN, parsed.ranges, np.float32(np.inf))
        first, step = _fan(len(ranges))
        scan = LaserScan(parsed.stamp_ns, ranges, first, step, range_max=NO_RETURN, T_base_laser=self._laser)
        return Instant(scan, parsed.wheels)


class CarmenLog(TextLog):
    """A log; its truth is another one, in which somebody corrected the poses of some of the same scans."""

    def __init__(self, uri: str, options: SourceOptions) -> None:
        super().__init__(Path(uri), CONTAINER, _Parser(), options)
        if options.truth_topic not in (None, NOTHING):
            self.roles = replace(self.roles, truth=options.truth_topic)
            self.truth = self._corrected(Path(str(options.truth_topic)))

    @property
    def report(self) -> SourceReport:
        """With a hint where the stamps are those of a corrected log, which hardly grow."""
        report = super().report
        if (still := report.skipped.get(NOT_LATER, 0)) <= len(self.instants):
            return report
        hint = (
            f"{still} scans of {self.name} have no time of their own: it looks like a corrected log, to be given"
        )
        return replace(report, notes=(*report.notes, f"{hint} as --truth of the log that was recorded"))

    def _corrected(self, path: Path) -> dict[int, Transform]:
        """Poses of the base at the times of this log's scans: the other log's times are seldom of use."""
        scans = {_fingerprint(instant.scan.ranges): instant.scan for instant in self.instants}
        truth: dict[int, Transform] = {}
        for line in Lines(path):
            try:
                pose = _Line(line.split())
            except (BadLine, ValueError, IndexError):
                continue
            scan = scans.get(_fingerprint(pose.ranges))
            if scan is not None:
                laser = Transform(np.array([*pose.pose[:2], 0.0]), geometry.yaw_quaternion(pose.pose[2]))
                truth[scan.stamp_ns] = geometry.chain(laser, geometry.invert(scan.T_base_laser))
        if not truth:
            raise SourceError(f"{path} has no pose for a scan of {self.name}: give its own corrected log")
        return truth


def _fingerprint(ranges: Float32s) -> bytes:
    """The same for the same scan, however its numbers are written."""
    return np.round(100.0 * np.minimum(ranges, NO_RETURN)).astype(np.int32).tobytes()


def _fan(beams: int) -> tuple[float, float]:
    """Angle of the first beam and the step, radians: half a turn, of which an even number leaves out the end."""
    steps = beams - beams % 2
    return -math.pi / 2, math.pi / steps


def _accepts(uri: str) -> bool:
    path = Path(uri.removesuffix(".gz"))
    return "://" not in uri and path.suffix in SUFFIXES


SOURCE = SourceKind(_accepts, CarmenLog, (*SUFFIXES, *(f"{suffix}.gz" for suffix in SUFFIXES)))
