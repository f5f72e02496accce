"""Small made worlds for tests of the core: smooth maps and rooms with exact ranges."""

import numpy as np
from numpy.typing import NDArray

from slam_core.config import SlamConfig
from slam_core.kernels.bilinear import UNKNOWN_PARTS, WHOLE
from slam_core.kernels.correlative import count_hits
from slam_core.mapping.grid import GridLevel
from slam_core.mapping.pyramid import Pyramid
from slam_core.mapping.tiled_map import TiledMap
from slam_core.mapping.tiles import Box, Kind
from slam_core.measurements import LaserScan, Transform
from slam_core.results import Fit
from slam_core.scan.stabilise import stabilise


def in_parts(probability: NDArray[np.float64]) -> NDArray[np.int16]:
    """Probabilities as a level keeps them."""
    return (np.minimum(np.rint(np.asarray(probability) * WHOLE), WHOLE - 1) - UNKNOWN_PARTS).astype(np.int16)


def smooth_level(seed: int = 0, cells: int = 64, resolution: float = 0.05) -> GridLevel:
    """A level whose probability is a smooth random field in (0.1, 0.9), its corner at the map's origin."""
    rng = np.random.default_rng(seed)
    level = GridLevel(resolution, (cells, cells), np.zeros(2))
    u, v = np.meshgrid(np.arange(cells), np.arange(cells))
    waves = rng.uniform(0.05, 0.3, (4, 2))
    phases = rng.uniform(0, 2 * np.pi, 4)
    field = sum(np.sin(a * u + b * v + p) for (a, b), p in zip(waves, phases, strict=True))
    level.cells[:] = in_parts(0.5 + 0.1 * field)
    return level


def fit(level: GridLevel, points: NDArray[np.float32], pose: NDArray[np.float64]) -> Fit:
    """How endpoints (n, 2) at a pose (3,) meet a level."""
    counts = count_hits(level.cells, level.corner, 1.0 / level.resolution, points, pose)
    return Fit.counted(len(points), *counts)


def standing(from_ns: int, since_ns: NDArray[np.int64]) -> NDArray[np.float64]:
    """The motion of a base that stands level at the origin."""
    return np.tile([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], (len(since_ns), 1))


def room_ranges(
    pose: NDArray[np.float64], angles: NDArray[np.float64], half_width: float = 4.025, half_height: float = 3.025
) -> NDArray[np.float64]:
    """Exact ranges to the walls of a rectangle around the origin, in the middle of 5 cm cells, and one pillar."""
    c, s = np.cos(angles + pose[2]), np.sin(angles + pose[2])
    with np.errstate(divide="ignore"):
        walls = np.minimum(
            np.where(c > 0, half_width - pose[0], half_width + pose[0]) / np.abs(c),
            np.where(s > 0, half_height - pose[1], half_height + pose[1]) / np.abs(s),
        )
    offset = np.array([1.5, 1.0]) - pose[:2]
    along = offset[0] * c + offset[1] * s
    inside = 0.3**2 - (offset @ offset - along**2)
    pillar = np.where((inside > 0) & (along > 0), along - np.sqrt(np.maximum(inside, 0.0)), np.inf)
    return np.minimum(walls, pillar)


def room_scan(
    pose: NDArray[np.float64], stamp_ns: int = 0, beams: int = 541, noise: float = 0.0, seed: int = 0
) -> LaserScan:
    """An instantaneous scan of that room over 270 degrees."""
    angles = np.linspace(-0.75 * np.pi, 0.75 * np.pi, beams)
    ranges = room_ranges(pose, angles) + noise * np.random.default_rng(seed + stamp_ns).standard_normal(beams)
    return LaserScan(
        stamp_ns, ranges.astype(np.float32), angles[0], angles[1] - angles[0], range_min=0.1, range_max=30.0,
        T_base_laser=Transform(),
    )  # fmt: skip


def mapped_room(config: SlamConfig) -> Pyramid:
    """That room, mapped from four places."""
    pyramid = Pyramid(config.map)
    for pose in np.array([[0, 0, 0], [1, -1, 1], [-1, 1, 2], [-2, -1, 3]], float):
        scan = stabilise(room_scan(pose), standing, config.scan)
        pyramid.update(scan.points, scan.cleared, scan.laser, pose, config.map)
    return pyramid


def same_map(a: TiledMap, b: TiledMap) -> bool:
    """Whether both hold the same in every cell and surfel of every level, wherever the windows lie."""
    return all(_known_cells(a, level) == _known_cells(b, level) for level in range(len(a.levels)))


def _known_cells(pyramid: TiledMap, level: int) -> tuple[Box, list[bytes]]:
    """The known box in the lattice and what is in it; nothing may be outside."""
    box, grid = pyramid.bounds(level), pyramid.levels[level]
    row0, row1, column0, column1 = grid.known
    for array in (grid.log_odds, grid.cells, grid.surfels):
        known = array[row0:row1, column0:column1]
        assert np.count_nonzero(array) == np.count_nonzero(known)
    kinds: tuple[Kind, ...] = ("log_odds", "cells") if level else ("log_odds", "cells", "surfels")
    return box, [pyramid.gather(level, box, kind).tobytes() for kind in kinds]
