"""Faults of the stamps on arrival: late data, scans that stop, and a laser whose clock is set."""

from collections import Counter
from typing import Literal, NamedTuple

from slam_core.diagnostics import Recent
from slam_core.measurements import (
    Attitude,
    GpsPosition,
    GpsVelocity,
    GroundDistance,
    Height,
    Imu,
    LaserScan,
    MagneticField,
    Measurement,
    Odometry,
)

LATE_NS = 150_000_000
LATE_RUN = 3  # in a row: a single one is jitter
STOPPED_NS = 1_000_000_000
# Data that is later, or stops for longer while other data flows, comes by another clock.
CLOCK_NS = 10_000_000_000
NAMES: dict[type, str] = {
    LaserScan: "scans",
    Imu: "inertial data",
    Attitude: "attitudes",
    Odometry: "odometry",
    Height: "heights",
    GroundDistance: "distances to the ground",
    MagneticField: "magnetic fields",
    GpsPosition: "gps positions",
    GpsVelocity: "gps velocities",
}


class Arrival(NamedTuple):
    """One fault. source: what comes late."""

    code: Literal["late", "scans_stopped", "laser_clock_set"]
    source: str = ""


class Arrivals:
    """Takes everything in order of arrival, before it is sorted; one for each run."""

    def __init__(self) -> None:
        self._recent: Recent[Arrival] = Recent()
        self._newest_ns: int | None = None
        self._set_ns: int | None = None
        self._scan_ns: int | None = None
        self._late: Counter[type] = Counter()

    def add(self, measurement: Measurement) -> None:
        """One more."""
        kind = type(measurement)
        end_ns = measurement.end_ns if isinstance(measurement, LaserScan) else measurement.stamp_ns
        behind_ns = 0 if self._newest_ns is None else self._newest_ns - end_ns
        if abs(behind_ns) > CLOCK_NS:
            self._set_ns = end_ns
        if behind_ns <= 0 or behind_ns > CLOCK_NS:
            self._newest_ns = end_ns
        if kind is LaserScan:
            self._add_scan(end_ns)
        if not LATE_NS <= behind_ns <= CLOCK_NS:
            self._late.pop(kind, None)
            return
        self._late[kind] += 1
        if self._late[kind] >= LATE_RUN:
            self._recent.add([Arrival("late", NAMES[kind])], end_ns)

    def _add_scan(self, end_ns: int) -> None:
        last_ns, self._scan_ns = self._scan_ns, end_ns
        if last_ns is None or abs(end_ns - last_ns) < STOPPED_NS:
            return
        by_clock = end_ns < last_ns or (self._set_ns is not None and last_ns < self._set_ns <= end_ns)
        self._recent.add([Arrival("laser_clock_set" if by_clock else "scans_stopped")], end_ns)

    @property
    def faults(self) -> tuple[Arrival, ...]:
        """What is wrong at this moment, or was a moment before."""
        if self._newest_ns is None:
            return ()
        if self._scan_ns is not None and STOPPED_NS < self._newest_ns - self._scan_ns < CLOCK_NS:
            self._recent.add([Arrival("scans_stopped")], self._newest_ns)
        return self._recent.at(self._newest_ns)
