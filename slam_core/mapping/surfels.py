"""Where in its cells a surface lies, as lines to look at: the words of a level without their packing."""

import numpy as np
from numpy.typing import NDArray

from slam_core.kernels.surfels import COMPONENT, COUNT, FEW, unpacked
from slam_core.measurements import Float32s


def pieces(words: NDArray[np.uint32], resolution: float, x: float, y: float) -> tuple[Float32s, Float32s]:
    """(n, 2, 2) both ends of the surface in every cell that has one, metres in the map; (n,) how much it counts.

    words: (rows, columns) as in GridLevel.surfels, whose first cell has its lower left corner at x, y. A piece is
    as long as its cell is wide in that direction; seen from where it was scanned it runs from left to right. It
    counts up to 1, in the match, for an end that lies on it.
    """
    rows, columns = np.nonzero(words & np.uint32(COUNT))
    beams, nx, ny, offset = unpacked.py_func(words[rows, columns].view(np.int32))  # numpy is fast enough here
    middles = np.column_stack([columns + 0.5 + nx * offset, rows + 0.5 + ny * offset])
    along = np.column_stack([-ny, nx])
    half = 0.5 * along / np.maximum(np.abs(along).max(axis=1, keepdims=True), COMPONENT)
    ends = np.stack([middles - half, middles + half], axis=1)
    return (ends * resolution + (x, y)).astype(np.float32), beams / (beams + FEW)
