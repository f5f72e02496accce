"""The planar motion model without an IMU: nearly constant velocity.

It has the interface of the navigation filter: the pose at a time, its covariance in the plane, and the fusion of a
match. Roll and pitch come from an external attitude if there is one, else they are zero.
"""

import math
from bisect import bisect_left
from collections import deque
from collections.abc import Sequence
from itertools import islice

import numpy as np

from slam_core import geometry
from slam_core.config import FusionConfig, MotionConfig
from slam_core.kernels.fusion import kalman
from slam_core.kernels.imu_check import FASTEST
from slam_core.kernels.navigation import SLIP_SIGMA
from slam_core.measurements import Attitude, Float64s, Int64s, Odometry, Transform
from slam_core.navigation.covariance_intersection import intersect
from slam_core.navigation.wheel_slip import WheelSlip
from slam_core.results import NOWHERE, PlanarGaussian

MEMORY = 256  # attitudes kept: some seconds
YAW_RATE_SIGMA = 0.05  # rad/s, of a gyro with its bias
SPEED_NOISE = 0.14  # metres a root of a second: of the way at a mean speed, 0.14 m after one and 0.28 m after four
OBSERVE_POSE = np.eye(3, 6)
OBSERVE_TWIST = np.eye(3, 6, 3)
# Longest prediction, and the step back of a stamp that counts as a clock that was set.
LONGEST_NS = 2_000_000_000
SET_BACK_NS = 1_000_000_000
# Seconds without a match after which wheels alone tell the motion, and the process noise of the yaw rate then, at
# most, rad/s²/√Hz: more leaves room for matches to correct it.
RECKONED_S, RECKONED_YAW = 0.5, 1.0
WHEELS_SILENT_NS = 500_000_000  # without a wheel velocity: from then on the motion is not measured
# A match this many standard deviations from the prediction, that a motion reaches only by more than this
# acceleration (m/s^2), tells of an error of the pose and not of a velocity.
JUMP_SIGMAS, JUMP_ACCELERATION = 5.0, 20.0


