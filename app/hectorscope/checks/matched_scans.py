"""The scans of a source matched without its other sensors: how the robot turned, and which beam comes first."""

import numpy as np

from hectorscope.checks.beam_order import BeamOrder, OrderStatistics, shows_order
from hectorscope.ros.repairs import with_sweep
from hectorscope.run.warmup import warm_up
from slam_core.config import SlamConfig
from slam_core.measurements import Float64s, LaserScan
from slam_core.slam import HectorSlam


class MatchedScans:
    """Takes scans, and matches them when it is asked what they show; in both orders of their beams if need be."""

    def __init__(self) -> None:
        self.scans: list[LaserScan] = []
        self._slams: tuple[HectorSlam, HectorSlam] | None = None  # of the scans, and with their last beam first
        self._order = OrderStatistics()
        self._headings: list[tuple[int, float]] = []

    @property
    def shows_order(self) -> bool:
        """Whether the scans show in which order their beams are measured, once the robot moves."""
        return bool(self.scans) and shows_order(self.scans[0])

    @property
    def order(self) -> BeamOrder | None:
        """What the scans that were matched show of it."""
        return self._order.result()

    def headings(self, begin_ns: int) -> Float64s:
        """(n, 2) seconds after `begin_ns` and heading, unwrapped; NaN where the pose was lost."""
        if len(self.scans) > len(self._headings):
            self._match()
        headings = np.array([((time_ns - begin_ns) * 1e-9, psi) for time_ns, psi in self._headings]).reshape(-1, 2)
        known = np.isfinite(headings[:, 1])
        headings[known, 1] = np.unwrap(headings[known, 1])
        return headings

    def _match(self) -> None:
        """What came since the last time."""
        if self._slams is None:
            warm_up()
            self._slams = HectorSlam(SlamConfig()), HectorSlam(SlamConfig())
        stated, turned = self._slams
        for scan in self.scans[len(self._headings) :]:
            result = stated.step(scan)
            if self.shows_order:
                sweep_s = (scan.end_ns - scan.stamp_ns) * 1e-9
                self._order.take(result, turned.step(with_sweep(scan, -sweep_s)), sweep_s)
            is_known = result is not None and result.verdict.undoubted
            self._headings.append((scan.mid_ns, float(result.planar[2]) if result and is_known else np.nan))
