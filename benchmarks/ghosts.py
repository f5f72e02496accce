"""What people leave behind in the map: occupied cells where in truth nothing stands any more.

A cell counts as seen while a beam of the true pose, with nothing in its way, could pass it. Its time in sight
begins when the last person has left it; a ghost is a cell that is still occupied after SIGHT_S of that.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.accuracy import Outcome, outcome, process, steps
from benchmarks.cases import METHODS
from hectorscope.inputs import Item
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from hectorscope.simulation import SceneOptions, Simulation
from hectorscope.simulation.beams import first_returns, laser_rays
from hectorscope.simulation.scanner import UTM30LX
from hectorscope.simulation.scene import Scene
from hectorscope.simulation.sensors import START_NS
from slam_core.config import SlamConfig
from slam_core.mapping.grid import GridLevel
from slam_core.measurements import Float64s
from slam_core.results import StepResult

SIGHT_S = 5.0
EVERY = 8  # scans between two looks at the map
AROUND = 0.15  # m around walls and people where an occupied cell may be theirs: noise, and an inaccurate pose

Cells = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class HallOutcome:
    """Errors with people in the hall; ghosts: cells that ever were one.

    longest: seconds in sight until the last cell that people had left was free.
    """

    people: Outcome
    ghosts: int
    longest: float


def crowd(options: SceneOptions, seed: int) -> dict[str, HallOutcome]:
    """A drive among people by every method."""
    simulation = Simulation("people", replace(options, seed=seed))
    items = list(simulation.items())
    results = {}
    for method, config in METHODS.items():
        watch, pipeline = watched(simulation.scene, items, config)
        results[method] = HallOutcome(outcome(pipeline), watch.ghosts, watch.longest)
    return results


def nobody(options: SceneOptions, seed: int) -> dict[str, Outcome]:
    """The same drive through the empty hall."""
    items = list(Simulation("people", replace(options, seed=seed, people=False)).items())
    return {method: outcome(process(items, config)) for method, config in METHODS.items()}


def watched(scene: Scene, items: Iterable[Item], config: SlamConfig) -> tuple["Watch", Pipeline]:
    """A run with an eye on the map."""
    pipeline, watch = Pipeline(Settings(config)), Watch(scene)
    for result in steps(pipeline, items):
        if result.index % EVERY == 0:
            watch.look(result, pipeline.slam.map.whole())
    return watch, pipeline


class Watch:
    """Every cell of the hall: for how long it was in sight since somebody stood there, and the ghosts."""

    def __init__(self, scene: Scene, resolution: float = 0.05) -> None:
        self._scene = scene
        corners = scene.world.triangles[:, :, :2].reshape(-1, 2)
        self._first = np.floor(corners.min(axis=0) / resolution).astype(np.int64)
        columns, rows = np.ceil(corners.max(axis=0) / resolution).astype(np.int64) - self._first + 1
        ahead = np.arange(max(rows, columns)) + 0.5
        self._x = (self._first[0] + ahead[:columns])[None, :] * resolution
        self._y = (self._first[1] + ahead[:rows])[:, None] * resolution
        self._static = _near_walls(scene, self._x, self._y)
        self._sight = np.zeros((rows, columns))
        self._ghosts = np.zeros((rows, columns), np.bool_)
        self._last = 0.0
        self.longest = 0.0

    @property
    def ghosts(self) -> int:
        """Cells that ever were a ghost."""
        return int(np.count_nonzero(self._ghosts))

    def look(self, result: StepResult, level: GridLevel) -> None:
        """Compare the map with the truth of this moment."""
        t = (result.stamp_ns - START_NS) * 1e-9
        taken = self._taken(t)
        self._sight += (t - self._last) * self._visible(t)
        self._sight[taken] = 0.0
        self._last = t
        (left, low), (rows, columns) = self._first.tolist(), self._static.shape
        occupied = level.gather((low, low + rows, left, left + columns)) > 0
        stale = occupied & ~taken & ~self._static
        self._ghosts |= stale & (self._sight > SIGHT_S)
        if stale.any():
            self.longest = max(self.longest, float(self._sight[stale].max()))

    def _taken(self, t: float) -> Cells:
        taken = np.zeros(self._static.shape, np.bool_)
        for person in self._scene.people:
            x, y = person.way(np.array([t]))[0]
            taken |= (self._x - x) ** 2 + (self._y - y) ** 2 < (person.radius + AROUND) ** 2
        return taken

    def _visible(self, t: float) -> Cells:
        angles = np.linspace(-0.5, 0.5, 1081) * UTM30LX.field
        at = np.full(len(angles), t)
        origins, directions = laser_rays(self._scene, at, angles)
        reach, _ = first_returns(self._scene, at, angles, UTM30LX.range_max, np.random.default_rng(0))
        middle = np.arctan2(directions[540, 1], directions[540, 0])
        dx, dy = self._x - origins[0, 0], self._y - origins[0, 1]
        bearing = np.arctan2(dy, dx) - middle
        beam = np.rint((np.mod(bearing + np.pi, 2 * np.pi) - np.pi) / UTM30LX.field * 1080 + 540).astype(np.int64)
        within = (beam >= 0) & (beam <= 1080)
        seen: NDArray[np.bool_] = within & (np.hypot(dx, dy) + AROUND < reach[np.clip(beam, 0, 1080)])
        return seen


def _near_walls(scene: Scene, x: Float64s, y: Float64s) -> Cells:
    """Cells whose centres (x, y) lie within AROUND of a wall, seen in plan."""
    near = np.zeros((y.size, x.size), np.bool_)
    upright = np.abs(scene.world.normals[:, 2]) < 0.5
    for corners in scene.world.triangles[upright, :, :2]:
        for a, b in zip(corners, np.roll(corners, 1, axis=0), strict=True):
            d = b - a
            u = np.clip(((x - a[0]) * d[0] + (y - a[1]) * d[1]) / max(float(d @ d), 1e-12), 0.0, 1.0)
            near |= (x - a[0] - u * d[0]) ** 2 + (y - a[1] - u * d[1]) ** 2 < AROUND**2
    return near
