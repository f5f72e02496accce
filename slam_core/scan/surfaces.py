"""Beams as the matcher takes them: endpoints and, on request, the direction of the surface that each one hit.

Along a wall the map does not observe the pose, yet the texture of its cells has a gradient there, which holds a
robot in a bare corridor to its old place. With the surfaces known, only the gradient across them counts; the
matcher takes that where the scan fixes the position badly.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np

from slam_core.kernels.surfaces import tangents
from slam_core.measurements import Float32s


@dataclass(frozen=True, slots=True, eq=False)
class Beams:
    """xs, ys: (n,) endpoints in the stabilised frame, metres; along_x, along_y: (n,) surface directions, or 0."""

    xs: Float32s
    ys: Float32s
    along_x: Float32s
    along_y: Float32s

    @classmethod
    def plain(cls, points: Float32s) -> Self:
        """Endpoints (n, 2) alone: the paper's matching, with the whole gradient."""
        zeros = np.zeros(len(points), np.float32)
        return cls(*_columns(points), zeros, zeros)

    @classmethod
    def with_surfaces(cls, points: Float32s) -> Self:
        """Endpoints (n, 2) in the order of the sweep, with the directions of the surfaces they lie on."""
        xs, ys = _columns(points)
        along_x, along_y = np.empty_like(xs), np.empty_like(xs)
        tangents(xs, ys, along_x, along_y)
        return cls(xs, ys, along_x, along_y)

    @property
    def arrays(self) -> tuple[Float32s, Float32s, Float32s, Float32s]:
        """In the order of the kernels."""
        return self.xs, self.ys, self.along_x, self.along_y


def _columns(points: Float32s) -> tuple[Float32s, Float32s]:
    columns = np.ascontiguousarray(np.asarray(points, np.float32).T)
    return columns[0], columns[1]
