"""Whether the first beam of a scan is measured first, by how well the scans fit if the last one is.

Drivers of lasers that spin clockwise turn the ranges round, so that angles grow as REP-103 has them, and leave
`time_increment` positive: the beams then come against the order of their times.
"""

from dataclasses import dataclass

import numpy as np

from slam_core.measurements import LaserScan
from slam_core.results import StepResult

SLOW_NS = 40_000_000  # a shorter sweep is bent less than by motions that a laser alone does not observe
FEWEST_SCANS = 100
BLOCK = 10  # scans: the residuals of neighbours are alike, those of blocks nearly independent
SURE = 3.5  # standard errors
CLEAR = 0.95  # of the other mean residual: of a robot at rest a far smaller difference may be sure


@dataclass(frozen=True, slots=True)
class BeamOrder:
    """Mean residuals of scans that are matched as their messages time the beams, and with the last beam first.

    score: the difference of the two in standard errors, positive where the scans fit better with the last beam
    first. sweep_s: from the first beam to the last, the median.
    """

    stated: float
    reversed: float
    score: float
    sweep_s: float

    @property
    def is_sure(self) -> bool:
        """Whether one order fits so much better that it is no chance."""
        better, worse = sorted((self.stated, self.reversed))
        return abs(self.score) > SURE and better < CLEAR * worse

    @property
    def is_reversed(self) -> bool:
        """Whether the last beam is surely the first."""
        return self.is_sure and self.score > 0.0


def shows_order(scan: LaserScan) -> bool:
    """Whether a scan states its times, and takes long enough for its order to matter."""
    return scan.end_ns - scan.stamp_ns >= SLOW_NS


class OrderStatistics:
    """Takes the results of the same scans in both orders."""

    def __init__(self) -> None:
        self._residuals: list[tuple[float, float]] = []
        self._sweeps_s: list[float] = []

    def take(self, stated: StepResult | None, turned: StepResult | None, sweep_s: float) -> None:
        """The results of a scan whose sweep takes so long. turned: with the last beam first."""
        as_stated, the_other_way = _residual(stated), _residual(turned)
        if as_stated is not None and the_other_way is not None:
            self._residuals.append((as_stated, the_other_way))
            self._sweeps_s.append(sweep_s)

    def result(self) -> BeamOrder | None:
        """What they show so far; None of few scans."""
        n = len(self._residuals) // BLOCK * BLOCK
        if n < FEWEST_SCANS:
            return None
        residuals = np.array(self._residuals[:n])
        differences = (residuals[:, 0] - residuals[:, 1]).reshape(-1, BLOCK).mean(axis=1)
        error = float(differences.std(ddof=1)) / len(differences) ** 0.5
        stated, turned = residuals.mean(axis=0).tolist()
        score = float(differences.mean()) / error if error > 0.0 else 0.0
        return BeamOrder(stated, turned, score, float(np.median(self._sweeps_s)))


def _residual(result: StepResult | None) -> float | None:
    """Of a scan whose pose is sure."""
    if result is None or result.match is None or not result.verdict.undoubted:
        return None
    return result.match.mean_residual
