"""What the laser's beams come back from: walls, panes of glass or what lies behind them, and people."""

import numpy as np

from hectorscope.simulation.people import distances as to_people
from hectorscope.simulation.scene import Scene
from hectorscope.simulation.worlds import World
from slam_core.geometry import rotation_matrix
from slam_core.measurements import Float64s

PANES = 4  # that a beam passes at most
# From the normal: there the share of the beams that glass returns has fallen to 1/e.
HEAD_ON = float(np.radians(12.0))
STRAY = 0.03  # share of the beams that glass returns at any angle: dirt
_BEHIND = 1e-6  # m


def laser_rays(scene: Scene, t: Float64s, angles: Float64s) -> tuple[Float64s, Float64s]:
    """(n, 3) origins and unit directions in the map of beams at (n,) seconds and (n,) scan angles."""
    positions, attitudes = scene.motion.poses(t)
    beams = np.column_stack((np.cos(angles), np.sin(angles), np.zeros(len(angles))))
    in_base = beams @ rotation_matrix(scene.T_base_laser.rotation).T
    origins = positions + attitudes @ scene.T_base_laser.translation
    return origins, np.einsum("mij,mj->mi", attitudes, in_base)


def first_returns(
    scene: Scene, t: Float64s, angles: Float64s, reach: float, rng: np.random.Generator
) -> tuple[Float64s, Float64s]:
    """(n,) distances of beams at (n,) seconds, inf without a return, and how deep each may enter what it met."""
    origins, directions = laser_rays(scene, t, angles)
    distances, depths = _through_glass(scene.world, origins, directions, reach, rng)
    people = to_people(scene.people, origins, directions, t)
    met = people < np.minimum(distances, reach)
    return np.where(met, people, distances), np.where(met, 0.0, depths)


def _through_glass(
    world: World, origins: Float64s, directions: Float64s, reach: float, rng: np.random.Generator
) -> tuple[Float64s, Float64s]:
    """Distances and depths of what stands still; `rng` decides for every pane that a beam meets."""
    distances, hits = world.cast(origins, directions, reach)
    on = np.arange(len(hits))
    for _ in range(PANES if world.glass.any() else 0):
        met = on[(hits[on] >= 0) & world.glass[hits[on]]]
        on = met[rng.random(len(met)) > _returned(world, directions[met], hits[met])]
        start = origins[on] + (distances[on] + _BEHIND)[:, None] * directions[on]
        beyond, hits[on] = world.cast(start, directions[on], reach)
        distances[on] += beyond
    return distances, np.where(hits >= 0, world.depths[hits], 0.0)


def _returned(world: World, directions: Float64s, hits: np.ndarray) -> Float64s:
    """(n,) chance that glass returns a beam, by its angle to the normal."""
    cosines = np.abs(np.einsum("ij,ij->i", directions, world.normals[hits]))
    angles = np.arccos(np.minimum(cosines, 1.0))
    share: Float64s = STRAY + (1.0 - STRAY) * np.exp(-((angles / HEAD_ON) ** 2))
    return share