class PlanarMotion:
    """A Kalman filter on x, y, psi in the map and the body's velocity forward, left and about z; six states."""

    def __init__(self) -> None:
        self.stamp_ns: int | None = None
        self._mean = np.zeros(6)
        self._covariance = np.diag([0.01, 0.01, 0.01, 1.0, 1.0, 1.0]) ** 2.0
        self._attitudes: deque[Attitude] = deque(maxlen=MEMORY)
        self._fused_ns: int | None = None
        self._rolled_ns: int | None = None  # of the last wheel velocity that was used
        self._slip = WheelSlip()
        self._jumped = False

    def add_attitude(self, attitude: Attitude) -> None:
        """Remember roll and pitch."""
        self._attitudes.append(attitude)

    def add_yaw_rate(self, time_ns: int, rate: float, config: MotionConfig) -> None:
        """Let a gyro correct the yaw rate, rad/s."""
        if not abs(rate) < FASTEST:
            return
        self._advance(time_ns, config)
        self._observe(OBSERVE_TWIST[2:], np.array([rate]), np.array([[YAW_RATE_SIGMA**2]]))

    def constrain_sideways(self) -> None:
        """Section III: the non-holonomic constraint of wheels that do not slip: no velocity to the left."""
        self._observe(OBSERVE_TWIST[1:2], np.zeros(1), np.array([[SLIP_SIGMA**2]]))

    def add_odometry(self, odometry: Odometry, config: MotionConfig) -> bool:
        """Let wheels correct the velocity. Whether they do: not while they slip."""
        self._advance(odometry.stamp_ns, config)
        if not self._slip.rolls(odometry, self._mean[3:5]):
            return False
        self._rolled_ns = odometry.stamp_ns
        wanted = np.array([*odometry.velocity, odometry.yaw_rate])
        self._observe(OBSERVE_TWIST, wanted, np.diag(odometry_sigmas(odometry, config) ** 2))
        return True

    def keep_speed(self, direction: Float64s, speed: float) -> None:
        """Let a mean speed, m/s, along a direction (2,) of the map correct the velocity since the last match."""
        C = np.zeros((1, 6))
        C[0, 3:5] = self._in_body(direction)
        self._observe(C, np.array([speed]), np.array([[SPEED_NOISE**2 / max(self._since_fused, 1e-3)]]))

    def pose(self, time_ns: int) -> Transform:
        """T_map_base at an instant near the last one known."""
        placed = np.array(self._placed(time_ns))
        return Transform(placed[4:], placed[:4])

    def poses(self, from_ns: int, since_ns: Int64s) -> Float64s:
        """Attitude and position at instants (k,) after `from_ns`: (k, 7)."""
        return np.array([self._placed(from_ns + time_ns) for time_ns in since_ns.tolist()])

    def motion_at(self, times_ns: Sequence[int]) -> Float64s:
        """(k, 10) position, attitude, and velocity in the map at k instants."""
        poses = self.poses(0, np.array(times_ns))
        rotations, positions = poses[:, :4], poses[:, 4:]
        forward, left = self._mean[3:5]
        headings = np.array([geometry.heading(q) for q in rotations])
        c, s = np.cos(headings), np.sin(headings)
        return np.column_stack((positions, rotations, c * forward - s * left, s * forward + c * left, 0.0 * c))

    def prior(self, time_ns: int, config: MotionConfig) -> PlanarGaussian:
        """The predicted pose and its uncertainty; moves the filter on to that instant."""
        self._advance(time_ns, config)
        return self.planar

    def estimate(self, time_ns: int, config: MotionConfig) -> tuple[Float64s, Float64s]:
        """Mean (6,) at an instant, also one a little before the last known; covariance (6, 6) of the later one."""
        self._advance(time_ns, config)
        return np.concatenate((self._extrapolated(time_ns), self._mean[3:])), self._covariance

    def shift(self, step: Float64s, covariance: Float64s) -> None:
        """Correct the last estimate by a step (6,); its covariance (6, 6) after that."""
        self._mean = self._mean + step
        self._mean[2] = geometry.wrap(self._mean[2])
        self._set_covariance(covariance)

    def fuse(
        self, match: PlanarGaussian, config: FusionConfig, unobservable: Float64s = NOWHERE
    ) -> PlanarGaussian:
        """Covariance intersection (or what is configured) with a match at the last `prior`; the fused pose.

        unobservable: (2,) direction of the plane that the match does not observe, or zero. A jump that no motion
        explains corrects the pose and not the speed, which would carry the next prediction off. A second one in a
        row is a motion.
        """
        innovation = match.mean - self._mean[:3]
        innovation[2] = geometry.wrap(innovation[2])
        unaided = not (self.aided or unobservable.any())
        self._jumped = unaided and not self._jumped and self._is_jump(innovation[:2], match)
        self._fused_ns = self.stamp_ns
        held = np.zeros((2, 6))
        held[0, :2] = unobservable
        held[1, 3:5] = self._in_body(unobservable)
        step, covariance = intersect(
            self._covariance, OBSERVE_POSE, match.covariance, innovation, config.omega, config.method,
            unobservable=unobservable, held=held,
        )  # fmt: skip
        if self._jumped:
            step[3:5] = 0.0
        self.shift(step, covariance)
        return self.planar

    def begin_at_origin(self) -> None:
        """The map begins where the base is now, with its velocity."""
        self._mean[:3] = 0.0

    def reset_pose(self, time_ns: int, pose: PlanarGaussian, config: MotionConfig) -> None:
        """Continue at a pose at a time, wherever the base was estimated before; the velocity of the body stays."""
        self._advance(time_ns, config)
        self._mean[:3] = pose.mean
        covariance = np.zeros((6, 6))
        covariance[:3, :3], covariance[3:, 3:] = pose.covariance, self._covariance[3:, 3:]
        self._set_covariance(covariance)

    @property
    def planar(self) -> PlanarGaussian:
        """The pose at the time of the last estimate."""
        return PlanarGaussian(self._mean[:3].copy(), self._covariance[:3, :3].copy())

    def judge_wheels(self, time_ns: int, *, slips: bool) -> None:
        """Whether a scan of this time shows that the wheels slip."""
        self._slip.judge(time_ns, slips=slips)

    @property
    def driven(self) -> bool:
        """Whether wheels have measured the velocity for the last estimate, or shortly before."""
        if self._rolled_ns is None or self.stamp_ns is None:
            return False
        return abs(self.stamp_ns - self._rolled_ns) <= WHEELS_SILENT_NS

    @property
    def aided(self) -> bool:
        """Whether there was an external attitude, or wheels measure the velocity."""
        return bool(self._attitudes) or self.driven

    def given(self, direction: Float64s, offset: float) -> "PlanarMotion":
        """A copy whose mean is that given that the pose lies `offset` further along a `direction` (3,)."""
        part = self._covariance[:, :3] @ direction
        other = self.copy()
        other._mean = self._mean + part * (offset / float(direction @ part[:3]))
        other._mean[2] = geometry.wrap(other._mean[2])
        return other

    def hold(self, time_ns: int, pose: PlanarGaussian, config: MotionConfig) -> None:
        """Stay at a pose at a time, without a velocity: that of a lost robot would carry it off."""
        self.reset_pose(time_ns, pose, config)
        self._mean[3:] = 0.0

    @property
    def twist(self) -> Float64s:
        """(3,) velocity forward and left, m/s, and yaw rate, rad/s."""
        return self._mean[3:].copy()

    def copy(self) -> "PlanarMotion":
        """An independent copy."""
        other = PlanarMotion()
        other.stamp_ns, other._mean, other._covariance = self.stamp_ns, self._mean.copy(), self._covariance.copy()
        other._attitudes, other._slip = self._attitudes.copy(), self._slip.copy()
        other._fused_ns, other._jumped, other._rolled_ns = self._fused_ns, self._jumped, self._rolled_ns
        return other

    def _advance(self, time_ns: int, config: MotionConfig) -> None:
        if self.stamp_ns is None:
            self.stamp_ns = time_ns
        if time_ns < self.stamp_ns - SET_BACK_NS:
            self.stamp_ns = time_ns
            self._set_covariance(
                self._covariance + _noise(SET_BACK_NS * 1e-9, self._mean[2], self._densities(config))
            )
        dt = self._lapse(time_ns)
        if dt <= 0.0:
            return
        transition = self._transition(dt)
        self._mean[:3] = self._extrapolated(time_ns)
        self._set_covariance(
            transition @ self._covariance @ transition.T + _noise(dt, self._mean[2], self._densities(config))
        )
        self.stamp_ns = time_ns

    def _densities(self, config: MotionConfig) -> Float64s:
        """(3,) of the white acceleration forward, left and about z, squared."""
        reckoned = self.driven and self._since_fused > RECKONED_S
        yaw = min(config.yaw_acceleration, RECKONED_YAW) if reckoned else config.yaw_acceleration
        return np.array([config.acceleration, config.acceleration, yaw]) ** 2.0

    def _lapse(self, time_ns: int) -> float:
        """Seconds since the estimate, limited."""
        if self.stamp_ns is None or time_ns < self.stamp_ns - SET_BACK_NS:
            return 0.0
        return min(time_ns - self.stamp_ns, LONGEST_NS) * 1e-9

    def _observe(self, C: Float64s, values: Float64s, R: Float64s) -> None:
        """A Kalman update."""
        step, covariance = kalman(self._covariance, C, R, values - C @ self._mean)
        self._mean = self._mean + step
        self._set_covariance(covariance)

    def _placed(self, time_ns: int) -> list[float]:
        """As `poses`, of one instant; a sweep has up to two hundred, and arrays of four take long to make."""
        x, y, psi = self._extrapolated(time_ns)
        if self._attitudes:
            tilt = geometry.split_heading(self._attitude(time_ns))[1]
            return [*geometry.multiply(geometry.yaw_quaternion(psi), tilt).tolist(), x, y, 0.0]
        return [math.cos(0.5 * psi), 0.0, 0.0, math.sin(0.5 * psi), x, y, 0.0]

    def _extrapolated(self, time_ns: int) -> tuple[float, float, float]:
        """x, y and psi."""
        dt = self._lapse(time_ns)
        x, y, psi, forward, left, rate = self._mean.tolist()
        middle = psi + 0.5 * rate * dt
        c, s = math.cos(middle), math.sin(middle)
        return x + dt * (c * forward - s * left), y + dt * (s * forward + c * left), geometry.wrap(psi + rate * dt)

    def _transition(self, dt: float) -> Float64s:
        _, _, psi, forward, left, rate = self._mean.tolist()
        middle = psi + 0.5 * rate * dt
        c, s = math.cos(middle), math.sin(middle)
        transition = np.eye(6)
        transition[0, 3:5], transition[1, 3:5] = (c * dt, -s * dt), (s * dt, c * dt)
        transition[0, 2], transition[1, 2] = -dt * (s * forward + c * left), dt * (c * forward - s * left)
        transition[:2, 5] = 0.5 * dt * transition[:2, 2]
        transition[2, 5] = dt
        return transition

    def _in_body(self, direction: Float64s) -> tuple[float, float]:
        """A direction (2,) of the map as forward and left."""
        c, s = math.cos(self._mean[2]), math.sin(self._mean[2])
        x, y = direction.tolist()
        return c * x + s * y, c * y - s * x

    def _is_jump(self, innovation: Float64s, match: PlanarGaussian) -> bool:
        """Whether no motion since the last match explains an innovation (2,) of the position."""
        if self._fused_ns is None or math.hypot(*innovation) <= JUMP_ACCELERATION * self._since_fused**2:
            return False
        S = self._covariance[:2, :2] + match.covariance[:2, :2]
        return float(innovation @ np.linalg.solve(S, innovation)) > JUMP_SIGMAS**2

    @property
    def _since_fused(self) -> float:
        """Seconds from the last match to the estimate."""
        return 0.0 if self._fused_ns is None or self.stamp_ns is None else (self.stamp_ns - self._fused_ns) * 1e-9

    def _set_covariance(self, covariance: Float64s) -> None:
        self._covariance = 0.5 * (covariance + covariance.T)

    def _attitude(self, time_ns: int) -> Float64s:
        """Orientation between the two attitudes around an instant."""
        i = bisect_left(self._attitudes, time_ns, key=lambda a: a.stamp_ns)
        if i == 0 or i == len(self._attitudes):
            return self._attitudes[min(i, len(self._attitudes) - 1)].rotation
        before, after = islice(self._attitudes, i - 1, i + 1)
        fraction = (time_ns - before.stamp_ns) / (after.stamp_ns - before.stamp_ns)
        return geometry.slerp(before.rotation, after.rotation, fraction)


def odometry_sigmas(odometry: Odometry, config: MotionConfig) -> Float64s:
    """(3,) standard deviations of a wheel velocity forward, left and about z: slip grows with the motion."""
    speed = float(np.hypot(*odometry.velocity))
    moving = np.array([speed, speed, odometry.yaw_rate])
    sigmas: Float64s = np.hypot(config.odometry_sigma, config.odometry_slip * moving)
    return sigmas


def _noise(dt: float, psi: float, density: Float64s) -> Float64s:
    """White acceleration of a density (3,) over dt: covariance of pose and velocity, the same forward and left."""
    noise = np.zeros((6, 6))
    c, s = math.cos(psi), math.sin(psi)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    noise.flat[::7] = *(density * dt**3 / 3.0), *(density * dt)
    noise[:3, 3:] = turn * (density * dt**2 / 2.0)
    noise[3:, :3] = noise[:3, 3:].T
    return noise
