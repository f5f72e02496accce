"""Section V-A: the navigation filter, an error-state Kalman filter on attitude, position, velocity and biases.

The attitude is a quaternion and its error a small rotation about the map's axes, so no attitude is special.
"""

from collections import Counter
from dataclasses import replace

import numpy as np

from slam_core.aiding import BodyVelocity, Correction, HeightAid, PlanarPose, observer, project
from slam_core.config import NavigationConfig
from slam_core.history import MAX_GAP_NS, History
from slam_core.kernels.navigation import sandwich, within
from slam_core.leveling import start_belief
from slam_core.measurements import Float64s, Imu, Transform
from slam_core.results import AidingStatus, NavigationState, PlanarGaussian
from slam_core.strapdown import Strapdown

# No robot turns (rad/s) or accelerates (m/s²) like this: such a sample is broken.
SAMPLE_LIMITS = np.array([200.0] * 3 + [2000.0] * 3)
# A stamp this far ahead is believed only when the next one confirms it.
LEAP_NS = 10_000_000_000


class NavigationFilter:
    """Predict with every inertial sample; correct with everything else, at its own time, in any order.

    ready: whether the filter has found its attitude; before that, corrections are counted and dropped.
    counts: what was not used as it came, by reason.
    """

    def __init__(self, config: NavigationConfig) -> None:
        self.counts: Counter[str] = Counter()
        self._dropped: dict[str, Counter[str]] = {}
        self._config = config
        self._model = Strapdown(config)
        self._first: list[tuple[int, Float64s]] = []
        self._history: History | None = None
        self._doubted_ns = 0

    def configure(self, config: NavigationConfig) -> None:
        """Change settings from the next measurement on."""
        self._config = config
        self._model = Strapdown(config)

    def copy(self) -> "NavigationFilter":
        """An independent copy."""
        other = NavigationFilter(self._config)
        other.counts = self.counts.copy()
        other._dropped = {source: reasons.copy() for source, reasons in self._dropped.items()}
        other._first = self._first.copy()
        other._history = self._history.copy() if self._history else None
        other._doubted_ns = self._doubted_ns
        return other

    @property
    def ready(self) -> bool:
        """Whether there is a belief."""
        return self._history is not None

    @property
    def stamp_ns(self) -> int:
        """Time of the newest belief; it must be `ready`."""
        return self._belief.newest.stamp_ns

    @property
    def state(self) -> NavigationState:
        """The newest belief; it must be `ready`."""
        return self.at(self.stamp_ns)

    def at(self, time_ns: int) -> NavigationState:
        """The belief at exactly that instant, or the oldest that is kept if that is later (see its stamp)."""
        return _as_state(*self._belief.at(time_ns, self._model))

    def pose(self, time_ns: int) -> Transform:
        """T_map_base at an instant, without the cost of its covariance."""
        x = self._belief.state_at(time_ns, self._model)
        return Transform(x[4:7], x[:4])

    def planar(self, time_ns: int) -> PlanarGaussian:
        """The belief at an instant projected on the plane: C x and C P C^T."""
        _, x, P = self._belief.at(time_ns, self._model)
        return PlanarGaussian(project(x), sandwich(observer(x), P))

    def predict(self, imu: Imu) -> None:
        """Eqs. (1)-(3) up to a sample; one that is broken, repeated or late is counted and dropped."""
        sample = np.concatenate([imu.angular_velocity, imu.linear_acceleration])
        if not within(sample, SAMPLE_LIMITS):
            self.counts["inertial sample without a plausible value"] += 1
        elif self._history is None:
            self._level(imu.stamp_ns, sample)
        elif imu.stamp_ns <= self._history.sample_ns:
            self.counts["inertial sample not later than the one before"] += 1
        elif self._believes(imu.stamp_ns):
            if imu.stamp_ns - self._history.sample_ns > MAX_GAP_NS:
                self.counts["gap in the inertial data"] += 1
            self._history.add_sample(imu.stamp_ns, sample, self._model)
        else:
            self.counts["stamp far ahead"] += 1

    def fuse_planar(
        self, time_ns: int, xi: Float64s, R: Float64s, omega: float, gate: float = 0.0
    ) -> tuple[NavigationState, NavigationState]:
        """Eqs. (18)-(20) with a match at an instant: the belief there before and after; it must be `ready`.

        xi: (3,) x, y, psi in metres and radians. R: (3, 3). The same belief twice if the match is of no use.
        """
        before = self.at(time_ns)
        taken = self.correct(time_ns, PlanarPose(np.array(xi), np.array(R), omega, gate))
        return before, self.at(time_ns) if taken else before

    def update_height(self, time_ns: int, height: float, sigma: float | None = None) -> bool:
        """A height over the start, metres; sigma from the configuration if not given. See `correct`."""
        config = self._config
        return self.correct(time_ns, HeightAid(height, sigma or config.height_sigma, config.height_gate))

    def update_velocity_body(self, time_ns: int, velocity: Float64s, sigma: float, gate: float = 0.0) -> bool:
        """A velocity in the axes of the base, (2,) forward and left or (3,), m/s. See `correct`."""
        return self.correct(time_ns, BodyVelocity(np.array(velocity), sigma, gate))

    def correct(self, time_ns: int, correction: Correction) -> bool:
        """Any other measurement, at its own time. Whether it came to its gate: what cannot be used is counted."""
        reason = self._refusal(time_ns, correction)
        if reason:
            self.drop(correction.source, reason)
        return not reason

    def drop(self, source: str, reason: str) -> None:
        """Count a measurement of a source that is of no use."""
        self.counts[reason] += 1
        self._dropped.setdefault(source, Counter())[reason] += 1

    @property
    def aiding(self) -> tuple[AidingStatus, ...]:
        """What became of the measurements of every source that was heard, up to the newest belief."""
        statuses = dict(self._history.newest.statuses) if self._history else {}
        for source, reasons in self._dropped.items():
            known = statuses.get(source) or AidingStatus(source)
            statuses[source] = replace(known, dropped=dict(reasons))
        return tuple(statuses.values())

    @property
    def _belief(self) -> History:
        if self._history is None:
            raise RuntimeError("the filter has no attitude yet: ask `ready` first")
        return self._history

    def _level(self, stamp_ns: int, sample: Float64s) -> None:
        """Collect the first samples until they span the levelling time, then begin."""
        if self._first and not 0 < stamp_ns - self._first[-1][0] <= MAX_GAP_NS:
            self._first.clear()
        self._first.append((stamp_ns, sample))
        if stamp_ns - self._first[0][0] < self._config.level_time * 1e9:
            return
        belief = start_belief(np.array([s for _, s in self._first]), self._config)
        self._first.clear()
        if belief is None:
            self.counts["start without gravity in the accelerometers"] += 1
        else:
            self._history = History(stamp_ns, sample, *belief)

    def _refusal(self, time_ns: int, correction: Correction) -> str:
        """Why a correction cannot be applied; empty once it is."""
        if self._history is None:
            return "correction before the attitude was known"
        if not correction.usable:
            return "correction without a usable value"
        if not self._believes(time_ns):
            return "stamp far ahead"
        if not self._history.add_correction(time_ns, correction, self._model):
            return "correction older than the history"
        return ""

    def _believes(self, stamp_ns: int) -> bool:
        """Whether a stamp may be true: a single one far ahead would carry the filter off for good."""
        if stamp_ns - self.stamp_ns <= LEAP_NS or 0 <= stamp_ns - self._doubted_ns <= LEAP_NS:
            return True
        self._doubted_ns = stamp_ns
        return False


def _as_state(stamp_ns: int, x: Float64s, P: Float64s) -> NavigationState:
    return NavigationState(stamp_ns, Transform(x[4:7], x[:4]), x[7:10], x[10:13], x[13:16], P)
