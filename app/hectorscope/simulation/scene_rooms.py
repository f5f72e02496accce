"""Rooms of 30 x 20 m on level ground: the scene for benchmarks of speed and accuracy.

Everything is as high and as deep as the beams of a swaying laser reach, so that sway tests the attitude alone.
"""

import numpy as np

from hectorscope.simulation.course import Pace, follow
from hectorscope.simulation.motion import Motion
from hectorscope.simulation.options import SceneOptions
from hectorscope.simulation.scene import Scene, Sway, overlay, rocking
from hectorscope.simulation.worlds import Surface, World, box, post, wall
from slam_core.measurements import Float64s, Transform

DURATION = 60.0
SPEED = 1.36  # m/s
LASER = (0.1, 0.0, 0.25)  # m over the base
DEPTH = 20.0  # m of wall over and under the base

_WAYPOINTS = np.array(
    [
        *[(0, 0), (4.5, 0), (4.5, 5.5), (11, 5.5), (11, 0.5), (17.5, 0.5), (17.5, 7.5), (21.5, 7.5)],
        *[(21.5, 13.5), (11, 13.5), (11, 10), (1, 10), (1, 13), (-3, 13), (-3, 0)],
    ],
    dtype=np.float64,
)


def build(options: SceneOptions) -> Scene:
    """The scene as `options` ask for it."""
    duration = options.duration or DURATION
    sway = Sway.chosen(options, 0.0, 0.5)
    pace = Pace(speed=SPEED * options.speed, turn_rate=np.radians(65), acceleration=0.8, radius=1.0)
    motion = Motion.through(overlay(follow(_WAYPOINTS, pace, duration), rocking(sway)), duration)
    return Scene(_world(), motion, Transform(np.array(LASER)))


def _world() -> World:
    low, high = -DEPTH, DEPTH

    def partition(a: tuple[float, float], b: tuple[float, float], *gaps: tuple[float, float]) -> Float64s:
        return wall(a, b, low, high, 0.15, gaps)

    shapes = [
        box(-5.0, -4.0, 25.0, 16.0, low, high),
        partition((7.5, -4), (7.5, 16), (8.7, 10.3), (13.2, 14.8)),
        partition((14.5, -4), (14.5, 11.5), (3.8, 5.2)),
        partition((-5, 7.5), (7.5, 7.5), (1.2, 2.8), (9.0, 10.2)),
        partition((7.5, 7.5), (14.5, 7.5), (2.8, 4.2)),
        partition((14.5, 4.5), (25, 4.5), (2.2, 3.8)),
        partition((14.5, 11.5), (25, 11.5), (6.2, 7.8)),
        box(-4.6, -3.6, -3.2, -2.8, low, high),
        box(1.0, 3.0, 2.4, 4.2, low, high),
        box(8.0, -3.6, 9.0, -1.6, low, high),
        box(12.6, 2.6, 14.0, 3.6, low, high),
        box(19.6, -3.2, 21.0, -0.8, low, high),
        box(23.2, 6.0, 24.6, 9.0, low, high),
        box(16.0, 14.6, 18.4, 15.6, low, high),
        box(-4.6, 9.0, -4.0, 11.6, low, high),
        post(5.8, -2.0, 0.25, low, high),
        post(5.0, 13.5, 0.3, low, high),
        post(22.5, 2.0, 0.3, low, high),
    ]
    return World([Surface(np.concatenate(shapes))], ground=low, ceiling=high)
