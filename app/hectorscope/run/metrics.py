"""The figures of a run, as plain values for metrics.json."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hectorscope.inputs import SourceReport
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.rows import Rows
from hectorscope.run.series import SERIES_DTYPE
from slam_core.evaluation.trajectory import Trajectory, evaluate
from slam_core.results import StepResult

LOST_SHARE = 0.5  # of the scans of a run: so many without a known pose, or unused, make its map of no use
PARTS = ("stabilise", "match", "update", "filter")


@dataclass(frozen=True, slots=True)
class Effort:
    """What a run took: seconds of the recording, seconds of the wall clock."""

    recording_s: float
    wall_s: float


def metrics(
    pipeline: Pipeline, report: SourceReport, effort: Effort | None = None, *, with_truth: bool = True
) -> dict[str, Any]:
    """Everything that is worth a number. report: the source's own counters. effort: unless a hand played it.

    with_truth: compare with the truth, which takes long after hours.
    """
    occupied = sum(np.count_nonzero(log_odds > 0) for _, log_odds in pipeline.slam.map.pieces(0))
    return {
        "scans": {
            "read": pipeline.scans_read,
            "used": pipeline.scans,
            "unusable": report.unusable,
            "skipped": dict(pipeline.skipped),
        },
        "tracking": dict(pipeline.states),
        "tracking_at_end": pipeline.result.tracking if pipeline.result else None,
        "messages": {"read": dict(report.read), "skipped": dict(report.skipped)},
        "filter_unused": dict(pipeline.slam.status.unused),
        "filter_sources": sources(pipeline.result),
        "notes": [*report.notes, *report.warnings, *pipeline.notes, *pipeline.warned],
        **(spent(effort) if effort else {}),
        "median_us": medians(pipeline.series.view(SERIES_DTYPE).reshape(-1)),
        "map_updates": pipeline.slam.map.updates,
        "occupied_cells": int(occupied),
        "map_in_world": map_in_world(pipeline.result),
        "truth": truth_errors(pipeline.trajectory, pipeline.truth) if with_truth else None,
    }


def failure(figures: Mapping[str, Any]) -> str:
    """Why the map of a run is of no use: the pose was lost, or few scans could be used. Empty if it is of use."""
    scans, lost = figures["scans"], figures["tracking"].get("lost", 0)
    used, there = scans["used"], scans["read"] + scans["unusable"]
    if used < LOST_SHARE * there:
        return f"{used} of {there} scans could be used, so the map cannot be trusted: see skipped above"
    if figures["tracking_at_end"] == "lost" or lost > LOST_SHARE * used:
        return "the pose was lost, so the map cannot be trusted: see tracking above"
    return ""


def spent(effort: Effort) -> dict[str, float]:
    """Lengths, and how many times faster than it was recorded."""
    factor = effort.recording_s / max(effort.wall_s, 1e-9)
    return {
        "recording_s": round(effort.recording_s, 6),
        "wall_s": round(effort.wall_s, 3),
        "realtime_factor": round(factor, 2),
    }


def sources(result: StepResult | None) -> dict[str, dict[str, Any]]:
    """What became of the measurements of each source that corrects the filter, the match among them."""
    return {
        status.source: {"used": status.used, "rejected": status.rejected, "dropped": dict(status.dropped)}
        for status in (result.aiding if result else ())
    }


def map_in_world(result: StepResult | None) -> dict[str, float] | None:
    """Where the map's origin lies and its x axis points in the plane of the satellites; None if not known."""
    if result is None or result.world is None:
        return None
    east, north, turn = result.world.mean.tolist()
    sigma_east, sigma_north, sigma_turn = np.sqrt(np.diag(result.world.covariance)).tolist()
    figures = {"east_m": east, "north_m": north, "from_east_deg": math.degrees(turn)}
    figures |= {"sigma_m": max(sigma_east, sigma_north), "sigma_deg": math.degrees(sigma_turn)}
    return {name: round(value, 3) for name, value in figures.items()}


def medians(series: NDArray[np.void]) -> dict[str, float]:
    """Median microseconds of each part of a scan's step; of the map update, where there was one."""
    updated = np.diff(series["map_updates"], prepend=0.0) > 0
    columns = {part: series[f"{part}_ms"] for part in PARTS}
    columns["update"] = columns["update"][updated]
    return {part: round(1e3 * float(np.median(ms)), 1) if len(ms) else 0.0 for part, ms in columns.items()}


def truth_errors(trajectory: Rows, truth: Rows) -> dict[str, float] | None:
    """Errors of a trajectory (n, 8) in metres and degrees; None without a truth (m, 8) that overlaps it."""
    error = evaluate(Trajectory.from_rows(trajectory), Trajectory.from_rows(truth))
    if error is None:
        return None
    figures = {"poses": error.poses, "raw_rmse_m": error.raw, "aligned_rmse_m": error.aligned}
    if error.height is not None:
        figures["height_rms_m"] = error.height
    if error.roll is not None and error.pitch is not None:
        figures["roll_rms_deg"] = math.degrees(error.roll)
        figures["pitch_rms_deg"] = math.degrees(error.pitch)
    return {name: round(value, 6) for name, value in figures.items()}
