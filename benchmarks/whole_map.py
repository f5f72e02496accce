"""Finding a robot anywhere in a saved map: how often, how surely, how fast.

    python -m benchmarks.whole_map

Maps are made by one drive, scans come from another with other noise, at random times. The site of 100 x 100 m is
made of random walls and boxes, and mapped and looked at from random places with exact poses.
"""

import argparse
import math
import time
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

from benchmarks.accuracy import process
from hectorscope.run.warmup import load_everything
from hectorscope.simulation import SceneOptions, Simulation
from hectorscope.simulation.options import ScenarioName
from hectorscope.simulation.worlds import Surface, World, box, wall
from slam_core import geometry
from slam_core.config import SlamConfig
from slam_core.localization.global_search import locate
from slam_core.mapping.pyramid import Pyramid
from slam_core.measurements import Float64s, Int64s, LaserScan
from slam_core.navigation.planar_motion import PlanarMotion
from slam_core.scan.stabilise import StabilisedScan, stabilise

STARTS = 100
NEAR = (0.1, 0.05)  # metres, radians: a place that is right
SITE_M, GRID_M, BEAMS = 100.0, 2.5, 1081
SEEN = tuple[StabilisedScan, Float64s]
"""A scan and the pose (3,) in the map that it was taken from."""


@dataclass(frozen=True, slots=True)
class Finding:
    """One map: its size in metres, what came of scans taken in it and of some from elsewhere, seconds a search."""

    name: str
    size: tuple[float, float]
    found: int
    wrong: int
    starts: int
    foreign_taken: int
    foreign: int
    seconds: list[float]
    foreign_seconds: list[float]


def measure() -> list[Finding]:
    """Rooms, arena and site, each with the scans of the one before as those from elsewhere."""
    maps = [("rooms", *driven("rooms")), ("arena", *driven("arena")), ("site", *made_site())]
    return [judge(name, pyramid, seen, maps[k - 1][2]) for k, (name, pyramid, seen) in enumerate(maps)]


def judge(name: str, pyramid: Pyramid, seen: list[SEEN], elsewhere: list[SEEN]) -> Finding:
    """Every scan sought in the map."""
    found = wrong = taken = 0
    seconds, foreign_seconds = [], []
    for scan, truth in seen:
        begin = time.perf_counter()
        match = locate(pyramid, scan, SlamConfig()).match
        seconds.append(time.perf_counter() - begin)
        right = match is not None and is_near(match.pose, truth)
        found, wrong = found + right, wrong + (match is not None and not right)
    for scan, _ in elsewhere:
        begin = time.perf_counter()
        taken += locate(pyramid, scan, SlamConfig()).match is not None
        foreign_seconds.append(time.perf_counter() - begin)
    row0, row1, column0, column1 = pyramid.bounds()
    size = (column1 - column0) * pyramid.levels[0].resolution, (row1 - row0) * pyramid.levels[0].resolution
    return Finding(name, size, found, wrong, len(seen), taken, len(elsewhere), seconds, foreign_seconds)


def is_near(pose: Float64s, truth: Float64s) -> bool:
    """Whether a place is right."""
    error = geometry.compose(geometry.inverse(truth), pose)
    return math.hypot(error[0], error[1]) < NEAR[0] and abs(error[2]) < NEAR[1]


def driven(scene: ScenarioName) -> tuple[Pyramid, list[SEEN]]:
    """The map of one drive, and scans of another."""
    pipeline = process(Simulation(scene, SceneOptions(seed=1)).items(), SlamConfig())
    x, y, _, yaw = pipeline.truth_in_map
    other = Simulation(scene, SceneOptions(seed=2))
    scans = [item for item in other.items() if isinstance(item, LaserScan)]
    chosen = np.random.default_rng(0).choice(len(scans), STARTS, replace=False)
    seen = [
        (
            stabilise(scan, partial(_motion, other), SlamConfig().scan),
            geometry.compose(np.array([x, y, yaw]), geometry.planar(other.truth_at(scan.mid_ns))),
        )
        for scan in (scans[k] for k in sorted(chosen.tolist()))
    ]
    return pipeline.slam.map, seen


