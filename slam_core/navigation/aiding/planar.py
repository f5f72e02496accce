"""Satellites and compass for the planar model: its estimate as a state of section V-A, corrected and converted.

So every correction, its gate and its counters are those of the navigation filter. What the plane does not have
(height, tilt, biases) is level or unknown and independent of the rest; the yaw rate rides in the place of the
vertical gyro's bias, which none of these sensors measures.
"""

import math
from collections import Counter
from collections.abc import Sequence

import numpy as np

from slam_core import geometry
from slam_core.config import MotionConfig
from slam_core.kernels.navigation import STATES
from slam_core.measurements import LEAP_NS, Float64s, Transform
from slam_core.navigation import gates
from slam_core.navigation.corrections import Correction
from slam_core.navigation.planar_motion import PlanarMotion
from slam_core.navigation.rejections import FAR_AHEAD, TOO_OLD, UNUSABLE, Rejections
from slam_core.results import AidingStatus

TILT_SIGMA = 0.03  # rad, of an external attitude, or of a floor
UNKNOWN = 100.0  # metres, m/s
OLDEST_NS = 1_000_000_000
PLANAR = [3, 4, 2, 6, 7, 11]  # where x, y, psi, the velocity in the map and the yaw rate are among the errors


class PlanarEstimator:
    """The planar model with the interface of the filter, for the aiding sensors."""

    def __init__(self, motion: PlanarMotion) -> None:
        self._rejections = Rejections()
        self._motion = motion
        self._statuses: gates.Statuses = {}

    def configure(self, config: MotionConfig, reset_time: float) -> None:
        """The settings that hold from now on, reset_time in seconds; needed before a correction."""
        self._config, self._reset_time_ns = config, round(reset_time * 1e9)

    @property
    def counts(self) -> Counter[str]:
        """What was not used, by reason."""
        return self._rejections.counts

    @property
    def ready(self) -> bool:
        """Whether there is an estimate."""
        return self._motion.stamp_ns is not None

    @property
    def aiding(self) -> tuple[AidingStatus, ...]:
        """What became of the measurements of every source."""
        return self._rejections.statuses(self._statuses)

    def pose(self, time_ns: int) -> Transform:
        """T_map_base at an instant near the last one known."""
        return self._motion.pose(time_ns)

    def motion_at(self, times_ns: Sequence[int]) -> Float64s:
        """(k, 10) position, attitude, and velocity in the map at k instants."""
        return self._motion.motion_at(times_ns)

    def drop(self, source: str, reason: str) -> None:
        """Count a measurement of a source that is of no use."""
        self._rejections.drop(source, reason)

    def matched(self, time_ns: int) -> None:
        """A match was fused: it vouches for the pose."""
        old = self._statuses.get("scan") or AidingStatus("scan", (2, 3, 4))
        new = old._replace(used=old.used + 1, stamp_ns=time_ns, used_ns=time_ns)
        self._statuses = {**self._statuses, "scan": new}

    def correct(self, time_ns: int, correction: Correction) -> bool:
        """A measurement at its own time, by which the present estimate is shifted. Whether it came to its gate."""
        reason = self._refusal(time_ns, correction)
        if reason:
            self.drop(correction.source, reason)
            return False
        mean, covariance = self._motion.estimate(time_ns, self._config)
        x, P = _lifted(mean, covariance, self._motion.pose(time_ns).rotation)
        before = self._statuses.get(correction.source)
        y, Q, self._statuses = gates.fuse(x, P, self._statuses, time_ns, correction, self._reset_time_ns)
        status = self._statuses[correction.source]
        if before is None or status.used > before.used:
            self._motion.shift(*_lowered(mean, y, Q))
        return True

    def _refusal(self, time_ns: int, correction: Correction) -> str:
        if not correction.usable:
            return UNUSABLE
        ahead_ns = time_ns - (self._motion.stamp_ns or 0)
        return TOO_OLD if ahead_ns < -OLDEST_NS else FAR_AHEAD if ahead_ns > LEAP_NS else ""


def _lifted(mean: Float64s, covariance: Float64s, attitude: Float64s) -> tuple[Float64s, Float64s]:
    """State (19,) and covariance (15, 15) of a planar estimate, with an attitude (4,) of the same heading."""
    turn, J = _turn(mean[2]), np.eye(6)
    J[3:5, 3:5], velocity = turn, turn @ mean[3:5]
    J[3:5, 2] = -velocity[1], velocity[0]
    x = np.zeros(STATES)
    x[:4], x[4:6], x[7:9], x[12] = attitude, mean[:2], velocity, mean[5]
    P = np.diag(np.repeat([TILT_SIGMA, UNKNOWN, UNKNOWN, 1.0, 1.0], 3) ** 2)
    P[np.ix_(PLANAR, PLANAR)] = J @ covariance @ J.T
    return x, P


def _lowered(mean: Float64s, x: Float64s, P: Float64s) -> tuple[Float64s, Float64s]:
    """The step (6,) from a planar mean to the values of x (19,), and the covariance (6, 6) of that."""
    psi = geometry.heading(x[:4])
    back, L = _turn(-psi), np.eye(6)
    body = back @ x[7:9]
    L[3:5, 3:5] = back
    L[3:5, 2] = body[1], -body[0]
    step = np.array([x[4], x[5], psi, *body, x[12]]) - mean
    step[2] = geometry.wrap(step[2])
    return step, L @ P[np.ix_(PLANAR, PLANAR)] @ L.T


def _turn(psi: float) -> Float64s:
    c, s = math.cos(psi), math.sin(psi)
    return np.array([[c, -s], [s, c]])
