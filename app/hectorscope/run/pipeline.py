"""The core with what it leaves behind: the one path that the page and the headless run share."""

import time
from collections import Counter
from collections.abc import Mapping

import numpy as np

from hectorscope.inputs import Item, SourceError
from hectorscope.run.arrivals import Arrivals
from hectorscope.run.constant_rate import ConstantRate
from hectorscope.run.rows import GrowingRows, Rows
from hectorscope.run.series import DURATIONS, SERIES_FIELDS, series_row
from hectorscope.run.settings import Mode, Settings
from hectorscope.run.wording import arrival_text, diagnostic_text, moved_text, search_text, start_text
from slam_core.diagnostics import NO_ATTITUDE, Diagnostic
from slam_core.evaluation.trajectory import Trajectory, first_on_first, interpolate
from slam_core.localization.prior_map import PriorMap
from slam_core.measurements import Imu, LaserScan, Measurement, Transform, TruthPose
from slam_core.results import StepResult, Tracking
from slam_core.sequencer import Sequencer
from slam_core.slam import HectorSlam

# Results whose rows are written in one go: one by one between the scans, each would find the caches full of map.
TOGETHER = 32
FIRST = 256  # poses among which the truth is looked for first


class Pipeline:
    """Sequencer and HectorSlam, with the trajectory, the truth and the series of the scans so far.

    start_ns: what the seconds in the rows count from; None takes the first measurement's time. prior_map: the map
    to begin with. live: whether the items come from a stream, for the remedies in the warnings. The outcome is a
    function of these, the items and the settings alone: changes act between scans, at their times. warned: every
    warning so far, with the time and the number of scans when it came up first.
    """

    def __init__(
        self,
        settings: Settings,
        start_ns: int | None = None,
        prior_map: PriorMap | None = None,
        *,
        live: bool = False,
    ) -> None:
        self.settings = settings
        self._live = live
        self.slam = HectorSlam(settings.start, prior_map, time.perf_counter_ns)
        self.mode: Mode = "map" if prior_map is None else "continue" if prior_map.write else "localise"
        self.start_ns = start_ns
        self.last_scan_ns: int | None = None
        self.scans_read = 0
        self.result: StepResult | None = None
        self.states: Counter[Tracking] = Counter()
        self.warned: dict[str, tuple[int, int]] = {}
        self._arrivals = Arrivals()
        self._sequencer = Sequencer()
        self._passed_over: Counter[str] = Counter()
        self._unkept: list[tuple[StepResult, int]] = []
        self._trajectory = GrowingRows(8)
        self._truth = GrowingRows(8)
        self._series = GrowingRows(len(SERIES_FIELDS), DURATIONS)
        self._output = ConstantRate()
        self._truth_in_map: Rows | None = None

    def admit(self, item: Item) -> list[Measurement]:
        """Take in one item; the measurements that may be stepped now. Truth is kept, the core never sees it."""
        if self.start_ns is None:
            self.start_ns = item.stamp_ns
        if isinstance(item, TruthPose):
            self._truth.append(self._row(item.stamp_ns, item.T_map_base))
            return []
        self.scans_read += isinstance(item, LaserScan)
        self._arrivals.add(item)
        return self._sequencer.push(item)

    def flush(self) -> list[Measurement]:
        """What still waits for inertial data when there will be no more."""
        return self._sequencer.flush()

    def skip(self, reason: str) -> None:
        """A scan goes by unprocessed, for this reason."""
        self._passed_over[reason] += 1

    @property
    def skipped(self) -> Counter[str]:
        """Scans that gave no result, by reason."""
        return self.slam.status.skipped + self._passed_over

    def step(self, measurement: Measurement) -> StepResult | None:
        """Run the core on one measurement and keep what it brought."""
        if isinstance(measurement, Imu):
            return self.slam.step(measurement)
        self._output.follow(self.slam, self.start_ns or 0)
        if not isinstance(measurement, LaserScan):
            return self.slam.step(measurement)
        self._apply_changes(measurement.stamp_ns)
        self.last_scan_ns = measurement.stamp_ns
        result = self.slam.step(measurement)
        if result is not None:
            self._keep(result)
        self.warnings()
        return result

    def warnings(self) -> tuple[str, ...]:
        """What is wrong at this moment, a sentence each; `warned` keeps it with when it was first so."""
        wrong = (
            *(diagnostic_text(fault, live=self._live) for fault in self._diagnostics),
            *(arrival_text(fault, live=self._live) for fault in self._arrivals.faults),
        )
        for text in wrong:
            self.warned.setdefault(text, (self.time_ns, self.scans))
        return wrong

    @property
    def _diagnostics(self) -> tuple[Diagnostic, ...]:
        return self.slam.diagnostics + self._sequencer.diagnostics(self.time_ns)

    @property
    def searching(self) -> str:
        """Why the pose in the map is unknown at this moment; empty while it is known."""
        return search_text(self.slam.status.search_failure)

    @property
    def notes(self) -> tuple[str, ...]:
        """What is reported once: where in a prior map the run began, or why the trajectory begins late."""
        status = self.slam.status
        if status.moved_at_start and self.scans:
            return (moved_text(float(self.trajectory[0, 0])),)
        return (start_text(status.start_found),) if status.start_found else ()

    def _apply_changes(self, stamp_ns: int) -> None:
        config = self.settings.at(stamp_ns)
        if config is not self.slam.config:
            self.slam.configure(config)

    def _keep(self, result: StepResult) -> None:
        self.states[result.tracking] += 1
        self.result = result
        self._unkept.append((result, self.slam.map.updates))
        if len(self._unkept) == TOGETHER:
            self._write_rows()

    def _write_rows(self) -> None:
        """The rows of the last results."""
        for result, updates in self._unkept:
            row = self._row(result.stamp_ns, result.T_map_base)
            self._trajectory.append(row)
            self._series.append(series_row(result, row[0], updates))
        self._unkept.clear()

    def _row(self, stamp_ns: int, pose: Transform) -> tuple[float, ...]:
        return ((stamp_ns - (self.start_ns or 0)) / 1e9, *pose.translation.tolist(), *pose.rotation.tolist())

    @property
    def time_ns(self) -> int:
        """Where the run is: at its last scan, or at the start."""
        return (self.start_ns or 0) if self.last_scan_ns is None else self.last_scan_ns

    @property
    def scans(self) -> int:
        """Scans that gave a result."""
        return len(self._trajectory) + len(self._unkept)

    @property
    def trajectory(self) -> Rows:
        """(n, 8) seconds since the start, x, y, z, qw, qx, qy, qz; one row a result."""
        self._write_rows()
        return self._trajectory.view

    @property
    def navigation(self) -> Rows:
        """(n, 11) the same columns and the velocity in the map, a hundred times a second, predicted on to each."""
        return self._output.rows

    @property
    def truth(self) -> Rows:
        """The same columns, in the truth's own frame."""
        return self._truth.view

    @property
    def series(self) -> Rows:
        """(n, len(SERIES_FIELDS)); one row a result."""
        self._write_rows()
        return self._series.view

    @property
    def truth_in_map(self) -> Rows:
        """(4,) x, y, z, yaw that carry the truth into the map: at the first scan it covers, both are one."""
        if self._truth_in_map is None and self.scans:
            self._truth_in_map = _onto(self.truth, self.trajectory)
        return np.zeros(4) if self._truth_in_map is None else self._truth_in_map