def _motion(simulation: Simulation, from_ns: int, since_ns: Int64s) -> Float64s:
    poses = [simulation.truth_at(from_ns + time_ns) for time_ns in since_ns.tolist()]
    return np.array([[*pose.rotation, *pose.translation] for pose in poses])


def made_site() -> tuple[Pyramid, list[SEEN]]:
    """A large map of random rooms, and scans from anywhere in it."""
    rng, world, config = np.random.default_rng(0), _site(1), SlamConfig()
    pyramid = Pyramid(config.map)
    for x in np.arange(GRID_M, SITE_M, GRID_M):
        for y in np.arange(GRID_M, SITE_M, GRID_M):
            for psi in (0.0, math.pi):
                pose = np.array([x, y, psi])
                scan = _look(world, pose, rng)
                pyramid.update(scan.points, scan.cleared, scan.laser, pose, config.map)
    poses = rng.uniform([1.0, 1.0, -math.pi], [SITE_M - 1.0, SITE_M - 1.0, math.pi], (STARTS, 3))
    return pyramid, [(_look(world, pose, rng), pose) for pose in poses]


def _site(seed: int) -> World:
    rng = np.random.default_rng(seed)
    shapes = [box(0, 0, SITE_M, SITE_M, -1, 3), *_walls(rng)]
    for x, y, wide, deep in rng.uniform([1, 1, 0.4, 0.4], [SITE_M - 3, SITE_M - 3, 1.6, 1.6], (250, 4)):
        shapes.append(box(x, y, x + wide, y + deep, -1, 3))
    return World([Surface(np.concatenate(shapes))])


def _walls(rng: np.random.Generator) -> Iterator[Float64s]:
    """Four in five of the walls between rooms of 10 m, each with a door."""
    for a in np.arange(10.0, SITE_M, 10.0):
        for b in np.arange(0.0, SITE_M, 10.0):
            for begin, end in (((a, b), (a, b + 10.0)), ((b, a), (b + 10.0, a))):
                door = rng.uniform(1.0, 8.0)
                if rng.random() < 0.8:
                    yield wall(begin, end, -1, 3, 0.15, [(door, door + 1.2)])


def _look(world: World, pose: Float64s, rng: np.random.Generator) -> StabilisedScan:
    """An instantaneous scan over 270 degrees with a centimetre of noise."""
    angles = np.linspace(-0.75 * math.pi, 0.75 * math.pi, BEAMS)
    turned = angles + pose[2]
    directions = np.column_stack([np.cos(turned), np.sin(turned), np.zeros(BEAMS)])
    ranges, _ = world.cast(np.tile([pose[0], pose[1], 0.3], (BEAMS, 1)), directions, 30.0)
    noisy = (ranges + 0.01 * rng.standard_normal(BEAMS)).astype(np.float32)
    scan = LaserScan(0, noisy, angles[0], float(angles[1] - angles[0]), 0.0, 0.1, 30.0)
    return stabilise(scan, PlanarMotion().poses, SlamConfig().scan)  # one that stands at the origin


def main() -> None:
    """Print what the tables are made of."""
    argparse.ArgumentParser(description=__doc__.splitlines()[0]).parse_args()
    load_everything()
    for each in measure():
        print(
            f"{each.name}: {each.size[0]:.0f} x {each.size[1]:.0f} m, {each.found} of {each.starts} found, "
            f"{each.wrong} wrong, {each.foreign_taken} of {each.foreign} from elsewhere taken, "
            f"{np.median(each.seconds):.3f} s, at most {max(each.seconds):.2f} s, "
            f"from elsewhere at most {max(each.foreign_seconds):.2f} s"
        )


if __name__ == "__main__":
    main()
