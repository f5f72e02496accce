"""Section V-A: the navigation filter, an error-state Kalman filter on attitude, position, velocity and biases.

The attitude is a quaternion and its error a small rotation about the map's axes, so no attitude is special.
"""

from collections import Counter
from collections.abc import Sequence

import numpy as np

from slam_core.config import FusionMethod, NavigationConfig, PlatformConfig
from slam_core.kernels.fusion import planar_estimate
from slam_core.kernels.imu_propagation import MAX_GAP_NS
from slam_core.measurements import LEAP_NS, Float64s, Imu, Int64s, Transform
from slam_core.navigation.corrections import BodyVelocity, Correction, HeightAid, PlanarPose
from slam_core.navigation.history import History
from slam_core.navigation.imu_check import ImuCheck
from slam_core.navigation.initial_alignment import initial_state, is_still, moving_state
from slam_core.navigation.pose_reset import PoseReset
from slam_core.navigation.rejections import (
    FAR_AHEAD,
    GAP,
    LEAPT,
    NOT_LATER,
    SET_BACK,
    TOO_EARLY,
    TOO_OLD,
    UNUSABLE,
    WEIGHTLESS,
    Rejections,
)
from slam_core.results import NOWHERE, AidingStatus, NavigationState, PlanarGaussian

AT_ONCE = np.zeros(1, np.int64)
MOTION = np.array([4, 5, 6, 0, 1, 2, 3, 7, 8, 9])  # of a state: position, attitude and velocity