def _onto(truth: Rows, trajectory: Rows) -> Rows | None:
    """The motion that puts `truth` (n, 8) on the first pose (m, 8) that it covers; None if it covers none."""
    # Nearly always it is one of the first, and all of them would take a jump in a long recording long.
    for poses in (trajectory[:FIRST], trajectory):
        known = truth[: np.searchsorted(truth[:, 0], poses[-1, 0]) + 1]
        there, covered = interpolate(Trajectory.from_rows(known), poses[:, 0])
        if covered.any():
            here = Trajectory.from_rows(poses[covered])
            x, y, yaw = first_on_first(there.planar, here.planar)
            return np.array([x, y, here.positions[0, 2] - there.positions[0, 2], yaw])
    return None


def nothing_used(name: str, skipped: Mapping[str, int], slam: HectorSlam) -> SourceError:
    """For a run without a single result: the reasons, the commonest first."""
    searching = search_text(slam.status.search_failure)
    if searching:
        return SourceError(
            f"{name}: the robot was not found in the map ({searching}): give --start X Y YAW or another --map"
        )
    if skipped.get(NO_ATTITUDE):
        return SourceError(
            f"{name}: no scan could be used, as the inertial data gave no attitude"
            f" ({_counted(slam.status.unused)}): check the IMU, leave it out by --imu-topic none, or, if the"
            " recording is short and begins in motion, give --navigation.start-in-motion false"
        )
    return SourceError(f"{name}: no scan could be used ({_counted(skipped)}): choose other topics or wider limits")


def _counted(reasons: Mapping[str, int]) -> str:
    """The commonest first."""
    ordered = sorted(reasons.items(), key=lambda item: -item[1])
    return "; ".join(f"{count} x {reason}" for reason, count in ordered) or "it holds none"
