"""What the beams of a laser bring: how many return, and whether their ranges keep to the limits stated."""

from dataclasses import dataclass

import numpy as np

from slam_core.measurements import Float32s, Float64s

COVERED_SHARE = 0.1  # of the beams: below this a scan sees next to nothing
COVERED_SCANS = 3  # in a row
MILLIMETRES = 1000.0


@dataclass(frozen=True, slots=True)
class Covered:
    """A stretch in which next to no beam returns: when it begins as recorded, and seconds."""

    log_ns: int
    seconds: float


class LaserReturns:
    """Takes the scans of one topic."""

    def __init__(self) -> None:
        self._rows: list[tuple[int, float, float, float, float]] = []
        self.farthest = 0.0

    def add(self, log_ns: int, ranges: Float32s, limits: tuple[float, float]) -> None:
        """One scan. limits: range_min and range_max of its message, metres."""
        low, high = limits
        there = ranges[np.isfinite(ranges) & (ranges > 0.0)].astype(np.float64)
        if not len(ranges):
            return
        outside = there[(there < low) | (there > high)] if high > low else there[:0]
        median = float(np.median(there)) if len(there) else 0.0
        self.farthest = max(self.farthest, float(outside.max()) if len(outside) else 0.0)
        n = len(ranges)
        self._rows.append((log_ns, (len(there) - len(outside)) / n, len(outside) / n, median, high))

    def _column(self, i: int) -> Float64s:
        return np.array([row[i] for row in self._rows], np.float64)

    @property
    def valid_share(self) -> float:
        """Of the beams of the median scan, those with a range within the limits; nan without scans."""
        return float(np.median(self._column(1))) if self._rows else float("nan")

    @property
    def outside_share(self) -> float:
        """Of all beams, those with a range out of the limits."""
        return float(np.mean(self._column(2))) if self._rows else 0.0

    @property
    def outside_since_ns(self) -> int:
        """When the first such range was recorded."""
        return next((row[0] for row in self._rows if row[2] > 0.0), 0)

    @property
    def millimetres(self) -> bool:
        """Whether ranges a thousandth as long would keep to the limits, as most of these do not."""
        if not self._rows or self.outside_share < 0.5:
            return False
        return float(np.median(self._column(3))) / MILLIMETRES < float(np.median(self._column(4)))

    @property
    def covered(self) -> list[Covered]:
        """Stretches of scans of which next to no beam returns, where most scans see more."""
        share = self._column(1)
        if not len(share) or self.valid_share < 3.0 * COVERED_SHARE:
            return []
        edges = np.flatnonzero(np.diff(np.concatenate([[False], share < COVERED_SHARE, [False]])))
        runs = zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)
        long = [(a, b) for a, b in runs if b - a >= COVERED_SCANS]
        return [Covered(self._rows[a][0], (self._rows[b - 1][0] - self._rows[a][0]) * 1e-9) for a, b in long]
