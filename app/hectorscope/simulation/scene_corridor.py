"""A bare corridor of 120 m: two walls, so that a scan observes the position across it and not along it.

Both ends are out of the laser's sight for most of the way.
"""

import numpy as np

from hectorscope.simulation.course import Pace, follow
from hectorscope.simulation.motion import Motion
from hectorscope.simulation.options import SceneOptions
from hectorscope.simulation.scene import Scene, Sway, overlay, rocking
from hectorscope.simulation.worlds import Surface, World, box
from slam_core.measurements import Transform

DURATION = 90.0
SPEED = 1.0  # m/s
LASER = (0.1, 0.0, 0.25)  # m over the base
LENGTH, WIDTH = 120.0, 2.4  # m
BEHIND = 10.0  # m from the start back to the near end
DEPTH = 20.0  # m of wall over and under the base: sway tests the attitude alone
LANE = 0.5  # m of the way out to the right of the middle, and of the way back to the left

_FAR = LENGTH - BEHIND - 3.0
_WAYPOINTS = np.array([(0, 0), (_FAR, 0), (_FAR, 2 * LANE), (-5, 2 * LANE), (-5, 0)], dtype=np.float64)


def build(options: SceneOptions) -> Scene:
    """The scene as `options` ask for it."""
    duration = options.duration or DURATION
    pace = Pace(speed=SPEED * options.speed, turn_rate=np.radians(65), acceleration=0.8, radius=LANE)
    sway = rocking(Sway.chosen(options, 0.0, 0.5))
    motion = Motion.through(overlay(follow(_WAYPOINTS, pace, duration), sway), duration)
    return Scene(_world(), motion, Transform(np.array(LASER)))


def _world() -> World:
    right = LANE - WIDTH / 2
    walls = box(-BEHIND, right, LENGTH - BEHIND, right + WIDTH, -DEPTH, DEPTH)
    return World([Surface(walls)], ground=-DEPTH, ceiling=DEPTH)
