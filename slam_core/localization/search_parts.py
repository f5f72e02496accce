"""What a search of a map goes through: all of a small region, and of a large one what was seen, in parts."""

import math
from typing import NamedTuple, Protocol

import numpy as np

from slam_core import geometry
from slam_core.mapping.tiles import Box, Key, around, common, square
from slam_core.measurements import Float32s, Float64s, Int64s

AT_REST = np.zeros(3)
BLOCK = 4  # cells on a side of the places that share a bound
LARGE = 2048 * 2048  # cells beyond which a region is searched in parts, where something was seen
PART = 256  # blocks on a side of such a part


class Cells(Protocol):
    """One level of a map, as a `GridLevel` or a `MapLevel`."""

    @property
    def resolution(self) -> float:
        """Metres a cell."""

    @property
    def bounds(self) -> Box | None:
        """Where cells were touched."""

    @property
    def tile(self) -> int:
        """Cells on a side of a tile."""

    def gather(self, box: Box) -> Float32s:
        """The log-odds in a box of the lattice."""

    def seen(self) -> list[Key]:
        """The tiles in which something was seen."""


class Region(NamedTuple):
    """Where the robot can have been: a circle, metres in the map. motion: (3,) of the robot since it was there.

    turn: by how much its heading there can have differed from `heading`, radians.
    """

    centre: Float64s
    radius: float
    motion: Float64s = AT_REST
    heading: float = 0.0
    turn: float = math.pi

    @property
    def reach(self) -> float:
        """Metres from the centre to where the robot can be now, whatever its heading was."""
        return self.radius + math.hypot(*self.motion[:2])

    def holds(self, pose: Float64s) -> bool:
        """Whether a robot that is at `pose` (3,) now was in the circle, with such a heading."""
        was = geometry.compose(pose, geometry.inverse(self.motion))
        turned = abs(geometry.wrap(was[2] - self.heading))
        return math.hypot(*(was - self.centre)[:2]) <= self.radius and turned <= self.turn

    def facing(self, headings: Float64s) -> Float64s:
        """Those of evenly spaced headings (k,), radians, that the robot can have now, and one beside."""
        step = 2.0 * math.pi / len(headings)
        turned = (headings - self.heading - self.motion[2] + math.pi) % (2.0 * math.pi) - math.pi
        near: Float64s = headings[np.abs(turned) <= self.turn + step]
        return near


class Searched(NamedTuple):
    """A part of the map. window: the cells that a scan there may meet. box: the places, as blocks in the window.

    The box has its first row and column, and how many there are. Window and box are empty if nothing is known.
    """

    window: Box
    box: Int64s


def parts(level: Cells, region: Region | None, reach: float) -> list[Searched]:
    """The known cells of a region, as one part; where that is LARGE, as parts around what was seen.

    reach: metres to the furthest endpoint.
    """
    if level.bounds is None:
        return []
    window, (row, column, high, wide) = _whole(level, level.bounds, region, reach)
    if not (high and wide and window[0] < window[1] and window[2] < window[3]):  # all may lie off the map
        return []
    if (window[1] - window[0]) * (window[3] - window[2]) <= LARGE:
        return [Searched(window, np.array([row, column, high, wide]))]
    places: dict[tuple[int, int], Box] = {}
    within = row, row + high, column, column + wide
    for tile in level.seen():
        blocks = common(within, _blocks(common(window, square(tile, level.tile)), window))
        if blocks[0] >= blocks[1] or blocks[2] >= blocks[3]:
            continue  # beside the region
        for r in range(blocks[0] // PART, -(-blocks[1] // PART)):
            for c in range(blocks[2] // PART, -(-blocks[3] // PART)):
                box = PART * r, PART * (r + 1), PART * c, PART * (c + 1)
                places[r, c] = around(places.get((r, c)), common(blocks, box))
    far = math.ceil((reach / level.resolution + 1.0) / BLOCK)
    return [_cut(window, places[key], far) for key in sorted(places)]


def _cut(window: Box, places: Box, far: int) -> Searched:
    """The part of a window around a box of places, as far as a scan there reaches; both in blocks."""
    row, column = max(0, places[0] - far), max(0, places[2] - far)
    box = np.array([places[0] - row, places[2] - column, places[1] - places[0], places[3] - places[2]])
    last_row, last_column = window[0] + BLOCK * (places[1] + far), window[2] + BLOCK * (places[3] + far)
    first_row, first_column = window[0] + BLOCK * row, window[2] + BLOCK * column
    return Searched((first_row, min(last_row, window[1]), first_column, min(last_column, window[3])), box)


def _blocks(cells: Box, window: Box) -> Box:
    """The blocks of a window, counted from its first, that hold a box of its cells."""
    row0, row1, column0, column1 = cells
    row0, row1, column0, column1 = row0 - window[0], row1 - window[0], column0 - window[2], column1 - window[2]
    return row0 // BLOCK, -(-row1 // BLOCK), column0 // BLOCK, -(-column1 // BLOCK)


def _whole(level: Cells, bounds: Box, region: Region | None, reach: float) -> tuple[Box, tuple[int, ...]]:
    """The known cells that a scan may meet, and the box of blocks in them that holds the region."""
    row0, row1, column0, column1 = bounds
    if region is None:
        return bounds, (0, 0, -(-(row1 - row0) // BLOCK), -(-(column1 - column0) // BLOCK))
    cell = level.resolution
    column, row = (np.asarray(region.centre[:2]) / cell).tolist()
    half, far = region.reach / cell, (region.reach + reach) / cell + 1.0

    def cut(value: float, low: int, high: int) -> int:
        return math.floor(min(max(value, low), high))

    window = (
        cut(row - far, row0, row1), cut(row + far + 1.0, row0, row1),
        cut(column - far, column0, column1), cut(column + far + 1.0, column0, column1),
    )  # fmt: skip
    first_row, last_row = (cut(row + d, window[0], window[1]) for d in (-half, half + 1.0))
    first_column, last_column = (cut(column + d, window[2], window[3]) for d in (-half, half + 1.0))
    begin_row, end_row, left, right = _blocks((first_row, last_row, first_column, last_column), window)
    return window, (begin_row, left, end_row - begin_row, right - left)
