"""When a cell of the map was written first and last, by the checkpoints that were kept on the way.

The map keeps no time for its cells. A checkpoint has the map as it was, so a change lies between two checkpoints,
some fifty scans apart. A cell becomes known only by a scan that is written, which narrows its first time to those.
"""

from collections.abc import Iterable

import numpy as np

from hectorscope.run.checkpoints import Checkpoint
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.readings import Cell, History, Span
from hectorscope.run.series import SERIES_FIELDS
from slam_core.mapping.tiles import TILE

UPDATES = SERIES_FIELDS.index("map_updates")


def cell_history(pipeline: Pipeline, checkpoints: Iterable[Checkpoint], level: int, cell: Cell) -> History:
    """Of a cell of a level in its lattice, up to where the pipeline is."""
    column, row = cell
    now = float(pipeline.slam.map.gather(level, (row, row + 1, column, column + 1)).item())
    if not now or not pipeline.scans:
        return History()
    passed = [(0, None), *((kept.scans, kept) for kept in checkpoints if kept.scans <= pipeline.scans)]
    values = [0.0 if kept is None else _value(kept, level, cell) for _, kept in passed]
    scans = [count for count, _ in passed] + [pipeline.scans]
    known = next((i for i, value in enumerate(values) if value), len(values))
    differs = next((i for i in reversed(range(len(values))) if values[i] != now), 0)
    first = _written(pipeline, scans[known - 1], scans[known])
    last = _span(pipeline, scans[differs] + 1, scans[differs + 1])
    return History(first, last, saved=pipeline.mode != "map" and known == 1)


def _value(kept: Checkpoint, level: int, cell: Cell) -> float:
    """The log-odds of a cell at a checkpoint."""
    side, (column, row) = TILE >> level, cell
    tile = kept.map.tile((column // side, row // side))
    return 0.0 if tile is None else float(tile.log_odds[level][row % side, column % side])


def _written(pipeline: Pipeline, after: int, until: int) -> Span:
    """The scans behind one, up to another one, that were written; all of them if none was."""
    updates = np.concatenate([[0.0], pipeline.series[:, UPDATES]])
    written = 1 + np.flatnonzero(np.diff(updates) > 0.0)
    some = written[(written > after) & (written <= until)]
    return _span(pipeline, *((int(some[0]), int(some[-1])) if len(some) else (after + 1, until)))


def _span(pipeline: Pipeline, first: int, last: int) -> Span:
    last = max(first, min(last, pipeline.scans))
    from_s, to_s = pipeline.trajectory[[first - 1, last - 1], 0].tolist()
    return Span(first, last, from_s, to_s)
