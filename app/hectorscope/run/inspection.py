"""A closer look at one beam of the shown scan, or at one cell of the map."""

import math
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from hectorscope.run.cell_history import cell_history
from hectorscope.run.checkpoints import Checkpoint
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.readings import BeamTarget, BeamView, CellTarget, CellView, LevelReading, Target, View
from slam_core.geometry import transform_points
from slam_core.mapping.grid import probability_of
from slam_core.mapping.tiled_map import TiledMap
from slam_core.results import StepResult, Sweep
from slam_core.scan.beams import beam_of, endpoint_of


def view_of(target: Target, pipeline: Pipeline, checkpoints: Iterable[Checkpoint]) -> View | None:
    """What there is to see of a target now; None for a beam without a scan that has it."""
    if isinstance(target, CellTarget):
        return _cell(target, pipeline, checkpoints)
    result = pipeline.result
    if result is None or result.sweep is None or target.number >= len(result.sweep.scan.ranges):
        return None
    return _beam(target.number, result, result.sweep, pipeline, checkpoints)


def target_at(
    places: Iterable[CellTarget], reach: float, result: StepResult | None, tiled: TiledMap
) -> Target | None:
    """What a person points at: the nearest endpoint on the finest level within `reach` metres, else the first
    place whose cell is known. places: where the sight meets the levels, the nearest first.
    """
    known: CellTarget | None = None
    for place in places:
        if place.level == 0 and result is not None and (beam := nearest_beam(result, place, reach)) is not None:
            return BeamTarget(beam)
        if known is None and place.level < len(tiled.levels) and reading(tiled, place).probability is not None:
            known = place
    return known


def nearest_beam(result: StepResult, place: CellTarget, reach: float) -> int | None:
    """The beam that ends nearest to a place, if that is within `reach` metres."""
    if result.sweep is None or not len(result.points):
        return None
    ends = transform_points(result.planar, result.points)
    apart = np.hypot(ends[:, 0] - place.x, ends[:, 1] - place.y)
    nearest = int(np.argmin(apart))
    return beam_of(result.sweep, nearest) if apart[nearest] <= reach else None


def reading(tiled: TiledMap, place: CellTarget) -> LevelReading:
    """One level at a place."""
    resolution = tiled.levels[place.level].resolution
    u, v = place.x / resolution, place.y / resolution
    column, row = math.floor(u), math.floor(v)
    log_odds = float(tiled.gather(place.level, (row, row + 1, column, column + 1)).item())
    left, low = math.floor(u - 0.5), math.floor(v - 0.5)
    around = tiled.gather(place.level, (low, low + 2, left, left + 2), "cells")
    right, up = u - 0.5 - left, v - 0.5 - low  # eq. (4)
    M = float(np.array([1.0 - up, up]) @ probability_of(around) @ np.array([1.0 - right, right]))
    known = 1.0 / (1.0 + math.exp(-log_odds)) if log_odds else None
    return LevelReading((column, row), resolution, known, 1.0 - M)


def _cell(target: CellTarget, pipeline: Pipeline, checkpoints: Iterable[Checkpoint]) -> CellView:
    tiled = pipeline.slam.map
    numbers = range(len(tiled.levels))
    level = min(target.level, numbers[-1])
    readings = tuple(reading(tiled, CellTarget(i, target.x, target.y)) for i in numbers)
    history = cell_history(pipeline, checkpoints, level, readings[level].cell)
    return CellView(level, target.x, target.y, readings, history)


def _beam(
    number: int, result: StepResult, sweep: Sweep, pipeline: Pipeline, checkpoints: Iterable[Checkpoint]
) -> BeamView:
    scan = sweep.scan
    x, y = transform_points(result.planar, sweep.laser[None])[0].tolist()
    beam = BeamView(
        number,
        len(scan.ranges),
        float(sweep.measured[number]),
        scan.angle_min + number * scan.angle_increment,
        number * scan.time_increment if scan.time_increment else math.nan,
        (x, y),
    )
    endpoint = endpoint_of(sweep, number)
    if endpoint is None:
        return beam
    x, y = transform_points(result.planar, result.points[endpoint : endpoint + 1])[0].tolist()
    return replace(
        beam,
        used_m=float(scan.ranges[number]),
        height=float(result.heights[endpoint]),
        residual=float(result.match.residuals[endpoint]) if result.match else math.nan,
        left_out=endpoint in result.match.left_out if result.match else False,
        unexpected=bool(result.unexpected[endpoint]),
        end=_cell(CellTarget(0, x, y), pipeline, checkpoints),
    )
