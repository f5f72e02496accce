"""One row of figures for every scan: what the plots draw and the metrics are computed from."""

import math

import numpy as np

from app.snapshot import SERIES_FIELDS
from slam_core.geometry import to_euler
from slam_core.measurements import Float64s
from slam_core.results import NavigationState, StepResult

_NAN = float("nan")
_NO_SIGMAS = _NAN, _NAN, _NAN


def series_row(result: StepResult, time_s: float, map_updates: int) -> tuple[float, ...]:
    """The values of SERIES_FIELDS, nan where this scan has none. time_s: seconds since the start."""
    match, durations = result.match, result.durations
    row = (
        time_s,
        *result.T_map_base.translation.tolist(),
        *to_euler(result.T_map_base.rotation),
        *(_sigmas(match.covariance) if match else _NO_SIGMAS),
        *(_sigmas(result.prior.covariance) if result.prior else _NO_SIGMAS),
        *_sigmas(result.fused.covariance),
        match.mean_residual if match else _NAN,
        sum(match.iterations) if match else 0,
        result.beams,
        map_updates,
        match.weakest_sigma if match else _NAN,
        np.count_nonzero(result.unexpected) / len(result.unexpected),
        match.weakest_share if match else _NAN,
        *_navigation(result.navigation),
        durations.stabilise / 1e6,
        durations.match / 1e6,
        durations.update / 1e6,
        durations.filter / 1e6,
    )
    assert len(row) == len(SERIES_FIELDS)
    return row


def _sigmas(covariance: Float64s) -> tuple[float, float, float]:
    (xx, _, _), (_, yy, _), (_, _, turn) = covariance.tolist()
    return math.sqrt(max(0.0, xx)), math.sqrt(max(0.0, yy)), math.sqrt(max(0.0, turn))


def _navigation(state: NavigationState | None) -> tuple[float, ...]:
    if state is None:
        return (_NAN,) * 9
    vx, vy, vz, *biases = state.x[7:16].tolist()
    return (*biases, vx, vy, vz)
