"""What the stamps tell on arrival: data that comes late, scans that stop, and a laser whose clock is set."""

from collections import Counter

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
from slam_core.navigation.monitor import Recent

LATE_NS = 150_000_000
LATE_RUN = 3  # in a row: a single one is jitter
STOPPED_NS = 1_000_000_000
# No data is so late, nor stops for so long while other data flows: it is by another clock.
CLOCK_NS = 10_000_000_000
STOPPED = "no scan came for over a second: the pose is carried on without the laser; check it and its link"
SET = "the clock of the laser was set: the motion meanwhile is unknown; restart if the pose is wrong"
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
LATE = "{} come over 0.15 s after data of the same time: used at their own time, but shown late; check the link"


class Arrivals:
    """Takes everything in order of arrival, before it is sorted; one for each run."""

    def __init__(self) -> None:
        self._recent = Recent()
        self._newest_ns: int | None = None
        self._set_ns: int | None = None
        self._scan_ns: int | None = None
        self._late: Counter[type] = Counter()

    def take(self, measurement: Measurement) -> None:
        """One more."""
        kind = type(measurement)
        end_ns = measurement.end_ns if isinstance(measurement, LaserScan) else measurement.stamp_ns
        behind_ns = 0 if self._newest_ns is None else self._newest_ns - end_ns
        if abs(behind_ns) > CLOCK_NS:
            self._set_ns = end_ns
        if behind_ns <= 0 or behind_ns > CLOCK_NS:
            self._newest_ns = end_ns
        if kind is LaserScan:
            self._scan(end_ns)
        if not LATE_NS <= behind_ns <= CLOCK_NS:
            self._late.pop(kind, None)
            return
        self._late[kind] += 1
        if self._late[kind] >= LATE_RUN:
            self._recent.tell([LATE.format(NAMES[kind])], end_ns)

    def _scan(self, end_ns: int) -> None:
        last_ns, self._scan_ns = self._scan_ns, end_ns
        if last_ns is None or abs(end_ns - last_ns) < STOPPED_NS:
            return
        by_clock = end_ns < last_ns or (self._set_ns is not None and last_ns < self._set_ns <= end_ns)
        self._recent.tell([SET if by_clock else STOPPED], end_ns)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is wrong at this moment, or was a moment before."""
        if self._newest_ns is None:
            return ()
        if self._scan_ns is not None and STOPPED_NS < self._newest_ns - self._scan_ns < CLOCK_NS:
            self._recent.tell([STOPPED], self._newest_ns)
        return self._recent.at(self._newest_ns)
