"""Whether a run that comes back finds the map that it made at first: no doubled walls."""

from collections import deque
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from hectorscope.inputs import Item
from hectorscope.run.map_image import MapImage
from hectorscope.run.map_images import map_images
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from slam_core.config import SlamConfig
from slam_core.geometry import transform_points
from slam_core.measurements import Measurement
from slam_core.results import StepResult

FIRST_S = 15.0  # the map of these seconds
LAST_SCANS = 20  # is held against these scans
OCCUPIED = 2
FEWEST_SEEN = 0.25  # of the endpoints, in what was known then; with fewer the run did not come back there


def process(items: Iterable[Item], config: SlamConfig) -> tuple[Pipeline, float | None]:
    """Every item through the pipeline, and how far the end agrees with the beginning."""
    pipeline, early = Pipeline(Settings(config)), None
    last: deque[StepResult] = deque(maxlen=LAST_SCANS)

    def step(measurements: list[Measurement]) -> None:
        nonlocal early
        for measurement in measurements:
            result = pipeline.step(measurement)
            if result is not None:
                last.append(result)
                if early is None and pipeline.trajectory[-1, 0] - pipeline.trajectory[0, 0] >= FIRST_S:
                    early = map_images(pipeline.slam.map)[0]

    for item in items:
        step(pipeline.admit(item))
    step(pipeline.flush())
    return pipeline, None if early is None else agreement(early, last)


def agreement(early: MapImage, scans: Iterable[StepResult]) -> float | None:
    """Share of endpoints on or beside an occupied cell, of those in known cells; None if too few are."""
    points = [transform_points(scan.planar, scan.points) for scan in scans]
    cells = np.floor((np.concatenate(points) - [early.x, early.y]) / early.resolution).astype(np.int64)
    seen = [_near(cells, kind) for kind in (early.cells > 0, early.cells == OCCUPIED)]
    known, occupied = (int(near.sum()) for near in seen)
    return occupied / known if known >= FEWEST_SEEN * len(cells) else None


def _near(cells: NDArray[np.int64], wanted: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """(n,) whether one of the nine cells around each of `cells` (n, 2) x, y is wanted."""
    near = np.zeros(len(cells), bool)
    rows, columns = wanted.shape
    for dx in (-1, 0, 1):
        for dy in (-1, 0, 1):
            x, y = cells[:, 0] + dx, cells[:, 1] + dy
            inside = (x >= 0) & (x < columns) & (y >= 0) & (y < rows)
            near[inside] |= wanted[y[inside], x[inside]]
    return near
