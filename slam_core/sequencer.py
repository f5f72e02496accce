"""Puts measurements in the order in which they can be used: a scan waits until inertial data covers its sweep."""

from slam_core.batches import Batches
from slam_core.diagnostics import Diagnostic
from slam_core.measurements import Attitude, Imu, LaserScan, Measurement

# A scan waits no longer than this, in time of the recording, for inertial data that does not come.
PATIENCE_NS = 500_000_000
MOST_WAITING = 100  # of a kind: more than come in that time, unless their stamps do not count time
TURNS = (Imu, Attitude)  # what measures how the robot turned during a sweep


class Sequencer:
    """Inertial data passes at once; scans wait for it, in their order, while it is flowing.

    At the start every scan waits, since inertial data may be about to begin. What came together waits, too, until
    its times are known.
    """

    def __init__(self) -> None:
        self._scans, self._samples = Batches[LaserScan]("scans"), Batches[Imu]("inertial data")
        self._waiting: list[LaserScan] = []
        self._behind: list[Measurement] = []
        self._covered_ns: int | None = None
        self._newest_ns = 0
        self._hopeful = True

    def push(self, measurement: Measurement) -> list[Measurement]:
        """The measurements that may be processed now that `measurement` has arrived, in order."""
        if isinstance(measurement, LaserScan):
            self._wait(self._scans.push(measurement))
        else:
            self._wait(self._scans.pass_time(measurement.stamp_ns))
        passed = self._passed(measurement)
        for each in passed:
            if isinstance(each, TURNS):
                self._covered_ns = each.stamp_ns
                self._hopeful = True
        return passed + self._ready() if self._waiting else passed

    def flush(self) -> list[Measurement]:
        """What still waits, at the end of a recording."""
        self._wait(self._scans.flush())
        ready, self._waiting = self._waiting, []
        behind, self._behind = self._behind, []
        return [*self._samples.flush(), *behind, *ready]

    def diagnostics(self, time_ns: int) -> tuple[Diagnostic, ...]:
        """What came together at a time, or a moment before."""
        return self._scans.diagnostics(time_ns) + self._samples.diagnostics(time_ns)

    def _passed(self, measurement: Measurement) -> list[Measurement]:
        """What passes but for scans: while inertial data is held, all else stays behind it."""
        now: list[Measurement] = [] if isinstance(measurement, LaserScan) else [measurement]
        if isinstance(measurement, Imu):
            settled = self._samples.push(measurement)
            now = [settled.pop()] if settled and settled[-1] is measurement else []
        else:
            settled = self._samples.pass_time(measurement.stamp_ns)
        if not settled and self._samples.holds:
            if len(self._behind) < MOST_WAITING:
                self._behind += now
                return []
            settled = self._samples.flush()
        passed, self._behind = [*settled, *self._behind, *now], []
        return passed

    def _wait(self, scans: list[LaserScan]) -> None:
        """Scans whose times are known wait for inertial data."""
        for scan in scans:
            self._waiting.append(scan)
            set_back = scan.stamp_ns < self._newest_ns - PATIENCE_NS
            self._newest_ns = scan.stamp_ns if set_back else max(self._newest_ns, scan.stamp_ns)

    def _ready(self) -> list[Measurement]:
        ready: list[Measurement] = []
        while self._waiting and self._may_go(self._waiting[0]):
            ready.append(self._waiting.pop(0))
        return ready

    def _may_go(self, scan: LaserScan) -> bool:
        if self._covered_ns is not None and self._covered_ns >= scan.end_ns:
            return True
        if scan.stamp_ns - self._newest_ns > PATIENCE_NS:
            return True  # by a clock that was set back since
        if len(self._waiting) > MOST_WAITING:
            return True
        if self._hopeful and self._newest_ns - scan.end_ns > PATIENCE_NS:
            self._hopeful = False
        return not self._hopeful
