"""Where the walls of a level are, which is what a camera has to show of it."""

import numpy as np

from hectorscope.run.map_image import OCCUPIED, MapImage
from slam_core.measurements import Float64s

OUTLIERS = (
    0.03  # share of the walls on each side that may be outside: a few beams far out must not shrink the rest
)

Bounds = tuple[Float64s, Float64s]  # lowest and highest x, y in the map, metres


def bulk(image: MapImage) -> Bounds:
    """Where the walls are, without outliers; all that is known when there are no walls yet."""
    cells = image.cells
    marked = cells == OCCUPIED if (cells == OCCUPIED).any() else np.ones_like(cells, bool)
    spans = [span(marked.sum(axis=axis)) for axis in (0, 1)]
    low, high = np.array(spans, float).T * image.resolution + [[image.x, image.y]] * 2
    return low, high


def span(counts: np.ndarray) -> tuple[int, int]:
    """First and last index (exclusive) between which all but OUTLIERS of the counts on each side lie."""
    share = np.cumsum(counts) / counts.sum()
    return int(np.searchsorted(share, OUTLIERS)), int(np.searchsorted(share, 1.0 - OUTLIERS)) + 1
