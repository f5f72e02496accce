"""Runs the cases by both methods and measures their errors."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np

from benchmarks import returning
from benchmarks.cases import CELLS_ALONE, LOST_M, METHODS, Recording
from benchmarks.turned import angle_of, turned
from benchmarks.wheels import with_wheels
from hectorscope.inputs import Item
from hectorscope.run.metrics import truth_errors
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.series import SERIES_DTYPE
from hectorscope.run.settings import Settings
from hectorscope.simulation import SceneOptions, Simulation
from hectorscope.sources import open_source
from slam_core.config import SlamConfig, with_values
from slam_core.evaluation.trajectory import Trajectory, interpolate, rms
from slam_core.localization.prior_map import PriorMap
from slam_core.measurements import Float64s, Imu, Measurement
from slam_core.results import StepResult

Outcomes = dict[tuple[str, bool], "Outcome"]
"""By method and whether there was inertial data."""

WHEELED, BARE = "full, with wheels", "full, without IMU"  # further drives along the corridor


@dataclass(frozen=True, slots=True)
class Outcome:
    """Root mean square errors in metres: raw from the first pose on, aligned after the best rigid motion."""

    raw: float
    aligned: float

    @property
    def lost(self) -> bool:
        """Too far off for a map to be of use."""
        return not self.raw <= LOST_M


@dataclass(frozen=True, slots=True)
class CorridorOutcome:
    """Errors in metres along and across a corridor: root mean square, and at the end; and their covariance.

    sigma_end: along, of the fused pose, metres, when the scan last left that direction open. held_open, held: the
    share of the scans, of those until then and of all, whose error along lies within three such sigmas.
    """

    along: float
    across: float
    along_end: float
    sigma_end: float
    held_open: float
    held: float


@dataclass(frozen=True, slots=True)
class Replay:
    """A recording by one method: errors where there is a truth, metres from the first pose to the last.

    returned: share of the last scans' endpoints on the first map (`benchmarks.returning`); None without a return.
    """

    scans: int
    truth: Outcome | None
    start_to_end: float
    left_out: tuple[str, ...]
    returned: float | None = None


def process(items: Iterable[Item], config: SlamConfig, given: PriorMap | None = None) -> Pipeline:
    """Every item through the pipeline, which may begin with a map."""
    pipeline = Pipeline(Settings(config), prior_map=given)
    for _ in steps(pipeline, items):
        pass
    return pipeline


def steps(pipeline: Pipeline, items: Iterable[Item]) -> Iterator[StepResult]:
    """What the pipeline makes of each scan among the items."""
    waiting = (measurement for item in items for measurement in pipeline.admit(item))
    for measurement in chain(waiting, _flushed(pipeline)):
        result = pipeline.step(measurement)
        if result is not None:
            yield result


def _flushed(pipeline: Pipeline) -> Iterator[Measurement]:
    yield from pipeline.flush()


def drive(options: SceneOptions, seed: int) -> Outcomes:
    """One drive through the rooms, by both methods, with and without its inertial data; begun at some angle."""
    items = list(turned(_rooms(options, seed), angle_of(seed)))
    bare = [item for item in items if not isinstance(item, Imu)]
    return {
        (method, inertial): outcome(process(items if inertial else bare, config))
        for method, config in METHODS.items()
        for inertial in (True, False)
    }


def square(options: SceneOptions, seed: int) -> tuple[Outcome, Outcome]:
    """The drive with inertial data, begun square to the walls: by cells alone, and by the full method."""
    by_cells, full = (outcome(process(_rooms(options, seed), each)) for each in (CELLS_ALONE, METHODS["full"]))
    return by_cells, full


def _rooms(options: SceneOptions, seed: int) -> Iterator[Item]:
    return Simulation("rooms", replace(options, seed=seed)).items()


def corridor(options: SceneOptions, seed: int) -> dict[str, CorridorOutcome]:
    """One drive along the corridor by both methods, and by the full one with other sensors."""
    items = list(Simulation("corridor", replace(options, seed=seed)).items())
    drives = {method: (items, config) for method, config in METHODS.items()}
    drives[WHEELED] = list(with_wheels(items, seed)), METHODS["full"]
    drives[BARE] = [item for item in items if not isinstance(item, Imu)], METHODS["full"]
    return {name: along_and_across(process(*drive)) for name, drive in drives.items()}


def replay(recording: Recording) -> dict[str, Replay]:
    """A recording by both methods."""
    return {method: _replay(recording, config) for method, config in METHODS.items()}


def outcome(pipeline: Pipeline) -> Outcome:
    """Against the truth that came with the measurements."""
    errors = truth_errors(pipeline.trajectory, pipeline.truth)
    assert errors is not None
    return Outcome(errors["raw_rmse_m"], errors["aligned_rmse_m"])


def along_and_across(pipeline: Pipeline) -> CorridorOutcome:
    """The corridor runs along x of the map, and the truth begins at its origin."""
    truth, covered = interpolate(Trajectory.from_rows(pipeline.truth), pipeline.trajectory[:, 0])
    error = pipeline.trajectory[covered, 1:3] - truth.positions[:, :2]
    series = pipeline.series.view(SERIES_DTYPE).reshape(-1)[covered]
    sigma: Float64s = series["fused_sigma_x"]
    within = np.abs(error[:, 0]) <= 3 * sigma
    is_open = np.flatnonzero(series["weakest_share"] < SlamConfig().matcher.degeneracy_threshold)
    last = int(is_open[-1]) if len(is_open) else len(sigma) - 1
    return CorridorOutcome(
        along=rms(error[:, 0]),
        across=rms(error[:, 1]),
        along_end=abs(float(error[-1, 0])),
        sigma_end=float(sigma[last]),
        held_open=float(np.mean(within[: last + 1])),
        held=float(np.mean(within)),
    )


def _replay(recording: Recording, config: SlamConfig) -> Replay:
    source = open_source(str(recording.path), recording.options)
    pipeline, returned = returning.process(source.items(), with_values(config, dict(recording.settings)))
    first, last = pipeline.trajectory[[0, -1], 1:3]
    return Replay(
        scans=pipeline.scans,
        truth=outcome(pipeline) if len(pipeline.truth) else None,
        start_to_end=float(np.hypot(*(last - first))),
        left_out=tuple(f"{count} x {reason}" for reason, count in source.report.skipped.items()),
        returned=returned,
    )
