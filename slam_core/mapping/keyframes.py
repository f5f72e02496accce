"""The keyframe policy: which scans are written into the map. One whenever the robot has moved far enough."""

import math

import numpy as np

from slam_core import geometry
from slam_core.config import MapConfig
from slam_core.measurements import Float32s, Float64s

# A scan fits badly if its residuals on known cells are this many times the usual ones. Residuals this near to that
# of an unknown cell do not count.
POORER, UNKNOWN = 1.1, 0.02
MEMORY = 0.05  # weight of the newest scan in the running mean
TURNING = 0.5  # rad/s: a sweep of a robot that turns faster may be distorted


class KeyframePolicy:
    """Keeps the pose of the last keyframe of each laser, since when another one is due, and how well scans fit."""

    def __init__(self) -> None:
        self._written: dict[int, Float64s] = {}
        self._last: tuple[int, float] | None = None
        self._due_ns: int | None = None
        self._usual: float | None = None

    def selects(
        self, pose: Float64s, time_ns: int, residuals: Float32s | None, config: MapConfig, facing: int = 0
    ) -> bool:
        """Whether the scan of this time at a pose (3,) becomes a keyframe. facing: as of a `StabilisedScan`.

        residuals: (n,) of its match, where nothing but matches observes the motion of the laser. A scan in a turn
        that fits worse than usual may be distorted then, and a better one is awaited for `keyframe_max_delay`.
        """
        turning = self._turns(time_ns, float(pose[2]))
        distorted = residuals is not None and self._is_poor(residuals) and turning
        if not self._has_moved(pose, self._written.get(facing), config):
            return False
        if self._due_ns is None:
            self._due_ns = time_ns
        if distorted and 0 <= time_ns - self._due_ns < config.keyframe_max_delay * 1e9:
            return False
        self._written[facing], self._due_ns = pose.copy(), None
        return True

    def restart(self) -> None:
        """The next scan becomes a keyframe wherever it is."""
        self._written, self._due_ns = {}, None

    @staticmethod
    def _has_moved(pose: Float64s, written: Float64s | None, config: MapConfig) -> bool:
        """Whether it moved or turned far enough since a keyframe."""
        if written is None:
            return True
        (x, y, psi), (written_x, written_y, written_psi) = pose.tolist(), written.tolist()
        far = math.hypot(x - written_x, y - written_y) >= config.update_distance
        return far or abs(geometry.wrap(psi - written_psi)) >= config.update_angle

    def _turns(self, time_ns: int, psi: float) -> bool:
        """Whether the robot has turned fast since the scan before."""
        last, self._last = self._last, (time_ns, psi)
        if last is None:
            return False
        return abs(geometry.wrap(psi - last[1])) > TURNING * 1e-9 * abs(time_ns - last[0])

    def _is_poor(self, residuals: Float32s) -> bool:
        known = residuals[np.abs(residuals - 0.5) > UNKNOWN]
        if not len(known):
            return False
        error = math.sqrt(float(np.mean(np.square(known))))
        if self._usual is None:
            self._usual = error
        self._usual += MEMORY * (error - self._usual)
        return error > POORER * self._usual
