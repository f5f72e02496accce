"""One row of figures for every scan: what the plots draw and the metrics are computed from."""

import math

import numpy as np

from app.snapshot import SERIES_FIELDS
from slam_core.geometry import to_euler
from slam_core.results import NavigationState, PlanarGaussian, StepResult

_NAN = float("nan")


def series_row(result: StepResult, time_s: float, map_updates: int) -> tuple[float, ...]:
    """The values of SERIES_FIELDS, nan where this scan has none. time_s: seconds since the start."""
    match, durations = result.match, result.durations
    row = (
        time_s,
        *result.T_map_base.translation.tolist(),
        *to_euler(result.T_map_base.rotation),
        *_sigmas(match.gaussian if match else None),
        *_sigmas(result.prior),
        *_sigmas(result.fused),
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


def _sigmas(gaussian: PlanarGaussian | None) -> tuple[float, float, float]:
    if gaussian is None:
        return _NAN, _NAN, _NAN
    (xx, _, _), (_, yy, _), (_, _, turn) = gaussian.covariance.tolist()
    return math.sqrt(max(0.0, xx)), math.sqrt(max(0.0, yy)), math.sqrt(max(0.0, turn))


def _navigation(state: NavigationState | None) -> tuple[float, ...]:
    if state is None:
        return (_NAN,) * 9
    return (*state.gyro_bias.tolist(), *state.accel_bias.tolist(), *state.velocity.tolist())
