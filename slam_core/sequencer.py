"""Puts measurements in the order in which they can be used: a scan waits until inertial data covers its sweep."""

from collections import deque
from collections.abc import Iterator

from slam_core.batches import Batches
from slam_core.diagnostics import Diagnostic
from slam_core.measurements import Attitude, Imu, LaserScan, Measurement

# A scan waits no longer than this, in time of the recording, for inertial data that does not come.
PATIENCE_NS = 500_000_000
MOST_WAITING = 100  # scans: more than come in that time, unless their stamps do not count time
TURNS = (Imu, Attitude)  # what measures how the robot turned during a sweep


class Sequencer:
    """Inertial data passes at once; scans wait for it, in their order, while it is flowing.

    At the start every scan waits, since inertial data may be about to begin. Scans and inertial data that may have
    come together wait until their times are known, and all that arrives behind them waits, too.
    """

    def __init__(self) -> None:
        self._scans, self._samples = Batches[LaserScan]("scans"), Batches[Imu]("inertial data")
        self._settled = {LaserScan: deque[LaserScan | Imu](), Imu: deque[LaserScan | Imu]()}
        self._arrived: deque[Measurement | type[LaserScan | Imu]] = deque()  # types stand for those in Batches
        self._waiting: list[LaserScan] = []
        self._covered_ns: int | None = None
        self._newest_ns = 0
        self._hopeful = True

    def push(self, measurement: Measurement) -> list[Measurement]:
        """The measurements that may be processed now that `measurement` has arrived, in order."""
        if not self._arrived and self._is_timed(measurement):
            return self._pass(measurement)
        scans, samples = self._settled[LaserScan], self._settled[Imu]
        if isinstance(measurement, LaserScan):
            scans += self._scans.push(measurement)
            self._arrived.append(LaserScan)
        else:
            scans += self._scans.pass_time(measurement.stamp_ns)
        if isinstance(measurement, Imu):
            samples += self._samples.push(measurement)
            self._arrived.append(Imu)
        else:
            samples += self._samples.pass_time(measurement.stamp_ns)
        if not isinstance(measurement, LaserScan | Imu):
            self._arrived.append(measurement)
        return [each for one in self._timed() for each in self._pass(one)]

    def flush(self) -> list[Measurement]:
        """What still waits, at the end of a recording."""
        self._settled[LaserScan] += self._scans.flush()
        self._settled[Imu] += self._samples.flush()
        passed = [each for one in self._timed() for each in self._pass(one)]
        ready, self._waiting = self._waiting, []
        return passed + list(ready)

    def diagnostics(self, time_ns: int) -> tuple[Diagnostic, ...]:
        """What came together at a time, or a moment before."""
        return self._scans.diagnostics(time_ns) + self._samples.diagnostics(time_ns)

    def _is_timed(self, measurement: Measurement) -> bool:
        """Whether the time of a measurement is known at once, where nothing waits for its own."""
        if isinstance(measurement, Imu):
            return self._samples.passes(measurement)
        return not isinstance(measurement, LaserScan) or self._scans.passes(measurement)

    def _timed(self) -> Iterator[Measurement]:
        """In order of arrival, up to the first whose time is not known yet."""
        while self._arrived:
            first = self._arrived[0]
            if isinstance(first, type):
                if not self._settled[first]:
                    return
                first = self._settled[first].popleft()
            self._arrived.popleft()
            yield first

    def _pass(self, measurement: Measurement) -> list[Measurement]:
        if isinstance(measurement, LaserScan):
            self._waiting.append(measurement)
            set_back = measurement.stamp_ns < self._newest_ns - PATIENCE_NS
            self._newest_ns = measurement.stamp_ns if set_back else max(self._newest_ns, measurement.stamp_ns)
            return self._ready()
        if isinstance(measurement, TURNS):
            self._covered_ns = measurement.stamp_ns
            self._hopeful = True
        return [measurement, *self._ready()] if self._waiting else [measurement]

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
