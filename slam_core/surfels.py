"""Where in its cells a surface lies, as lines to look at: the words of a level without their packing."""

import numpy as np
from numpy.typing import NDArray

from slam_core.kernels.surfels import COMPONENT, COUNT, FEW, OF_COMPONENT, OF_OFFSET, OFFSET, TO_X, TO_Y
from slam_core.measurements import Float32s


def pieces(words: NDArray[np.uint32], resolution: float, x: float, y: float) -> tuple[Float32s, Float32s]:
    """(n, 2, 2) both ends of the surface in every cell that has one, metres in the map; (n,) how much it counts.

    words: (rows, columns) as in GridLevel.surfels, whose first cell has its lower left corner at x, y. A piece is
    as long as its cell is wide in that direction; seen from where it was scanned it runs from left to right. It
    counts up to 1, in the match, for an end that lies on it.
    """
    rows, columns = np.nonzero(words & np.uint32(COUNT))
    word = words[rows, columns].view(np.int32)
    normals = np.column_stack([word << TO_X >> OF_COMPONENT, word << TO_Y >> OF_COMPONENT]) * COMPONENT
    middles = np.column_stack([columns, rows]) + 0.5 + normals * (word >> OF_OFFSET)[:, None] * OFFSET
    along = np.column_stack([-normals[:, 1], normals[:, 0]])
    half = 0.5 * along / np.maximum(np.abs(along).max(axis=1, keepdims=True), COMPONENT)
    ends = np.stack([middles - half, middles + half], axis=1)
    beams = (word & COUNT).astype(np.float32)
    return (ends * resolution + (x, y)).astype(np.float32), beams / (beams + FEW)
