"""A hall with a long pane of glass to an office behind it, and a glass booth: no two scans see the same walls."""

import numpy as np

from hectorscope.simulation.course import Pace, follow
from hectorscope.simulation.motion import Motion
from hectorscope.simulation.options import SceneOptions
from hectorscope.simulation.scene import Scene, Sway, overlay, rocking
from hectorscope.simulation.worlds import Surface, World, box, fence, post
from slam_core.measurements import Transform

DURATION = 60.0
SPEED = 0.8  # m/s
LASER = (0.1, 0.0, 0.25)  # m over the base
DEPTH = 20.0  # m of wall over and under the base: sway tests the attitude alone
PANE = [(-1.5, 7.0), (9.5, 7.0)]
BOOTH = [(3.0, 1.8), (6.0, 1.8), (6.0, 3.6), (3.0, 3.6), (3.0, 1.8)]

_WAYPOINTS = np.array([(0, 0), (9.5, 0), (9.5, 5.2), (-1.5, 5.2), (-1.5, 0)], dtype=np.float64)


def build(options: SceneOptions) -> Scene:
    """The scene as `options` ask for it."""
    duration = options.duration or DURATION
    pace = Pace(speed=SPEED * options.speed, turn_rate=np.radians(65), acceleration=0.8, radius=1.0)
    sway = rocking(Sway.chosen(options, 0.0, 0.5))
    motion = Motion.through(overlay(follow(_WAYPOINTS, pace, duration), sway), duration)
    return Scene(_world(), motion, Transform(np.array(LASER)))


def _world() -> World:
    low, high = -DEPTH, DEPTH
    hall = fence(
        np.array([PANE[0], (-4, 7), (-4, -2.5), (12, -2.5), (12, 7), PANE[1]], dtype=np.float64), low, high
    )
    office = fence(np.array([PANE[0], (-1.5, 10.5), (9.5, 10.5), PANE[1]], dtype=np.float64), low, high)
    things = [
        box(1.0, 9.0, 2.6, 9.8, low, high),
        box(6.0, 8.6, 7.0, 10.0, low, high),
        box(10.8, -2.5, 12.0, -1.5, low, high),
        post(4.4, 2.7, 0.25, low, high),
        post(-3.0, 2.0, 0.2, low, high),
    ]
    panes = np.concatenate([fence(np.array(outline), low, high) for outline in (PANE, BOOTH)])
    walls = Surface(np.concatenate([hall, office, *things]))
    return World([walls, Surface(panes, glass=True)], ground=low, ceiling=high)
