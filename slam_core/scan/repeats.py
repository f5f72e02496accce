"""Scans that a driver sends again: each looks like a robot that stands still."""

import math

import numpy as np

from slam_core import geometry
from slam_core.measurements import Float32s, Float64s, LaserScan

STANDS = 0.03  # m/s, rad/s: slower, a scan may be the same as the one before
AWAY = 0.03  # m, rad: further from where a scan was measured, its repetition is wrong also for one that stands
BELIEVED_NS = 1_000_000_000  # for which a robot is taken to drive on, where nothing else measures the motion


class Repeats:
    """Compares each scan with the one before.

    Noise tells two measurements apart. A simulation without it shows the same again while the robot rests.
    """

    def __init__(self) -> None:
        self._ranges = np.empty(0, np.float32)
        self._changed_ns = self._seen_ns = 0
        self._pose = self._first = np.zeros(3)

    def takes(self, scan: LaserScan, pose: Float64s, *, measured: bool) -> bool:
        """Whether a scan repeats the one before although the robot moves.

        pose: (3,) the predicted one. measured: other sensors measure the motion.
        """
        time_ns = scan.mid_ns
        lapse_s, self._seen_ns = (time_ns - self._seen_ns) * 1e-9, time_ns
        before, self._pose = self._pose, pose.copy()
        if not is_copy(scan.ranges, self._ranges):
            self._ranges, self._changed_ns = scan.ranges, time_ns
            return False
        if lapse_s <= 0.0 or not (measured or time_ns - self._changed_ns < BELIEVED_NS):
            return False
        moved = pose - before
        return _length(moved) > STANDS * lapse_s or (measured and _length(pose - self._first) > AWAY)

    def located(self, pose: Float64s) -> None:
        """The pose (3,) of the last scan."""
        self._pose = pose.copy()
        if self._seen_ns == self._changed_ns:
            self._first = self._pose


def is_copy(ranges: Float32s, others: Float32s) -> bool:
    """Whether two arrays are the same, bit by bit: that takes a tenth of the time of a comparison by value."""
    return ranges.dtype == others.dtype and ranges.tobytes() == others.tobytes()


def _length(motion: Float64s) -> float:
    """Of a motion (3,): metres or radians, whichever is more."""
    return max(math.hypot(*motion[:2]), abs(geometry.wrap(motion[2])))
