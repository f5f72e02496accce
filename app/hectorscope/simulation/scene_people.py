"""A hall where people walk: to and fro across it, stopping now and then, and one always beside the robot.

The robot drives rounds and stands still for a while, with people passing before it.
"""

import numpy as np

from hectorscope.simulation.course import Pace, follow
from hectorscope.simulation.motion import Motion
from hectorscope.simulation.options import SceneOptions
from hectorscope.simulation.people import Gait, Person, stroll
from hectorscope.simulation.scene import Scene, Sway, ease_in, overlay, rocking
from hectorscope.simulation.worlds import Surface, World, box, post
from slam_core.measurements import Float64s, Transform

DURATION = 60.0
SPEED = 0.8  # m/s
LASER = (0.1, 0.0, 0.25)  # m over the base
DEPTH = 20.0  # m of wall over and under the base: sway tests the attitude alone
REST = (30.0, 12.0)  # s from the start until the robot stands still, and for how long
BESIDE = 0.9  # m to the left of the robot walks its companion
CLEAR = 0.7  # m that the others keep from the robot

_WAYPOINTS = np.array([(0, 0), (11.5, 0), (11.5, 6), (-1.5, 6), (-1.5, 0)], dtype=np.float64)
_LANES = (
    [(1.6, -2.4), (1.6, 8.4)],
    [(8.6, -2.4), (8.6, 8.4)],
    [(-3.8, 1.5), (14.4, 1.2)],
    [(-3.8, 4.6), (14.4, 5.0)],
    [(13.4, -1.0), (13.4, 7.6)],
    [(3.0, 8.0), (3.0, 3.9), (7.0, 3.9), (9.9, 1.0), (9.9, -2.4)],
)


def build(options: SceneOptions) -> Scene:
    """The scene as `options` ask for it."""
    duration = options.duration or DURATION
    pace = Pace(speed=SPEED * options.speed, turn_rate=np.radians(65), acceleration=0.8, radius=1.0)
    course = follow(_WAYPOINTS, pace, duration)
    sway = rocking(Sway.chosen(options, 0.0, 0.5))
    motion = Motion.through(overlay(lambda t: course(_resting(t)), sway), duration)
    return Scene(_world(), motion, Transform(np.array(LASER)), people=_people(motion, options))


def _resting(t: Float64s) -> Float64s:
    """(m,) seconds of driving at (m,) seconds: the rest takes a second to set in and to end."""
    start, length = REST
    fine = np.arange(-1.0, max(float(t.max()), 0.0) + 0.02, 0.01)
    driving = 1.0 - ease_in(fine, start, 1.0) + ease_in(fine, start + length, 1.0)
    driven = np.cumsum(driving) * 0.01
    driving_time: Float64s = np.interp(t, fine, driven - driven[100])
    return driving_time


def _people(motion: Motion, options: SceneOptions) -> tuple[Person, ...]:
    """Walkers on every lane that keep clear of the robot, and its companion; others with another seed."""
    if not options.people:
        return ()
    rng = np.random.default_rng([options.seed, 4])
    t = np.arange(0.0, motion.duration, 0.1)
    robot = motion.at(t)[:, :2]
    walkers = [_clear_of(robot, t, np.array(lane), rng) for lane in _LANES]
    return (*walkers, Person(lambda t: _beside(motion, t), 0.2))


def _clear_of(robot: Float64s, t: Float64s, lane: Float64s, rng: np.random.Generator) -> Person:
    while True:
        person = stroll(lane, t[-1], Gait(), rng)
        if np.linalg.norm(person.way(t) - robot, axis=1).min() > CLEAR:
            return person


def _beside(motion: Motion, t: Float64s) -> Float64s:
    pose = motion.at(np.clip(t, 0.0, motion.duration))
    place: Float64s = pose[:, :2] + BESIDE * np.column_stack((-np.sin(pose[:, 5]), np.cos(pose[:, 5])))
    return place


def _world() -> World:
    low, high = -DEPTH, DEPTH
    shapes = [
        box(-4.5, -3.0, 15.0, 9.0, low, high),
        box(4.0, 2.2, 6.0, 3.4, low, high),
        box(4.5, -3.0, 6.5, -2.2, low, high),
        box(10.6, 7.8, 12.6, 9.0, low, high),
        box(-4.5, 2.2, -4.2, 4.2, low, high),
        post(7.3, 2.4, 0.2, low, high),
        post(-3.0, 2.9, 0.25, low, high),
        post(5.5, 7.6, 0.2, low, high),
    ]
    return World([Surface(np.concatenate(shapes))], ground=low, ceiling=high)
