"""What a source's data shows of its sensors: gravity, the turns of each, when beams are measured."""

from dataclasses import dataclass

import numpy as np

from hectorscope.checks.beam_times import BeamTimes
from hectorscope.checks.contradictions import Agreement, Gravity, compare_tilts, compare_turns, gravity, yaw_rates
from hectorscope.checks.matched_scans import MatchedScans
from hectorscope.inputs import Item
from hectorscope.run.warmup import warm_up
from slam_core.config import ScanConfig
from slam_core.geometry import heading
from slam_core.measurements import PLAUSIBLE, Float64s, Imu, LaserScan, Odometry, TruthPose
from slam_core.scan.smoothing import Smoothing

LONGEST_S = 120.0  # what is stamped further than this from the first item is not looked at
FEWEST_SAMPLES = 20
FEWEST_SPANS = 12
SURE = 0.7  # correlation
TURNED = 0.005  # rad in a span of turning: less is a robot that drives straight on
TILTED = 0.03  # rad in a span of tilting, likewise
TRUTH_STEP_S = 0.02  # motion capture may give several poses within a millisecond, whose rates are noise


@dataclass(frozen=True, slots=True)
class Measures:
    """What could be measured; None where the data does not show it.

    turn: the gyroscope's turn about the vertical, against that of the scans. wheels: the odometry's, likewise.
    tilt: the gyroscope against the way gravity moves through the IMU. truth: the turns of the true poses, as of
    the gyroscope. times: when the beams of a sweep are measured.
    """

    gravity: Gravity | None = None
    turn: Agreement | None = None
    wheels: Agreement | None = None
    tilt: Agreement | None = None
    truth: Agreement | None = None
    times: BeamTimes | None = None

    @property
    def has_turn(self) -> bool:
        """Whether it is known how another sensor turns against the scans."""
        return self.turn is not None or self.wheels is not None

    @property
    def has_times(self) -> bool:
        """Whether it is sure when beams are measured."""
        return self.times is not None and self.times.is_sure


class SensorStatistics:
    """Takes the items of a source as they come. with_truth: the true poses are compared, too."""

    def __init__(self, *, with_truth: bool = False) -> None:
        self._with_truth = with_truth
        self._truth: list[tuple[float, float]] = []
        self._begin_ns: int | None = None
        self._imu: list[tuple[float, ...]] = []
        self._wheels: list[tuple[float, ...]] = []
        self._matched = MatchedScans()

    def take(self, item: Item) -> float:
        """Remember what matters; seconds since the first item."""
        if self._begin_ns is None:
            self._begin_ns = item.stamp_ns
        time = self._seconds(item.stamp_ns)
        if abs(time) > LONGEST_S:
            return time
        if isinstance(item, Imu):
            _keep(self._imu, time, *item.angular_velocity, *item.linear_acceleration)
        elif isinstance(item, Odometry):
            _keep(self._wheels, time, item.yaw_rate)
        elif isinstance(item, LaserScan):
            self._matched.add(item)
        elif isinstance(item, TruthPose) and self._with_truth:
            self._truth.append((time, heading(item.T_map_base.rotation)))
        return time

    @property
    def comparable(self) -> bool:
        """Whether anything but the scans measures turns, or the scans show when their beams are measured."""
        return bool(self._imu or self._wheels or self._truth) or self.show_times

    @property
    def show_times(self) -> bool:
        """Whether the scans show when their beams are measured, once the robot turns."""
        return self._matched.show_times

    def at_rest(self) -> Measures:
        """What is known before anything turns, and without matching a scan."""
        forces = np.array(self._imu)[:, 4:7] if len(self._imu) >= FEWEST_SAMPLES else None
        return Measures() if forces is None else Measures(gravity=gravity(forces))

    def measures(self) -> Measures:
        """All that is known so far. Scans are matched without the sensors that are checked."""
        times = self._matched.times()
        sweep_s = times.sweep_s if times and times.are_wrong else None
        headings = self._matched.headings(self._begin_ns or 0, sweep_s) if self.comparable else np.empty((0, 2))
        imu = np.array(self._imu)
        wheels = _sure(_turns(headings, np.array(self._wheels)), TURNED)
        truth = _sure(_turns(headings, _rates(self._truth)), TURNED)
        if len(imu) < FEWEST_SAMPLES:
            return Measures(wheels=wheels, truth=truth, times=times)
        seconds, rates, forces = imu[:, 0], imu[:, 1:4], imu[:, 4:7]
        measured = np.column_stack([seconds, yaw_rates(seconds, rates, forces)])
        return Measures(
            gravity=gravity(forces),
            turn=_sure(_turns(headings, measured), TURNED),
            wheels=wheels,
            tilt=_sure(compare_tilts(seconds, rates, forces), TILTED),
            truth=truth,
            times=times,
        )

    def range_noise(self) -> list[tuple[float, float]]:
        """Ranges (m) of the laser, and the noise (m) that the scans show of each."""
        smoothing = Smoothing()
        if self._matched.scans:
            warm_up()
        for scan in self._matched.scans:
            smoothing.learn(scan, ScanConfig())
        return smoothing.known

    def _seconds(self, stamp_ns: int) -> float:
        return (stamp_ns - (self._begin_ns or 0)) * 1e-9


def _keep(samples: list[tuple[float, ...]], time: float, *values: float) -> None:
    """Of what a damaged message holds nothing: one such value would be all that is left of a mean."""
    if all(abs(value) < PLAUSIBLE for value in values):
        samples.append((time, *values))


def _rates(headings: list[tuple[float, float]]) -> Float64s:
    """(m, 2) seconds and rate of turn, of headings at times that may come in bursts."""
    known = np.array(headings).reshape(-1, 2)
    if len(known) < FEWEST_SAMPLES:
        return known[:0]
    known = known[np.argsort(known[:, 0], kind="stable")]
    times = np.arange(known[0, 0], known[-1, 0], TRUTH_STEP_S)
    yaw = np.interp(times, known[:, 0], np.unwrap(known[:, 1]))
    return np.column_stack([times[:-1] + 0.5 * TRUTH_STEP_S, np.diff(yaw) / TRUTH_STEP_S])


def _turns(headings: Float64s, rates: Float64s) -> Agreement | None:
    if len(headings) < FEWEST_SAMPLES or len(rates) < FEWEST_SAMPLES:
        return None
    return compare_turns(headings[:, 0], headings[:, 1], rates[:, 0], rates[:, 1])


def _sure(agreement: Agreement | None, moved: float) -> Agreement | None:
    """The agreement, if there was enough motion for it."""
    if agreement is None or agreement.spans < FEWEST_SPANS or agreement.moved < moved:
        return None
    return agreement if abs(agreement.correlation) >= SURE else None
