"""How uncertain the map itself is: what lies beyond a stretch with an open direction was drawn with that.

A match says where the robot is on the map. Where scans left a direction open, or there were none, the map goes on
from where the robot believed itself to be, and no match further on knows how long that stretch was.
"""

import numpy as np

from slam_core.measurements import Float64s
from slam_core.results import PlanarGaussian


class DrawnMap:
    """What the map adds to a pose's uncertainty, after the stretches that the run has left behind."""

    def __init__(self) -> None:
        self._lost: Float64s | None = None  # (2, 2) metres, against where the run began; None: nothing
        self._open: Float64s | None = None  # the direction
        self._variances = (0.0, 0.0)  # of the pose along it, when it opened and now

    def go_on(self, prior: PlanarGaussian) -> None:
        """The map goes on from a predicted pose, with nothing in between."""
        spread = prior.covariance[:2, :2]
        self._lost = spread if self._lost is None else self._lost + spread

    def claim(self, fused: PlanarGaussian, blind: Float64s) -> PlanarGaussian:
        """A fused pose with what the map adds to its uncertainty. blind: (2,) the open direction, or zero."""
        if any(blind.tolist()):
            variance = float(blind @ fused.covariance[:2, :2] @ blind)
            self._variances = (variance if self._open is None else self._variances[0], variance)
            self._open = blind
        elif self._open is not None:
            opened, last = self._variances
            lost = max(last - opened, 0.0) * np.outer(self._open, self._open)
            self._lost = lost if self._lost is None else self._lost + lost
            self._open = None
        if self._lost is None:
            return fused
        covariance = fused.covariance.copy()
        covariance[:2, :2] += self._lost
        return PlanarGaussian(fused.mean, covariance)
