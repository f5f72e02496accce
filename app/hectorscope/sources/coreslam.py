"""The text logs that came with tinySLAM: each line holds a sweep of a small laser and the counts of two wheels.

time in microseconds, 1 number, counts left and right, 20 numbers, 682 ranges in millimetres with 0 for no return
"""

import math
from pathlib import Path

import numpy as np

from hectorscope.inputs import SourceOptions
from hectorscope.sources import SourceKind
from hectorscope.sources._text_log import Instant, TextLog, floats
from slam_core.measurements import Float64s, LaserScan

FIRST_BEAM, BEAMS = 24, 682
FIELD = math.radians(240.0)
RANGE_MAX = 5.6  # m
# The robot of these recordings.
WHEEL_RADIUS, TRACK = 0.077, 0.33  # m
COUNTS_A_TURN = 2000


class _Parser:
    """Lines to instants; the wheels are added up."""

    def __init__(self) -> None:
        self._counts: Float64s | None = None
        self._wheels = np.zeros(3)

    def __call__(self, line: str) -> Instant | None:
        words = line.split()
        if not words:
            return None
        values = floats(words, FIRST_BEAM + BEAMS)
        self._roll(values[2:4])
        ranges = (1e-3 * values[FIRST_BEAM:]).astype(np.float32)
        ranges[ranges == 0.0] = np.inf
        scan = LaserScan(round(1e3 * values[0]), ranges, -FIELD / 2, FIELD / (BEAMS - 1), range_max=RANGE_MAX)
        return Instant(scan, self._wheels)

    def _roll(self, counts: Float64s) -> None:
        """Go on by what the two wheels turned."""
        if self._counts is not None:
            left, right = (counts - self._counts) / COUNTS_A_TURN * math.tau * WHEEL_RADIUS
            x, y, yaw = self._wheels
            forward, turn = 0.5 * (left + right), (right - left) / TRACK
            heading = yaw + 0.5 * turn
            self._wheels = np.array([x + forward * math.cos(heading), y + forward * math.sin(heading), yaw + turn])
        self._counts = counts


def _open(uri: str, options: SourceOptions) -> TextLog:
    return TextLog(Path(uri), "tinySLAM log", _Parser(), options)


SOURCE = SourceKind(
    accepts=lambda uri: "://" not in uri and Path(uri).suffix == ".dat", open=_open, suffixes=(".dat",)
)
