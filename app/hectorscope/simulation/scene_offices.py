"""Offices that look alike on both sides of a corridor of 60 m: a long patrol by a scanner that looks ahead only.

The robot turns in place at every door. People walk along the corridor, and one room has a wall of glass.
"""

from collections.abc import Sequence

import numpy as np

from hectorscope.simulation.course import Pace, follow
from hectorscope.simulation.motion import Motion
from hectorscope.simulation.options import SceneOptions
from hectorscope.simulation.people import Gait, Person, stroll
from hectorscope.simulation.scanner import LMS
from hectorscope.simulation.scene import Scene, Sway, overlay, rocking
from hectorscope.simulation.worlds import Surface, World, box, fence, post, wall
from slam_core.measurements import Float64s, Transform

DURATION = 1200.0
SPEED, TURN_RATE = 0.6, float(np.radians(100.0))  # m/s, rad/s
LASER = (0.1, 0.0, 0.25)  # m over the base
DEPTH = 20.0  # m of wall over and under the base: sway tests the attitude alone
OFFICES, WIDTH, LENGTH = 12, 5.0, 5.0  # on a side of the corridor; metres
HALF = 1.1  # m from the middle of the corridor to its walls
DOOR = (1.0, 2.2)  # m from the start of an office's wall to the corridor
GLASS = 6  # this office to the north has a pane beside its door
VISITS = ((0, 1), (2, -1), (3, 1), (5, -1), (6, 1), (8, 1), (9, -1), (11, 1), (10, -1), (7, -1), (4, 1), (1, -1))
WALKERS = 4
CLEAR = 0.8  # m that people keep from the robot


def build(options: SceneOptions) -> Scene:
    """The scene as `options` ask for it."""
    duration = options.duration or DURATION
    pace = Pace(speed=SPEED * options.speed, turn_rate=TURN_RATE, acceleration=0.8, radius=0.15)
    sway = rocking(Sway.chosen(options, 0.0, 0.5))
    motion = Motion.through(overlay(follow(_waypoints(), pace, duration), sway), duration)
    return Scene(_world(), motion, Transform(np.array(LASER)), people=_people(motion, options), scanner=LMS)


def _waypoints() -> Float64s:
    """Up the corridor and back; at each door in, once round, and out."""
    points: list[tuple[float, float]] = [(0.0, 0.0)]
    for k, side in VISITS:
        door = k * WIDTH + sum(DOOR) / 2
        back = -0.25 if k in {10, 7, 4, 1} else 0.25  # the way back
        inside = ((-back, 0.0), (-back, 4.4), (back + 1.6, 4.4), (back + 1.6, 2.9), (back, 2.9), (back, 0.0))
        if back < 0:
            inside = ((-back, 0.0), (-back, 2.9), (1.8, 2.9), (1.8, 4.4), (back, 4.4), (back, 0.0))
        points += [(door + along, side * away) for along, away in inside]
    return np.array([*points, (-1.5, 0.0), (-1.5, 0.4), (-0.8, 0.4), (-0.8, 0.0)])


def _people(motion: Motion, options: SceneOptions) -> tuple[Person, ...]:
    """Walkers along the corridor who make way for the robot; others with another seed."""
    if not options.people:
        return ()
    rng = np.random.default_rng([options.seed, 5])
    end, sides = OFFICES * WIDTH, np.linspace(-0.7, 0.7, WALKERS)
    lanes = [np.array([(-1.0, side), (end - 1.0, side)]) for side in sides]
    return tuple(_making_way(stroll(lane, motion.duration, Gait(), rng), motion) for lane in lanes)


def _making_way(person: Person, motion: Motion) -> Person:
    def way(t: Float64s) -> Float64s:
        robot = motion.at(np.clip(t, 0.0, motion.duration))[:, :2]
        away = person.way(t) - robot
        distance = np.maximum(np.hypot(*away.T), 1e-6)
        place: Float64s = robot + away * (np.maximum(distance, CLEAR) / distance)[:, None]
        return place

    return Person(way, person.radius)


def _world() -> World:
    low, high = -DEPTH, DEPTH
    end, far = OFFICES * WIDTH, HALF + LENGTH
    shapes = [box(-3.0, -far, end + 1.0, far, low, high), *_walls_to_the_corridor(end, low, high)]
    for k in range(OFFICES + 1):
        for side in (1, -1):
            shapes.append(wall((k * WIDTH, side * HALF), (k * WIDTH, side * far), low, high, 0.12))
    for k in range(OFFICES):
        for side in (1, -1):
            shapes += [_standing(k * WIDTH, side, thing, low, high) for thing in _furniture(k, side)]
    shapes += [post(-2.4, 0.6, 0.2, low, high), post(end + 0.5, -0.5, 0.2, low, high)]
    pane = np.array([(GLASS * WIDTH + DOOR[1] + 0.2, HALF), ((GLASS + 1) * WIDTH - 0.2, HALF)])
    return World(
        [Surface(np.concatenate(shapes)), Surface(fence(pane, low, high), glass=True)], ground=low, ceiling=high
    )


def _walls_to_the_corridor(end: float, low: float, high: float) -> list[Float64s]:
    doors = [(k * WIDTH + DOOR[0], k * WIDTH + DOOR[1]) for k in range(OFFICES)]
    glazed = [*doors, (GLASS * WIDTH + DOOR[1] + 0.2, (GLASS + 1) * WIDTH - 0.2)]
    return [
        wall((0.0, HALF), (end, HALF), low, high, 0.12, glazed),
        wall((0.0, -HALF), (end, -HALF), low, high, 0.12, doors),
    ]


def _furniture(k: int, side: int) -> Sequence[tuple[float, float, float, float]]:
    """Boxes of an office as x0, y0, x1, y1 from its corner: nearly the same in all of them."""
    rng = np.random.default_rng([k, side + 1, 6])
    shift = rng.uniform(-0.15, 0.15, 2)
    desk = (3.9 + shift[0], 1.4, 4.6 + shift[0], 3.0)
    cupboard = (0.1, 1.2 + shift[1], 0.5, 2.2 + shift[1])
    return (desk, cupboard, (4.3, 4.3, 4.8, 4.8)) if rng.random() < 0.3 else (desk, cupboard)


def _standing(x: float, side: int, thing: tuple[float, float, float, float], low: float, high: float) -> Float64s:
    x0, y0, x1, y1 = thing
    ys = sorted((side * (HALF + y0), side * (HALF + y1)))
    return box(x + x0, ys[0], x + x1, ys[1], low, high)
