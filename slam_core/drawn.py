"""How uncertain the map itself is: what lies beyond a stretch with an open direction was drawn with that.

A match says where the robot is on the map. Where scans left a direction open, the map goes on from where the robot
believed itself to be, and no match further on knows how long that stretch was.
"""

import numpy as np

from slam_core.measurements import Float64s
from slam_core.results import PlanarGaussian


class DrawnMap:
    """covariance: (2, 2) of the map around the robot against where the run began; metres."""

    def __init__(self) -> None:
        self.covariance = np.zeros((2, 2))
        self._open: Float64s | None = None  # the direction
        self._variances = (0.0, 0.0)  # of the pose along it, when it opened and now

    def claim(self, fused: PlanarGaussian, blind: Float64s) -> PlanarGaussian:
        """A fused pose with what the map adds to its uncertainty. blind: (2,) the open direction, or zero."""
        if blind.any():
            variance = float(blind @ fused.covariance[:2, :2] @ blind)
            self._variances = (variance if self._open is None else self._variances[0], variance)
            self._open = blind
        elif self._open is not None:
            opened, last = self._variances
            self.covariance = self.covariance + max(last - opened, 0.0) * np.outer(self._open, self._open)
            self._open = None
        covariance = fused.covariance.copy()
        covariance[:2, :2] += self.covariance
        return PlanarGaussian(fused.mean, covariance)
