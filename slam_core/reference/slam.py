"""Figure 1: scans and inertial data in, map and 6DOF pose out, every step in plain numpy."""

import math
from typing import NamedTuple

import numpy as np

from slam_core import geometry
from slam_core.config import SlamConfig
from slam_core.measurements import Float64s, Imu, LaserScan, Measurement
from slam_core.reference.covariance_intersection import intersect
from slam_core.reference.navigation_filter import State, initial_state, planar, predict
from slam_core.reference.pyramid import Pyramid
from slam_core.reference.scan_matching import Iteration, hessian_covariance, match, transformed
from slam_core.reference.stabilise import stabilise

NO_ITERATION: tuple[Iteration, ...] = ()
FIRST_COVARIANCE = np.diag([1e-6, 1e-6, 1e-6])  # of the pose of the first scan, which defines the origin


class ReferenceScan(NamedTuple):
    """What one scan gives.

    stamp_ns: the middle of its sweep. pose: (3,) xi* in the map. R: (3, 3) of (15). start: (3,) start estimate.
    iterations: every Gauss-Newton iteration, coarse to fine; none for the first scan. written: whether the map was
    updated. state: of the filter after the fusion; None without inertial data.
    """

    stamp_ns: int
    pose: Float64s
    R: Float64s
    start: Float64s
    iterations: tuple[Iteration, ...]
    written: bool
    state: State | None


class ReferenceSlam:
    """The method of the paper. config: `SlamConfig.paper()` or what of it the paper leaves open.

    Measurements come in the order of a `Sequencer`: inertial data up to the end of a sweep before the scan.
    Without inertial data the start estimate is the last pose, and the attitude is level.
    """

    def __init__(self, config: SlamConfig) -> None:
        self.config = config
        self.map = Pyramid(config.map)
        self._samples: list[tuple[int, Float64s]] = []
        self._state: State | None = None
        self._state_ns = 0
        self._pose = np.zeros(3)
        self._keyframe: Float64s | None = None

    def step(self, measurement: Measurement) -> ReferenceScan | None:
        """Take in one measurement; a scan gives a result, unless the attitude is still unknown."""
        if isinstance(measurement, Imu):
            self._add_imu(measurement)
        elif isinstance(measurement, LaserScan) and (self._state is not None or not self._samples):
            return self._scan(measurement)
        return None

    def _add_imu(self, imu: Imu) -> None:
        """Section V-A: initial alignment over the first samples; later ones wait for the next scan."""
        self._samples.append((imu.stamp_ns, np.concatenate([imu.angular_velocity, imu.linear_acceleration])))
        navigation = self.config.navigation
        if self._state is None and imu.stamp_ns - self._samples[0][0] >= navigation.level_time * 1e9:
            self._state = initial_state(np.array([u for _, u in self._samples]), navigation)
            self._state_ns = imu.stamp_ns
            del self._samples[:-1]

    def _propagate(self, to_ns: int) -> None:
        """Eqs. (1)-(3) up to a time: between two samples their mean is the input, after the last that sample."""
        assert self._state is not None
        for k in range(len(self._samples)):
            end = self._samples[k + 1] if k + 1 < len(self._samples) else (to_ns, self._samples[k][1])
            begin_ns, until_ns = max(self._state_ns, self._samples[k][0]), min(end[0], to_ns)
            if begin_ns < until_ns:
                u = 0.5 * (self._samples[k][1] + end[1])
                self._state = predict(self._state, u, (until_ns - begin_ns) * 1e-9, self.config.navigation)
                self._state_ns = until_ns
        self._samples = [s for k, s in enumerate(self._samples) if k + 1 == len(self._samples)
                         or self._samples[k + 1][0] > to_ns]  # fmt: skip

    def _scan(self, scan: LaserScan) -> ReferenceScan | None:
        """The path of a scan."""
        attitude, start = geometry.yaw_quaternion(self._pose[2]), self._pose
        if self._state is not None:
            self._propagate(scan.mid_ns)
            attitude, start = self._state.q, planar(self._state)[0]  # V-B: the filter projected to the plane
        points, laser = stabilise(scan, attitude, self.config.scan)
        if not len(points):
            return None
        R, iterations = FIRST_COVARIANCE, NO_ITERATION
        if self._keyframe is not None:
            R, iterations = self._match(points, start)
        written = self._update(points, laser)
        if self._state_ns <= scan.mid_ns:  # the filter may begin after the first scan
            self._fuse(R)
        return ReferenceScan(scan.mid_ns, self._pose, R, start, iterations, written, self._state)

    def _match(self, points: Float64s, start: Float64s) -> tuple[Float64s, tuple[Iteration, ...]]:
        """Sections IV-B and IV-C."""
        matcher = self.config.matcher
        steps = matcher.iterations_coarse, matcher.iterations_fine
        iterations = tuple(match(self.map.levels, points, start, steps))
        self._pose = iterations[-1].pose
        return hessian_covariance(iterations[-1].H, matcher.sigma), iterations

    def _update(self, points: Float64s, laser: Float64s) -> bool:
        """Section IV-C: the scan is written into all levels after enough motion."""
        if self._keyframe is not None:
            x, y, psi = self._pose - self._keyframe
            near = math.hypot(x, y) < self.config.map.update_distance
            if near and abs(geometry.wrap(psi)) < self.config.map.update_angle:
                return False
        self._keyframe = self._pose.copy()
        self.map.update(transformed(laser[None], self._pose)[0], transformed(points, self._pose))
        return True

    def _fuse(self, R: Float64s) -> None:
        """Section V-B: covariance intersection of the filter with the match, as an error of the state."""
        if self._state is None:
            return
        mean, C = planar(self._state)
        innovation = self._pose - mean
        innovation[2] = geometry.wrap(innovation[2])
        error, P = intersect(np.zeros(15), self._state.P, C, innovation, R, self.config.fusion.omega)
        self._state = self._state.corrected(error, 0.5 * (P + P.T))
