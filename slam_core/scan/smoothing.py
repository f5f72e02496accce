"""Ranges with much noise make thick walls, and a match may lie anywhere in these: such ranges are smoothed."""

from dataclasses import replace

import numpy as np

from slam_core.config import ScanConfig
from slam_core.kernels.endpoints import end_of_range
from slam_core.kernels.range_noise import BANDS, NEAREST, learn_noise
from slam_core.kernels.straight_walls import smooth
from slam_core.measurements import Float32s, LaserScan
from slam_core.scan.repeats import is_copy
from slam_core.scan.stabilise import directions

EVERY = 8  # scans: so often the noise is measured
WANTED = 0.01  # metres of noise in a range that is smoothed


class Smoothing:
    """Learns the noise of a laser from its scans, and takes it out of ranges that have much of it.

    noise: (BANDS,) as in `kernels.range_noise`.
    """

    def __init__(self) -> None:
        self.noise = np.full(BANDS, -1.0)
        self._estimates, self._most = self.noise.copy(), 0.0
        self._before = np.empty(0, np.float32)
        self._scans = 0

    @property
    def known(self) -> list[tuple[float, float]]:
        """A range (m) in the middle of each band whose noise is known, and that noise (m)."""
        middles = NEAREST * 2.0 ** (0.5 * np.arange(BANDS) + 0.25)
        return [(r, sigma) for r, sigma in zip(middles.tolist(), self.noise.tolist(), strict=True) if sigma >= 0.0]

    def take(self, scan: LaserScan, config: ScanConfig) -> LaserScan:
        """The scan, smoothed where its ranges have more noise than config.smooth_noise; unchanged if it is 0."""
        least = config.smooth_noise
        if not least > 0.0:
            return scan
        self.learn(scan, config)
        if not self._most > least:
            return scan
        ranges = np.ascontiguousarray(scan.ranges, np.float32)
        beams = directions(scan.angle_min, scan.angle_increment, len(ranges))
        limits = _limits(ranges, scan, config)
        return replace(scan, ranges=smooth(ranges, beams, limits, self.noise, least, WANTED))

    def learn(self, scan: LaserScan, config: ScanConfig) -> None:
        """The noise alone, by two in a row of EVERY scans. The same scan again tells nothing."""
        self._scans += 1
        number, before = self._scans % EVERY, self._before
        if number not in {1, 2}:
            return
        self._before = ranges = np.ascontiguousarray(scan.ranges, np.float32)
        if number == 2 and len(ranges) == len(before) and not is_copy(ranges, before):
            learn_noise(ranges, before, _limits(ranges, scan, config), self._estimates, self.noise)
            self._most = float(self.noise.max())


def _limits(ranges: Float32s, scan: LaserScan, config: ScanConfig) -> tuple[float, float]:
    low = max(config.range_min, scan.range_min, NEAREST)
    return low, min(config.range_max, end_of_range(ranges, scan.range_max))
