"""Objects that appear in free space: they are written into the map once they have stayed where they are.

Somebody who walks beside the robot is hit by many beams. Written at once, the person would be a landmark that
moves, and the match of a slow scanner would follow it.
"""

import numpy as np
from numpy.typing import NDArray

from slam_core.kernels.planar import transform_points
from slam_core.measurements import Float32s, Float64s, Int64s

CELL = 0.1  # metres: an object stayed if an endpoint lies in the cell of an earlier one, or beside it
REMEMBERED_NS = 10_000_000_000  # of the endpoints in free space
ROW = 1 << 32  # cells between a cell and the one above it
BESIDE = [ROW * row + column for row in (-1, 0, 1) for column in (-1, 0, 1)]


class Newcomers:
    """The endpoints of earlier keyframes that lay in free space, by the time of the keyframe."""

    def __init__(self) -> None:
        self._seen: list[tuple[int, Int64s]] = []

    def too_new(
        self, points: Float32s, pose: Float64s, unexpected: NDArray[np.bool_], time_ns: int, delay: float
    ) -> NDArray[np.bool_]:
        """(n,) which points (n, 2) of a keyframe at `pose` (3,) are not written yet.

        unexpected: (n,) which lie in free space. delay: seconds that they have to stay there; 0: none.
        """
        found = np.zeros(len(points), np.bool_)
        if delay <= 0.0 or not unexpected.any():
            return found
        cells = _cells(transform_points(pose, points[unexpected]))
        self._seen = [(at_ns, old) for at_ns, old in self._seen if 0 <= time_ns - at_ns <= REMEMBERED_NS]
        before = [old for at_ns, old in self._seen if time_ns - at_ns >= delay * 1e9]
        stayed = np.isin(np.add.outer(cells, BESIDE), np.concatenate([cells[:0], *before])).any(axis=1)
        found[unexpected] = ~stayed
        self._seen.append((time_ns, cells))
        return found


def _cells(points: Float64s) -> Int64s:
    """(n,) numbers of the cells that points (n, 2) of the map lie in."""
    columns, rows = np.floor(points / CELL).astype(np.int64).T
    return np.asarray(rows * ROW + columns)
