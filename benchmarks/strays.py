"""Whether beams that tell nothing of the walls pull the match: panes of glass, dust, people.

Glass returns the beams that meet it head on and lets the others through to what is behind: the hall of the scene
`glass`, beside the same hall with walls in place of the panes. Stray beams end anywhere before the wall; beside
them the same drives without those beams, as if somebody had known which they are.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.accuracy import Outcome, outcome, process, steps
from benchmarks.cases import METHODS
from hectorscope.inputs import Item
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from hectorscope.simulation import SceneOptions, Simulation
from hectorscope.simulation.worlds import World
from slam_core.config import SlamConfig
from slam_core.mapping.grid import GridLevel
from slam_core.measurements import LaserScan

EVERY = 8  # scans between two looks at the panes
NEAREST = 0.3  # m: stray beams end from there on
RATES, SHARES = (40.0, 10.0), (0.0, 0.1, 0.2, 0.3)


class Struck(NamedTuple):
    """Scans a second, the share of the beams that do not reach the wall, and whether those are missing."""

    rate: float
    share: float
    missing: bool


@dataclass(frozen=True, slots=True)
class GlassOutcome:
    """Errors in a hall with glass, and with walls in its place.

    flicker: share of the cells along the panes that were occupied again after they had been free, of all that
    ever were occupied.
    """

    solid: Outcome
    glass: Outcome
    flicker: float


def glass(options: SceneOptions, seed: int) -> dict[str, GlassOutcome]:
    """A drive along panes of glass by every method, and the same along walls."""
    real, solid = (Simulation("glass", replace(options, seed=seed)) for _ in range(2))
    solid.scene = replace(solid.scene, world=_without_glass(solid.scene.world))
    items, walled = list(real.items()), list(solid.items())
    results = {}
    for method, config in METHODS.items():
        panes, pipeline = watched(real.scene.world, items, config)
        results[method] = GlassOutcome(outcome(process(walled, config)), outcome(pipeline), panes.flicker)
    return results


def struck(options: SceneOptions, seed: int) -> dict[Struck, dict[str, Outcome]]:
    """Drives through the rooms with more and more beams that do not reach the wall, by every method."""
    results = {}
    for rate in RATES:
        items = list(Simulation("rooms", replace(options, seed=seed, scan_rate=rate)).items())
        for share in SHARES:
            for missing in (False, True) if share else (False,):
                changed = list(astray(items, share, seed, missing=missing))
                outcomes = {name: outcome(process(changed, config)) for name, config in METHODS.items()}
                results[Struck(rate, share, missing)] = outcomes
    return results


def astray(items: Iterable[Item], share: float, seed: int, *, missing: bool = False) -> Iterator[Item]:
    """The items, with so many of the beams ending anywhere from NEAREST to where they should, or left out."""
    rng = np.random.default_rng([seed, 9])
    for item in items:
        if not isinstance(item, LaserScan):
            yield item
            continue
        far = np.where(np.isfinite(item.ranges), item.ranges, item.range_max)
        short = np.minimum(far, NEAREST) + rng.random(len(far)) * np.maximum(far - NEAREST, 0.0)
        hit = rng.random(len(far)) < share
        yield replace(item, ranges=np.where(hit, np.nan if missing else short, item.ranges).astype(np.float32))


def watched(world: World, items: Iterable[Item], config: SlamConfig) -> tuple["Panes", Pipeline]:
    """A run with an eye on the panes."""
    pipeline, panes = Pipeline(Settings(config)), Panes(world)
    for result in steps(pipeline, items):
        if result.index % EVERY == 0:
            panes.look(pipeline.slam.map.whole())
    return panes, pipeline


class Panes:
    """The cells along the panes of a world: how often each became occupied."""

    def __init__(self, world: World, resolution: float = 0.05) -> None:
        self._cells = _along(world.triangles[world.glass][:, :, :2], resolution)
        self._occupied = np.zeros(len(self._cells), np.bool_)
        self._risen = np.zeros(len(self._cells), np.int64)

    @property
    def flicker(self) -> float:
        """Share of the cells that were occupied again, of those that ever were."""
        ever = int(np.count_nonzero(self._risen))
        return int(np.count_nonzero(self._risen > 1)) / max(ever, 1)

    def look(self, level: GridLevel) -> None:
        """Compare the map with what it was at the last look; the map may have grown."""
        columns, rows = (self._cells - level.corner).T
        inside = (rows >= 0) & (columns >= 0) & (rows < level.shape[0]) & (columns < level.shape[1])
        occupied = np.zeros_like(self._occupied)
        occupied[inside] = level.log_odds[rows[inside], columns[inside]] > 0
        self._risen += occupied & ~self._occupied
        self._occupied = occupied


def _along(triangles: NDArray[np.float64], resolution: float) -> NDArray[np.int64]:
    """(n, 2) columns and rows in the lattice of the cells on and beside upright triangles (m, 3, 2), in plan."""
    share = np.linspace(0.0, 1.0, 1000)[:, None]
    lines = [
        a + share * (b - a) for corners in triangles for a, b in zip(corners, np.roll(corners, 1, 0), strict=True)
    ]
    cells = np.floor(np.concatenate(lines) / resolution).astype(np.int64)
    around = [cells + np.array([dx, dy]) for dx in (-1, 0, 1) for dy in (-1, 0, 1)]
    unique: NDArray[np.int64] = np.unique(np.concatenate(around), axis=0)
    return unique


def _without_glass(world: World) -> World:
    return replace(world, surfaces=[replace(surface, glass=False) for surface in world.surfaces])