class NavigationFilter:
    """Predict with every inertial sample; correct with everything else, at its own time, in any order.

    ready: whether the filter has found its attitude; before that, corrections are counted and dropped. moves:
    somebody saw the base move before that. begins_in_motion: at its first estimate. begin_ns: of that one, by the
    clock of now, or of the one with which it went on from the planar model.
    """

    def __init__(self, config: NavigationConfig, platform: PlatformConfig | None = None) -> None:
        self._rejections = Rejections()
        self._config, self._platform = config, platform or PlatformConfig()
        self._imu_check = ImuCheck()
        self._first: list[tuple[int, Float64s]] = []
        self._history: History | None = None
        self._suspect_ns = self.begin_ns = 0
        self.moves = self.begins_in_motion = False

    def configure(self, config: NavigationConfig, platform: PlatformConfig | None = None) -> None:
        """Change settings from the next measurement on."""
        self._config, self._platform = config, platform or PlatformConfig()
        if self._history is not None:
            self._history.configure(self._config, self._platform)

    @property
    def counts(self) -> Counter[str]:
        """What was not used as it came, by reason."""
        return self._rejections.counts

    @property
    def ready(self) -> bool:
        """Whether there is an estimate."""
        return self._history is not None

    @property
    def weightless(self) -> bool:
        """Whether it cannot begin, as the accelerometers measure no gravity."""
        return self._history is None and self.counts[WEIGHTLESS] > 0

    @property
    def stamp_ns(self) -> int:
        """Time of the newest estimate; it must be `ready`."""
        return self._started.newest_ns

    @property
    def sample_ns(self) -> int:
        """Time of the newest inertial sample; it must be `ready`."""
        return self._started.sample_ns

    @property
    def oldest_ns(self) -> int:
        """Time that the state buffer reaches back to; it must be `ready`."""
        return self._started.oldest_ns

    @property
    def state(self) -> NavigationState:
        """The newest estimate; it must be `ready`."""
        return self.at(self.stamp_ns)

    def at(self, time_ns: int) -> NavigationState:
        """The estimate at exactly that instant, or the oldest that is kept if that is later (see its stamp)."""
        estimate = self._started.at(time_ns)
        return NavigationState(estimate.stamp_ns, estimate.x, estimate.P)

    def pose(self, time_ns: int) -> Transform:
        """T_map_base at an instant, without the cost of its covariance."""
        (x,) = self._started.states_at(time_ns, AT_ONCE)
        return Transform(x[4:7], x[:4])

    def poses(self, from_ns: int, since_ns: Int64s) -> Float64s:
        """Attitudes and positions at instants (k,) after `from_ns`, (k, 19) with what the state holds besides."""
        return self._started.states_at(from_ns, since_ns)

    def motion_at(self, times_ns: Sequence[int]) -> Float64s:
        """(k, 10) position, attitude, and velocity in the map at k instants."""
        from_ns = min(times_ns)
        return self._started.states_at(from_ns, np.array(times_ns) - from_ns).take(MOTION, axis=1)

    def planar(self, time_ns: int) -> PlanarGaussian:
        """The estimate at an instant projected on the plane."""
        return projected(self.at(time_ns))

    def predict(self, imu: Imu, hit: float = 0.0) -> None:
        """Eqs. (1)-(3) up to a sample; one that is broken, sent again or late is counted and dropped.

        hit: rad/s by which the base may have turned besides, just before.
        """
        sample, fault = self._imu_check.check(imu, self._config, hit)
        if fault:
            self.counts[fault] += 1
        if sample is None:
            return
        if self._history is None:
            self._level(imu.stamp_ns, sample)
        else:
            self._add_sample(imu.stamp_ns, sample, self._history)

    def _add_sample(self, stamp_ns: int, sample: Float64s, history: History) -> None:
        """A good sample once there is an estimate: its stamp shows whether it continues the last one."""
        sample_ns = history.sample_ns
        if 0 < stamp_ns - sample_ns <= MAX_GAP_NS:
            self._imu_check.goes_on()
            history.add_sample(stamp_ns, sample)
        elif self._imu_check.set_back(stamp_ns, sample_ns):
            self.counts[SET_BACK] += 1
            self._history, self.begin_ns = history.begin_again(stamp_ns, sample), stamp_ns
        elif stamp_ns <= sample_ns:
            self.counts[NOT_LATER] += 1
        elif not self._accepts_stamp(stamp_ns):
            self.counts[FAR_AHEAD] += 1
        else:
            if stamp_ns - self.sample_ns > MAX_GAP_NS:
                self.counts[GAP] += 1
            self._started.add_sample(stamp_ns, sample)

    def begin_at(self, pose: PlanarGaussian) -> None:
        """Put the newest estimate at a planar pose of the planar model; it must be `ready`."""
        self._history = self._started.begun_at(pose)
        self.begin_ns = self.oldest_ns

    def fuse_planar(
        self,
        time_ns: int,
        xi: Float64s,
        R: Float64s,
        omega: float,
        method: FusionMethod = "fixed",
        gate: float = 0.0,
        *,
        unobservable: Float64s = NOWHERE,
        widen_vertical: bool = True,
    ) -> NavigationState:
        """Eqs. (18)-(20) with a match at a time: the state there, unchanged if the match cannot be used.

        xi: (3,) x, y, psi in metres and radians. R: (3, 3). unobservable, widen_vertical: see PlanarPose.
        Arrays are kept as they are, for as long as the history lasts.
        """
        self.correct(time_ns, PlanarPose(xi, R, omega, method, gate, unobservable, widen_vertical))
        return self.at(time_ns)

    def reset_pose(self, time_ns: int, pose: PlanarGaussian) -> None:
        """Continue at a planar pose at a time, wherever the base was estimated before."""
        self.correct(time_ns, PoseReset(pose))

    def update_height(self, time_ns: int, height: float) -> bool:
        """A height over the start, metres. See `correct`."""
        return self.correct(time_ns, HeightAid(height, self._config.height_sigma, self._config.height_gate))

    def update_velocity_body(self, time_ns: int, velocity: Float64s, sigma: float) -> bool:
        """A velocity in the axes of the base, (2,) forward and left or (3,), m/s. See `correct`."""
        return self.correct(time_ns, BodyVelocity(np.array(velocity), sigma))

    def correct(self, time_ns: int, correction: Correction) -> bool:
        """Any other measurement, at its own time. Whether it came to its gate: what cannot be used is counted."""
        reason = self._refusal(time_ns, correction)
        if reason:
            self.drop(correction.source, reason)
        return not reason

    def drop(self, source: str, reason: str) -> None:
        """Count a measurement of a source that is of no use."""
        self._rejections.drop(source, reason)

    @property
    def aiding(self) -> tuple[AidingStatus, ...]:
        """The status of every source, up to the newest estimate."""
        return self._rejections.statuses(self._history.statuses() if self._history else {})

    @property
    def _started(self) -> History:
        if self._history is None:
            raise RuntimeError("the filter has no attitude yet: ask `ready` first")
        return self._history

    def _level(self, stamp_ns: int, sample: Float64s) -> None:
        """Collect the first samples until they span the levelling time, then begin."""
        since_ns = stamp_ns - self._first[-1][0] if self._first else MAX_GAP_NS
        if abs(since_ns) > MAX_GAP_NS:
            self._first.clear()
        elif since_ns <= 0:
            self.counts[NOT_LATER] += 1
            return
        self._first.append((stamp_ns, sample.copy()))
        if stamp_ns - self._first[0][0] < self._config.level_time * 1e9:
            return
        samples, stamps = np.array([s[:6] for _, s in self._first]), [t for t, _ in self._first]
        self.begins_in_motion = self._config.start_in_motion and (
            self.moves or not is_still(samples, self._config)
        )
        if self.begins_in_motion:
            estimate = moving_state(samples, stamps, self._config, self._platform)
        else:
            estimate = initial_state(samples, self._config, self._platform)
        self._first.clear()
        if estimate is None:
            self.counts[WEIGHTLESS] += 1
        else:
            self.begin_ns = stamp_ns
            self._history = History(stamp_ns, sample, *estimate)
            self._history.configure(self._config, self._platform)

    def _refusal(self, time_ns: int, correction: Correction) -> str:
        """Why a correction cannot be applied; empty once it is."""
        if self._history is None:
            return TOO_EARLY
        if not correction.usable:
            return UNUSABLE
        if not self._accepts_stamp(time_ns):
            return FAR_AHEAD
        if not self._started.add_correction(time_ns, correction):
            return TOO_EARLY if time_ns < self.begin_ns else TOO_OLD
        return ""

    def _accepts_stamp(self, stamp_ns: int) -> bool:
        """Whether a stamp is accepted: one far ahead needs a second that confirms it."""
        if stamp_ns - self.stamp_ns <= LEAP_NS:
            return True
        confirmed = 0 <= stamp_ns - self._suspect_ns <= LEAP_NS
        self._suspect_ns = stamp_ns
        if confirmed:
            self.counts[LEAPT] += 1
            self._history, self.begin_ns = self._started.begin_again(stamp_ns - 1), stamp_ns - 1
        return confirmed


def projected(state: NavigationState) -> PlanarGaussian:
    """An estimate projected on the plane: C x and C P C^T."""
    seen = PlanarGaussian(np.empty(3), np.empty((3, 3)))
    planar_estimate(state.x, state.covariance, *seen)
    return seen
