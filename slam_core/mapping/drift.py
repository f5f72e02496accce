"""Map drift accumulated while one direction of the pose was unobservable.

A match gives the pose on the map. Where scans left a direction unobservable, or there was no match, the map was
continued from the prediction. No later match can observe the error of that stretch.
"""

import numpy as np

from slam_core.measurements import Float64s
from slam_core.results import PlanarGaussian


class MapDrift:
    """The covariance of the map against its start, from the stretches that the run has passed."""

    def __init__(self) -> None:
        self._drift: Float64s | None = None  # (2, 2) m^2; None: none
        self._direction: Float64s | None = None  # the direction that is unobservable now
        self._variances = (0.0, 0.0)  # of the pose along it, when it became so and now

    def continue_from(self, prior: PlanarGaussian) -> None:
        """The map continues from a predicted pose, with nothing in between."""
        self._add(prior.covariance[:2, :2])

    def added_to(self, fused: PlanarGaussian, unobservable: Float64s) -> PlanarGaussian:
        """A fused pose whose covariance contains the drift. unobservable: (2,) the direction now, or zero."""
        if any(unobservable.tolist()):
            variance = float(unobservable @ fused.covariance[:2, :2] @ unobservable)
            self._variances = (variance if self._direction is None else self._variances[0], variance)
            self._direction = unobservable
        elif self._direction is not None:
            first, last = self._variances
            self._add(max(last - first, 0.0) * np.outer(self._direction, self._direction))
            self._direction = None
        if self._drift is None:
            return fused
        covariance = fused.covariance.copy()
        covariance[:2, :2] += self._drift
        return PlanarGaussian(fused.mean, covariance)

    def _add(self, covariance: Float64s) -> None:
        self._drift = covariance if self._drift is None else self._drift + covariance
