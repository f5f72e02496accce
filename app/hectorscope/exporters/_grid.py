"""The finest level in one piece, and the files by which the map servers of ROS share it."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hectorscope.common.paths import write_whole
from hectorscope.run.map_images import FILE
from hectorscope.run.results import Run

# A reader takes (255 - grey) / 255 for the probability of a cell to be occupied.
OCCUPIED_ABOVE = 0.65
FREE_BELOW = 0.196


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """log_odds: (rows, columns), row 0 the lowest y, 0 unknown. x, y: map coordinates of the corner of [0, 0]."""

    resolution: float
    x: float
    y: float
    log_odds: NDArray[np.float32]

    @property
    def known(self) -> NDArray[np.bool_]:
        """(rows, columns)."""
        known: NDArray[np.bool_] = self.log_odds != 0.0
        return known

    @property
    def probability(self) -> NDArray[np.float32]:
        """(rows, columns) of being occupied, 0 to 1."""
        one = np.float32(1.0)
        with np.errstate(over="ignore"):  # of the infinite odds against a cell that was free very often
            return one / (one + np.exp(-self.log_odds))


def finest(run: Run) -> Grid | None:
    """The finest level of a run; None without a map. ValueError if it has more cells than a file holds."""
    if not run.levels:
        return None
    resolution = min(level.resolution for level in run.levels)
    parts = [level for level in run.levels if level.resolution == resolution]
    sizes = [np.array(part.log_odds.shape[::-1]) for part in parts]
    low = np.min([part.corner for part in parts], axis=0)
    high = np.max([part.corner + size for part, size in zip(parts, sizes, strict=True)], axis=0)
    columns, rows = (high - low).tolist()
    if rows * columns > FILE:
        raise ValueError(f"the map has {columns} x {rows} cells, more than an image holds")
    log_odds = np.zeros((rows, columns), np.float32)
    for part in parts:
        column, row = (part.corner - low).tolist()
        log_odds[row:, column:][: part.log_odds.shape[0], : part.log_odds.shape[1]] = part.log_odds
    x, y = (resolution * low).tolist()
    return Grid(resolution, x, y, log_odds)


def pgm(grey: NDArray[np.uint8]) -> bytes:
    """Binary grey image (P5) of (rows, columns), the highest y first."""
    rows, columns = grey.shape
    return f"P5\n{columns} {rows}\n255\n".encode() + grey.tobytes()


def description(image: str, mode: str, resolution: float, x: float, y: float) -> bytes:
    """The yaml file of an image; x, y: its lower left corner."""
    return (
        f"image: {image}\n"
        f"mode: {mode}\n"
        f"resolution: {resolution!r}\n"
        f"origin: [{x!r}, {y!r}, 0.0]\n"
        "negate: 0\n"
        f"occupied_thresh: {OCCUPIED_ABOVE}\n"
        f"free_thresh: {FREE_BELOW}\n"
    ).encode()


def write_map(grid: Grid, image: Path, described: Path, pixels: bytes, mode: str) -> None:
    """An image, and the yaml file that says what it means."""
    write_whole(image, pixels)
    write_whole(described, description(image.name, mode, grid.resolution, grid.x, grid.y))


def shades(grid: Grid) -> NDArray[np.uint8]:
    """(rows, columns) 255 for surely free to 0 for surely occupied, the highest y first."""
    grey: NDArray[np.uint8] = np.rint(255.0 * (1.0 - grid.probability[::-1])).astype(np.uint8)
    return grey
