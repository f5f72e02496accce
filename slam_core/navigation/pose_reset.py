"""Pose reset: a start in a prior map, or a robot that was carried away."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from slam_core.kernels import fusion
from slam_core.kernels.fusion import planar_observer
from slam_core.kernels.linear import is_measurement
from slam_core.kernels.navigation import ERRORS
from slam_core.measurements import PLAUSIBLE, Float64s
from slam_core.navigation.corrections import Correction, Update
from slam_core.navigation.initial_alignment import HEIGHT_SIGMA, SPEED_SIGMA, with_pose
from slam_core.results import PlanarGaussian

ACCEL_BIAS = np.eye(3, ERRORS, 12)  # how the biases of the accelerometers follow the errors
LOOSENED = 3.0  # factor on standard deviations


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


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Origin(PoseReset):
    """The base is at a planar pose and at height 0, as that is where the map begins.

    has_velocity: it is as it was estimated; else it is unknown. accel_bias_sigma: m/s^2, of a base that nothing is
    known of.
    """

    has_velocity: bool
    accel_bias_sigma: float

    def update(self, x: Float64s, P: Float64s) -> Update:
        """The estimate turned and moved there, and less certain."""
        x, P = with_pose(*_loosened(x, P, self.accel_bias_sigma), self.pose)
        forget(x, P, 5, HEIGHT_SIGMA)
        for i in () if self.has_velocity else (6, 7, 8):
            forget(x, P, i, SPEED_SIGMA)
        return Update(x, P, np.zeros(3), self.pose.covariance, 0.0, np.inf)


def _loosened(x: Float64s, P: Float64s, accel_bias_sigma: float) -> tuple[Float64s, Float64s]:
    """An estimate that is surer than it is right: levelled in motion, or by matches in a map that is askew.

    It is less certain by LOOSENED, as such matches agree well with each other. The biases of the accelerometers,
    which had to explain the rest, are about 0 again, and what is correlated with them changes: the tilt.
    """
    better, reduced, S = np.empty(len(x)), np.empty(P.shape), np.empty((3, 3))
    R = accel_bias_sigma**2 * np.eye(3)
    fusion.correct(x, LOOSENED**2 * P, -x[13:16], ACCEL_BIAS, R, np.inf, better, reduced, S)
    return better, reduced


def forget(x: Float64s, P: Float64s, i: int, sigma: float) -> None:
    """An error state i of position or velocity is 0 with this standard deviation, whatever it was; in place."""
    x[1 + i] = 0.0
    P[i, :] = P[:, i] = 0.0
    P[i, i] = sigma**2
