"""The figures of a run, as plain values for metrics.json."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.pipeline import Pipeline
from app.publisher import map_images
from app.snapshot import SERIES_DTYPE, SourceReport
from slam_core.evaluation import Trajectory, evaluate

PARTS = ("stabilise", "match", "update", "filter")


@dataclass(frozen=True, slots=True)
class Effort:
    """What a run took: seconds of the recording, seconds of the wall clock."""

    recording_s: float
    wall_s: float


def metrics(pipeline: Pipeline, report: SourceReport, effort: Effort) -> dict[str, Any]:
    """Everything that is worth a number. report: the source's own counters."""
    maps = map_images(pipeline)
    return {
        "scans": {
            "read": pipeline.scans_read,
            "used": pipeline.scans,
            "skipped": dict(pipeline.skipped),
        },
        "tracking": dict(pipeline.states),
        "messages": {"read": dict(report.read), "skipped": dict(report.skipped)},
        "notes": [*report.notes, *pipeline.slam.notes, *pipeline.slam.warnings],
        "recording_s": round(effort.recording_s, 6),
        "wall_s": round(effort.wall_s, 3),
        "realtime_factor": round(effort.recording_s / max(effort.wall_s, 1e-9), 2),
        "median_us": medians(pipeline.series.view(SERIES_DTYPE).reshape(-1)),
        "map_updates": pipeline.slam.pyramid.updates,
        "occupied_cells": int(np.count_nonzero(maps[0].cells == 2)) if maps else 0,
        "truth": truth_errors(pipeline),
    }


def medians(series: NDArray[np.void]) -> dict[str, float]:
    """Median microseconds of each part of a scan's step; of the map update, where there was one."""
    updated = np.diff(series["map_updates"], prepend=0.0) > 0
    columns = {part: series[f"{part}_ms"] for part in PARTS}
    columns["update"] = columns["update"][updated]
    return {part: round(1e3 * float(np.median(ms)), 1) if len(ms) else 0.0 for part, ms in columns.items()}


def truth_errors(pipeline: Pipeline) -> dict[str, float] | None:
    """Errors against the truth in metres and degrees; None without a truth that overlaps the run."""
    error = evaluate(Trajectory.from_rows(pipeline.trajectory), Trajectory.from_rows(pipeline.truth))
    if error is None:
        return None
    figures = {"poses": error.poses, "raw_rmse_m": error.raw, "aligned_rmse_m": error.aligned}
    if error.height is not None:
        figures["height_rms_m"] = error.height
    if error.roll is not None and error.pitch is not None:
        figures["roll_rms_deg"] = math.degrees(error.roll)
        figures["pitch_rms_deg"] = math.degrees(error.pitch)
    return {name: round(value, 6) for name, value in figures.items()}
