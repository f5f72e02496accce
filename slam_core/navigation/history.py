"""The last seconds of the filter: a late measurement is applied at its own time, and all after it again.

The estimate is a function of the measurements, in any order of arrival. It is computed on request: a
correction that is always late costs no more than one in time, and samples are run through in one piece.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

from slam_core.config import NavigationConfig, PlatformConfig
from slam_core.measurements import Float64s, Int64s
from slam_core.navigation.corrections import Correction
from slam_core.navigation.gates import fuse
from slam_core.navigation.imu_buffer import ImuBuffer
from slam_core.navigation.initial_alignment import with_pose
from slam_core.navigation.state_buffer import StateBuffer
from slam_core.navigation.strapdown import Strapdown
from slam_core.results import AidingStatus, PlanarGaussian

MOST_CORRECTIONS = 2048
SET_SPAN = 1.0  # s: after a clock was set back, the base may have moved for about this long
GAP_SPAN = 5.0  # s: the same where it seems to be set ahead, as it is more often a gap in the data


class Estimate(NamedTuple):
    """State, covariance, and what became of every source's measurements, at one instant."""

    stamp_ns: int
    x: Float64s
    P: Float64s
    statuses: Mapping[str, AidingStatus]


class History:
    """Samples and corrections in order of time, and estimates: the oldest, and after each correction computed.

    Since one of them is propagated again and again, its estimates at the samples after it are kept in a
    StateBuffer; the last one that was asked for is kept, too.
    """

    def __init__(self, stamp_ns: int, sample: Float64s, x: Float64s, P: Float64s) -> None:
        self._samples = ImuBuffer()
        self._samples.append(stamp_ns, sample)
        self._corrections: list[tuple[int, Correction]] = []
        self._estimates = [Estimate(stamp_ns, x, P, {})]
        self._settled = 0  # the last of them that does not follow from the first with the settings of now
        self._base = self._asked = self._estimates[0]
        self._buffer = StateBuffer(stamp_ns, x, P)

    def configure(self, config: NavigationConfig, platform: PlatformConfig) -> None:
        """The settings that hold from now on; needed before anything else."""
        self._model = Strapdown(config, platform)
        self._reset_time_ns = round(config.gate_reset_time * 1e9)
        self._kept_ns = round(config.history * 1e9)
        self._settled = len(self._estimates) - 1

    def __getstate__(self) -> dict[str, object]:
        """To be kept: without the estimates that follow from the rest, which are most of it."""
        base = next((k for k, estimate in enumerate(self._estimates) if estimate is self._base), None)
        kept = self._estimates[: self._settled + 1]
        return self.__dict__ | {"_estimates": kept, "_left_out": (len(self._estimates), base)}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """As it was: the same estimates are computed again, now, as settings may change before they are needed."""
        count, at = state.pop("_left_out")
        self.__dict__.update(state)
        base, asked, buffer = self._base, self._asked, self._buffer
        self._base, self._buffer = base._replace(), buffer.copy()  # of none of the estimates
        self._after(count - 1)
        if at is not None:
            self._estimates[at] = base
        self._base, self._asked, self._buffer = base, asked, buffer

    @property
    def sample_ns(self) -> int:
        """Time of the latest sample."""
        return self._samples.last_ns

    @property
    def oldest_ns(self) -> int:
        """Time that it reaches back to."""
        return self._estimates[0].stamp_ns

    @property
    def newest_ns(self) -> int:
        """Time of the latest measurement of any kind."""
        return max(self.sample_ns, self._corrections[-1][0]) if self._corrections else self.sample_ns

    def at(self, time_ns: int) -> Estimate:
        """The estimate at an instant; the oldest one for an instant before it."""
        return self._predicted(self._after(self._corrections_until(time_ns)), time_ns)

    def states_at(self, from_ns: int, since_ns: Int64s) -> Float64s:
        """The x alone at instants (k,) after `from_ns`, (k, 19); later corrections than that are left out.

        The estimate at the last of them is kept.
        """
        base = self._after(self._corrections_until(from_ns))
        self._buffer_from(base)
        time_ns = from_ns + since_ns.item(-1)
        x, P, states = self._buffer.estimate(time_ns, self._model, self._samples, from_ns, since_ns)
        self._asked = Estimate(time_ns, x, P, base.statuses)
        return states

    def statuses(self) -> Mapping[str, AidingStatus]:
        """What became of every source's measurements."""
        return self._after(len(self._corrections)).statuses

    def add_sample(self, stamp_ns: int, sample: Float64s) -> None:
        """Go on with an inertial sample (8,) later than the last one."""
        before_ns = self._samples.last_ns
        self._samples.append(stamp_ns, sample)
        # Estimates beyond the sample before used an assumed input.
        while len(self._estimates) > 1 and self._estimates[-1].stamp_ns > before_ns:
            self._estimates.pop()
        self._settled = min(self._settled, len(self._estimates) - 1)
        if self._asked.stamp_ns > before_ns:
            self._asked = self._base
        if stamp_ns - self._estimates[0].stamp_ns > 2 * self._kept_ns:
            self._forget(stamp_ns - self._kept_ns)

    def add_correction(self, stamp_ns: int, correction: Correction) -> bool:
        """Apply a correction at its time; False if it is too old."""
        if stamp_ns < self._estimates[0].stamp_ns:
            return False
        i = self._corrections_until(stamp_ns)
        self._corrections.insert(i, (stamp_ns, correction))
        del self._estimates[i + 1 :]
        self._settled = min(self._settled, i)
        if len(self._corrections) > MOST_CORRECTIONS:
            self._forget(self._corrections[MOST_CORRECTIONS // 2][0])
        return True

    def begun_at(self, pose: PlanarGaussian) -> "History":
        """A history that begins with the newest sample and its estimate, but at this pose in the plane."""
        last = self.at(self.sample_ns)
        return self._begun(last.stamp_ns, self._samples.last, *with_pose(last.x, last.P, pose))

    def begin_again(self, stamp_ns: int, sample: Float64s | None = None) -> "History":
        """A history on a clock that was set: it begins with the newest estimate, with a larger covariance."""
        span = SET_SPAN if stamp_ns < self.newest_ns else GAP_SPAN
        last = self.at(self.newest_ns)
        sample = self._samples.last if sample is None else sample
        other = self._begun(stamp_ns, sample, last.x, self._model.coast(last.x, last.P, span))
        statuses = {k: s._replace(stamp_ns=stamp_ns, used_ns=stamp_ns, streak=0) for k, s in last.statuses.items()}
        other._estimates = [other._estimates[0]._replace(statuses=statuses)]
        return other

    def _begun(self, stamp_ns: int, sample: Float64s, x: Float64s, P: Float64s) -> "History":
        other = History(stamp_ns, sample, x, P)
        other._model, other._reset_time_ns, other._kept_ns = self._model, self._reset_time_ns, self._kept_ns
        return other

    def _corrections_until(self, time_ns: int) -> int:
        """How many are not later than an instant: from the newest on, as it is nearly always one of the last."""
        i, corrections = len(self._corrections), self._corrections
        while i and corrections[i - 1][0] > time_ns:
            i -= 1
        return i

    def _after(self, count: int) -> Estimate:
        """The estimate after so many corrections."""
        while len(self._estimates) <= count:
            stamp_ns, correction = self._corrections[len(self._estimates) - 1]
            _, x, P, statuses = self._predicted(self._estimates[-1], stamp_ns)
            fused = fuse(x, P, statuses, stamp_ns, correction, self._reset_time_ns)
            self._estimates.append(Estimate(stamp_ns, *fused))
        return self._estimates[count]

    def _predicted(self, base: Estimate, time_ns: int) -> Estimate:
        """An estimate propagated through the samples; the last one is kept, as each scan needs it three times."""
        if time_ns <= base.stamp_ns:
            return base
        if self._base is not base or self._asked.stamp_ns != time_ns:
            self._buffer_from(base)
            x, P, _ = self._buffer.estimate(time_ns, self._model, self._samples)
            self._asked = Estimate(time_ns, x, P, base.statuses)
        return self._asked

    def _buffer_from(self, base: Estimate) -> None:
        """The state buffer is that of the estimate that is propagated."""
        if self._base is not base:
            self._base = self._asked = base
            self._buffer.begin(base.stamp_ns, base.x, base.P)

    def _forget(self, before_ns: int) -> None:
        """Begin with the estimate at the last sample or correction before an instant."""
        count = self._corrections_until(before_ns)
        oldest = self._after(count)
        sample_ns = self._samples.until(before_ns)
        if sample_ns > oldest.stamp_ns:
            oldest = self._predicted(oldest, sample_ns)
        if self._base is self._estimates[count]:
            self._base, self._buffer = oldest, self._buffer.since(oldest.stamp_ns, oldest.x, oldest.P)
        self._estimates[: count + 1] = [oldest]
        self._settled = max(0, self._settled - count)
        del self._corrections[:count]
        self._samples.drop_before(self._samples.until(oldest.stamp_ns))
