"""Pose reset: a start in a prior map, or a robot that was carried away."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from slam_core.kernels.fusion import planar_observer
from slam_core.kernels.linear import is_measurement
from slam_core.measurements import PLAUSIBLE, Float64s
from slam_core.navigation.corrections import Correction, Update
from slam_core.navigation.initial_alignment import with_pose
from slam_core.results import PlanarGaussian


@dataclass(frozen=True, slots=True, eq=False)
class PoseReset(Correction):
    """The base is at a planar pose, whatever its position and heading were."""

    pose: PlanarGaussian
    gate: float = 0.0
    source: ClassVar[str] = "scan"
    measures: ClassVar[tuple[int, ...]] = (2, 3, 4)

    @property
    def usable(self) -> bool:
        """Finite, with a sensible noise."""
        return bool(is_measurement(self.pose.mean, self.pose.covariance, PLAUSIBLE))

    def observe(self, x: Float64s) -> tuple[Float64s, Float64s, Float64s]:
        """Nothing is compared: the former position does not count."""
        return np.zeros(3), planar_observer(x), self.pose.covariance

    def update(self, x: Float64s, P: Float64s) -> Update:
        """The estimate turned and moved there."""
        return Update(*with_pose(x, P, self.pose), np.zeros(3), self.pose.covariance, 0.0, np.inf)
