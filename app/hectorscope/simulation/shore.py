"""A vegetated shore: a rough water's edge, a rising bank, bushes, trunks and reeds."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from hectorscope.simulation.worlds import fence, post, quad
from slam_core.measurements import Float64s

Bools = NDArray[np.bool_]
BED = -0.4  # m: where things in the water begin
_STEP = 0.4  # m between the points of a water's edge


@dataclass(frozen=True, slots=True, eq=False)
class Shore:
    """edge: (n, 2) points with the water on the left hand; inland: (n, 2) unit vectors away from it.

    The bank rises through `heights` [m] at the distances `setbacks` [m] from the edge.
    """

    edge: Float64s
    inland: Float64s
    setbacks: tuple[float, ...]
    heights: tuple[float, ...]

    @classmethod
    def along(
        cls,
        outline: Float64s,
        setbacks: tuple[float, ...],
        heights: tuple[float, ...],
        rng: np.random.Generator,
    ) -> "Shore":
        """A natural shore near the (k, 2) outline."""
        station = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(outline, axis=0), axis=1))))
        even = np.linspace(0.0, station[-1], round(station[-1] / _STEP) + 1)
        line = np.column_stack([_soften(np.interp(even, station, axis), 9) for axis in outline.T])
        tangent = np.gradient(line, axis=0)
        inland = np.column_stack((tangent[:, 1], -tangent[:, 0])) / np.linalg.norm(tangent, axis=1)[:, None]
        wander = 1.2 * _soften(rng.normal(size=len(line)), 7) + rng.normal(scale=0.1, size=len(line))
        return cls(line + wander[:, None] * inland, inland, setbacks, heights)

    def bank(self) -> Float64s:
        """The ground that rises from the water."""
        pairs = list(zip(self.setbacks, self.heights, strict=True))
        rows = [np.column_stack((self.edge + back * self.inland, np.full(len(self.edge), z))) for back, z in pairs]
        strips = pairwise(rows)
        return np.concatenate(
            [quad(low[i], low[i + 1], high[i + 1], high[i]) for low, high in strips for i in range(len(low) - 1)]
        )

    def bushes(self, rng: np.random.Generator) -> Float64s:
        """Ragged bushes that stand together in groups, the upper half narrower."""
        crowded = _soften(rng.normal(size=len(self.edge)), 9) > -0.2
        shapes = []
        for place in self._places(rng, 0.75, 0.1, 1.4, crowded):
            radius, height = rng.uniform(0.35, 1.0), rng.uniform(1.0, 2.8)
            for share, low, high in ((1.0, BED, 0.5 * height), (0.65, 0.5 * height, height)):
                shapes.append(fence(_ragged(place, share * radius, rng), low, high))
        return np.concatenate(shapes)

    def trunks(self, rng: np.random.Generator) -> Float64s:
        """Trees, at the edge and behind the bushes."""
        places = self._places(rng, 1.6, 0.2, 4.0, np.ones(len(self.edge), bool))
        return np.concatenate([post(x, y, rng.uniform(0.08, 0.24), BED, 6.0, sides=7) for x, y in places])

    def reeds(self, rng: np.random.Generator) -> Float64s:
        """Tufts in the shallow water."""
        crowded = _soften(rng.normal(size=len(self.edge)), 9) > 0.12
        shapes = [
            fence(_ragged(place, rng.uniform(0.08, 0.2), rng), BED, rng.uniform(0.6, 1.5))
            for place in self._places(rng, 0.4, -0.9, 0.0, crowded)
        ]
        return np.concatenate(shapes)

    def _places(
        self, rng: np.random.Generator, spacing: float, nearest: float, farthest: float, where: Bools
    ) -> Float64s:
        """(m, 2) random places about every `spacing` metres of the edge, set back `nearest` to `farthest`."""
        chosen = np.flatnonzero((rng.random(len(self.edge)) < _STEP / spacing) & where)
        setback = rng.uniform(nearest, min(farthest, self.setbacks[-1]), len(chosen))
        places: Float64s = self.edge[chosen] + setback[:, None] * self.inland[chosen]
        return places


def _ragged(centre: Float64s, radius: float, rng: np.random.Generator) -> Float64s:
    """A closed outline with bulges and notches."""
    angles = np.sort(rng.uniform(0.0, 2 * np.pi, 9))
    radii = radius * rng.uniform(0.6, 1.25, 9)
    outline = centre + radii[:, None] * np.column_stack((np.cos(angles), np.sin(angles)))
    return np.concatenate((outline, outline[:1]))


def _soften(values: Float64s, count: int) -> Float64s:
    """Running mean over `count` values, the ends held."""
    padded = np.pad(values, count // 2, mode="edge")
    return np.convolve(padded, np.full(count, 1.0 / count), "valid")
