"""A pose that was found after bad matches counts once it explains several scans; before, no scan is written."""

import math

import numpy as np

from slam_core import geometry
from slam_core.localization.search_parts import Region
from slam_core.measurements import Float64s
from slam_core.results import Fit, PlanarGaussian, Verdict

NEAR = 0.6  # metres, radians from the prediction: a match further off was found, not tracked
REACH, SPEED = 2.0, 2.0  # metres, m/s: how far a lost robot can have come
FEW, SEVERAL = 2, 5  # scans that a pose near the prediction has to explain, and one anywhere
MOVED = 0.4  # metres, radians between them: a pose that a search of the whole map found has to hold elsewhere, too
MOSTLY = 0.6  # of such a scan has to lie on known cells
GOOD = 0.9  # of the usual inlier ratio


class Confirmation:
    """What was sure last, and the pose that waits to be confirmed.

    pose: (3,) the last confirmed one. missed: bad matches since then.
    """

    def __init__(self) -> None:
        self.pose = np.zeros(3)
        self.missed = 0
        self._sure_ns: int | None = None
        self._found: Float64s | None = None  # where the waiting pose was found
        self._good = 0
        self._is_far = self._is_searched = False

    @property
    def pending(self) -> bool:
        """Whether a pose waits."""
        return self._found is not None

    def region(self, time_ns: int) -> Region | None:
        """Where the robot can have come since it was sure of its pose; None if it never was."""
        if self._sure_ns is None:
            return None
        return Region(self.pose, REACH + SPEED * max(0.0, (time_ns - self._sure_ns) * 1e-9))

    def accepted(
        self, pose: Float64s, fit: Fit, verdict: Verdict, prior: PlanarGaussian, usual: float, time_ns: int,
        lost_after: int,
    ) -> Verdict:  # fmt: skip
        """The verdict on an accepted match at `pose` (3,). usual: the mean inlier ratio before it."""
        step = pose - prior.mean
        jumped = math.hypot(*step[:2]) > NEAR or abs(geometry.wrap(step[2])) > NEAR
        if self._found is None and (self.missed or jumped):
            self._found, self._good = pose.copy(), 0
            self._is_searched = verdict.recovery == "relocalised"
            self._is_far = self._is_searched or self.missed >= lost_after or math.hypot(*step[:2]) > REACH
        if self._found is None:
            self.pose, self._sure_ns = pose.copy(), time_ns
            return verdict
        if fit.hit >= GOOD * usual and (not self._is_far or fit.known >= MOSTLY):
            self._good += 1
        if self._good < (SEVERAL if self._is_far else FEW) or (self._is_searched and not self._has_moved(pose)):
            return verdict._replace(state="lost" if self._is_far else "degraded", confirmed=False)
        self._found, self.missed = None, 0
        self.pose, self._sure_ns = pose.copy(), time_ns
        return verdict._replace(state="recovered")

    def rejected(self) -> bool:
        """Count a bad match. Whether it ends a pose that waited."""
        self.missed += 1
        failed, self._found = self.pending, None
        return failed

    def _has_moved(self, pose: Float64s) -> bool:
        assert self._found is not None
        moved = pose - self._found
        return math.hypot(*moved[:2]) >= MOVED or abs(geometry.wrap(moved[2])) >= MOVED
