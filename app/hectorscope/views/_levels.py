"""Where each level of the pyramid lies (stacked, side by side, or one alone), and how large it is."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hectorscope.page.scene import Display
from hectorscope.run.map_images import MapImage
from slam_core.measurements import Float64s

AISLE = 2.0  # metres between levels side by side
OCCUPIED = 2  # class of a cell
OUTLIERS = (
    0.03  # share of the walls on each side that may be outside: a few beams far out must not shrink the rest
)

Bounds = tuple[Float64s, Float64s]  # lowest and highest x, y in the map, metres


@dataclass(frozen=True, slots=True)
class Placement:
    """Offset of a level from the map frame's place on the floor, metres. veiled: others lie below it."""

    x: float = 0.0
    z: float = 0.0
    shown: bool = True
    veiled: bool = False


def placements(display: Display, maps: Sequence[MapImage]) -> list[Placement]:
    """One for each level, finest first; the finest one stays where scan and robot are."""
    if display.layout == "stacked":
        return [Placement(z=display.gap * depth(maps) * i, veiled=i > 0) for i in range(len(maps))]
    if display.layout == "one":
        only = min(display.level, len(maps) - 1)
        return [Placement(shown=i == only) for i in range(len(maps))]
    places: list[Placement] = []
    right = None  # edge of the level before
    for image in maps:
        offset = 0.0 if right is None else right + AISLE - image.x
        right = image.x + offset + image.cells.shape[1] * image.resolution
        places.append(Placement(x=offset))
    return places


def depth(maps: Sequence[MapImage]) -> float:
    """How far the walls reach from south to north, whole metres: levels need more room between them in a hall."""
    if not maps or not maps[-1].cells.size:
        return 1.0
    low, high = bulk(maps[-1])
    return float(np.ceil(high[1] - low[1]))


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
