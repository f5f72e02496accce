"""In how much of what is known two maps differ."""

import numpy as np
from numpy.typing import NDArray

from hectorscope.run.map_image import MapImage


def share_that_differs(one: MapImage, other: MapImage) -> float:
    """Share of the cells known to one of them, of which they do not say the same; NaN for cells of other sizes."""
    if one.resolution != other.resolution:
        return float("nan")
    corners = [_corner(image) for image in (one, other)]
    ends = [corners[0] + one.cells.shape, corners[1] + other.cells.shape]
    low, high = np.min(corners, axis=0), np.max(ends, axis=0)
    first, second = (_placed(image, low, high) for image in (one, other))
    known = np.count_nonzero((first > 0) | (second > 0))
    return float(np.count_nonzero(first != second) / known) if known else 0.0


def _corner(image: MapImage) -> NDArray[np.int64]:
    """Row and column of its first cell in the lattice of both."""
    return np.rint(np.array([image.y, image.x]) / image.resolution).astype(np.int64)


def _placed(image: MapImage, low: NDArray[np.int64], high: NDArray[np.int64]) -> NDArray[np.uint8]:
    """Its cells in a window of the lattice."""
    window = np.zeros(high - low, np.uint8)
    row, column = _corner(image) - low
    rows, columns = image.cells.shape
    window[row : row + rows, column : column + columns] = image.cells
    return window
