"""Worlds of triangles over a ground plane, and the few shapes they are built from."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from hectorscope.simulation.raycast import MISS, ColumnGrid, Ints, cast, column_grid
from slam_core.measurements import Float64s

GROUND, CEILING = -2, -3  # what a ray may hit besides a triangle


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """(n, 3, 3) triangles, metres; foliage takes a beam up to about `depth` metres in before it returns.

    Glass returns what meets it head on and lets most of the rest through.
    """

    triangles: Float64s
    depth: float = 0.0
    glass: bool = False


@dataclass(frozen=True, eq=False)
class World:
    """Surfaces, a level ground at height `ground`, perhaps a ceiling. Water swallows the beams that reach it."""

    surfaces: Sequence[Surface]
    ground: float = 0.0
    ceiling: float = np.inf
    water: bool = False
    cell: float = 0.5

    @cached_property
    def triangles(self) -> Float64s:
        """(n, 3, 3) corners of all surfaces."""
        return np.concatenate([surface.triangles for surface in self.surfaces])

    @cached_property
    def depths(self) -> Float64s:
        """(n,) how deep beams enter each triangle, metres."""
        return np.concatenate([np.full(len(surface.triangles), surface.depth) for surface in self.surfaces])

    @cached_property
    def glass(self) -> NDArray[np.bool_]:
        """(n,) which triangles are glass."""
        return np.concatenate([np.full(len(surface.triangles), surface.glass) for surface in self.surfaces])

    @cached_property
    def normals(self) -> Float64s:
        """(n, 3) unit normals of the triangles."""
        a, b, c = self.triangles.transpose(1, 0, 2)
        normals = np.cross(b - a, c - a)
        unit: Float64s = normals / np.linalg.norm(normals, axis=1, keepdims=True)
        return unit

    @cached_property
    def _grid(self) -> ColumnGrid:
        return column_grid(self.triangles, self.cell)

    def cast(self, origins: Float64s, directions: Float64s, reach: float) -> tuple[Float64s, Ints]:
        """(n,) distances along unit rays, inf without a return, and the triangle hit, GROUND, CEILING or MISS."""
        distances, hits = cast(self._grid, origins, directions, reach)
        for level, name in ((self.ground, GROUND), (self.ceiling, CEILING)):
            with np.errstate(divide="ignore", invalid="ignore"):
                t = (level - origins[:, 2]) / directions[:, 2]
            nearer = (t > 0.0) & (t < np.minimum(distances, reach))
            distances[nearer], hits[nearer] = t[nearer], name
        if self.water:
            drowned = hits == GROUND
            distances[drowned], hits[drowned] = np.inf, MISS
        return distances, hits

    def floor_height(self, x: Float64s, y: Float64s) -> Float64s:
        """(n,) height of what a wheel at (n,) x, y stands on: ramps, or the ground."""
        top = self.triangles[:, :, 2].max() + 1.0
        origins = np.column_stack((x, y, np.full(len(x), top)))
        down = np.tile([0.0, 0.0, -1.0], (len(x), 1))
        distances, _ = self.cast(origins, down, np.inf)
        heights: Float64s = top - distances
        return heights


def quad(a: Sequence[float], b: Sequence[float], c: Sequence[float], d: Sequence[float]) -> Float64s:
    """(2, 3, 3) the flat four-cornered patch a-b-c-d."""
    return np.array([[a, b, c], [a, c, d]], dtype=np.float64)


def fence(points: Float64s, low: float, high: float) -> Float64s:
    """Upright faces from `low` to `high` over the open polyline (k, 2)."""
    return np.concatenate([quad((*a, low), (*b, low), (*b, high), (*a, high)) for a, b in pairwise(points)])


def prism(outline: Float64s, low: float, high: float) -> Float64s:
    """The sides and the top of a convex (k, 2) outline."""
    closed = np.concatenate((outline, outline[:1]))
    roof = np.concatenate((outline, np.full((len(outline), 1), high)), axis=1)
    top = [(roof[0], roof[i], roof[i + 1]) for i in range(1, len(roof) - 1)]
    return np.concatenate((fence(closed, low, high), np.array(top)))


def box(x0: float, y0: float, x1: float, y1: float, low: float, high: float) -> Float64s:
    """An upright box."""
    return prism(np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], dtype=np.float64), low, high)


def post(x: float, y: float, radius: float, low: float, high: float, sides: int = 8) -> Float64s:
    """A round column with `sides` faces."""
    angles = np.arange(sides) * 2 * np.pi / sides
    return prism(np.column_stack((x + radius * np.cos(angles), y + radius * np.sin(angles))), low, high)


def wall(
    start: tuple[float, float],
    end: tuple[float, float],
    low: float,
    high: float,
    thickness: float,
    gaps: Iterable[tuple[float, float]] = (),
) -> Float64s:
    """A straight wall of some thickness; each gap (from, to) is a doorway, metres along the wall."""
    a, b = np.array(start, dtype=np.float64), np.array(end, dtype=np.float64)
    length = float(np.linalg.norm(b - a))
    along = (b - a) / length
    side = np.array([-along[1], along[0]]) * thickness / 2
    cuts = [0.0, *(cut for gap in sorted(gaps) for cut in gap), length]
    pieces = [(a + along * s, a + along * e) for s, e in zip(cuts[::2], cuts[1::2], strict=True) if e > s]
    return np.concatenate(
        [prism(np.array([p - side, q - side, q + side, p + side]), low, high) for p, q in pieces]
    )
