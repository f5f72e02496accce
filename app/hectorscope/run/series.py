"""One row of figures for every scan: what the plots draw and the metrics are computed from."""

import math
from typing import get_args

import numpy as np

from slam_core.geometry import to_euler
from slam_core.measurements import Float64s
from slam_core.results import NavigationState, StepResult, Tracking

TRACKING: tuple[Tracking, ...] = get_args(Tracking)  # what the numbers of the column stand for

# One row a scan; the plots and metrics read columns by name. All float64 seconds, metres, radians.
SERIES_FIELDS = (
    "time_s", "x", "y", "z", "roll", "pitch", "yaw",
    "match_sigma_x", "match_sigma_y", "match_sigma_yaw",
    "prior_sigma_x", "prior_sigma_y", "prior_sigma_yaw",
    "fused_sigma_x", "fused_sigma_y", "fused_sigma_yaw",
    "residual", "iterations", "beams", "map_updates", "weakest_sigma", "unexpected", "weakest_share", "fit",
    "gyro_bias_x", "gyro_bias_y", "gyro_bias_z", "accel_bias_x", "accel_bias_y", "accel_bias_z",
    "vx", "vy", "vz",
    "stabilise_ms", "match_ms", "update_ms", "filter_ms", "tracking",
)  # fmt: skip
DURATIONS = range(SERIES_FIELDS.index("stabilise_ms"), SERIES_FIELDS.index("filter_ms") + 1)
"""The columns that differ from one processing of a scan to the next."""
SERIES_DTYPE = np.dtype([(name, np.float64) for name in SERIES_FIELDS])

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
        match.fit.hit if match else _NAN,
        *_navigation(result.navigation),
        durations.stabilise / 1e6,
        durations.match / 1e6,
        durations.update / 1e6,
        durations.filter / 1e6,
        TRACKING.index(result.tracking),
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
