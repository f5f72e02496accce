"""Closed circuits of bare corridors that a car races through, measured by its laser alone.

On the straights few beams tell how far the car has come: those on shallow boxes along the walls, or on the next
bend.
"""

import heapq
from typing import Literal

import numpy as np

from hectorscope.inputs import Item
from hectorscope.simulation.course import Pace, follow
from hectorscope.simulation.motion import Motion
from hectorscope.simulation.options import SceneOptions
from hectorscope.simulation.scanner import Scanner
from hectorscope.simulation.scene import Scene, Sway, overlay, rocking
from hectorscope.simulation.sensors import laser_scans, truth
from hectorscope.simulation.worlds import Surface, World, box, fence
from slam_core.measurements import Float64s, Transform

Shape = Literal["square", "winding"]

HALF = {"square": 1.1, "winding": 1.2}  # metres from the middle to a wall
LOW, HIGH = -20.0, 20.0  # metres of wall under and over the base
LASER = (0.1, 0.0, 0.25)  # m over the base
SCANNER = Scanner(range_max=10.0, sigma_near=0.01, sigma_near_to=9.0, sigma_far=0.012)  # of small cars
RADIUS, ACCELERATION, TURN = 1.0, 4.0, np.radians(150.0)  # m, m/s^2, rad/s
DURATION = 60.0  # seconds
LEVEL = Sway(amplitude=0.0, frequency=1.0)  # the car does not sway
CORNERS = {
    "square": np.array([(0, 0), (12, 0), (22, 0), (22, 9), (-8, 9), (-8, 0)], float),
    "winding": np.array(
        [
            (0, 0), (9, 0), (12, 4), (9, 8), (14, 12), (20, 8),
            (20, -3), (14, -6), (2, -6), (-3, -9), (-9, -6), (-6, 0),
        ],
        float,
    ),
}  # fmt: skip
# Boxes on the right walls of the square's long sides, metres: length, depth, and where they begin.
LENGTH, DEPTH = 0.9, (0.12, 0.1)
FIRST, BACK = (-4.0, 3.0, 10.0, 17.0), (0.0, 7.0, 14.0)
SPACING = 0.4  # metres between the posts of a winding wall


def circuit(shape: Shape, speed: float, seed: int, duration: float = DURATION) -> list[Item]:
    """What a car measures that drives round at up to so many m/s, from a stand."""
    options = SceneOptions(seed=seed, duration=duration)
    pace = Pace(speed=speed, turn_rate=TURN, acceleration=ACCELERATION, radius=RADIUS)
    course = follow(CORNERS[shape], pace, duration)
    motion = Motion.through(overlay(course, rocking(LEVEL)), duration)
    walls = _square() if shape == "square" else _winding()
    world = World([Surface(np.concatenate(walls))], ground=LOW, ceiling=HIGH)
    scene = Scene(world, motion, Transform(np.array(LASER)), scanner=SCANNER)
    return [item for _, item in heapq.merge(truth(motion), laser_scans(scene, options), key=lambda each: each[0])]


def _square() -> list[Float64s]:
    """Two rectangles of walls, one in the other, and the boxes."""
    (left, bottom), (right, top), half = (-8, 0), (22, 9), HALF["square"]
    walls = [
        fence(np.array([(a, c), (b, c), (b, d), (a, d), (a, c)], float), LOW, HIGH)
        for a, b, c, d in (
            (left + half, right - half, bottom + half, top - half),
            (left - half, right + half, bottom - half, top + half),
        )
    ]
    walls += [box(x, bottom - half, x + LENGTH, bottom - half + DEPTH[0], LOW, HIGH) for x in FIRST]
    return walls + [box(x, top + half - DEPTH[1], x + LENGTH, top + half, LOW, HIGH) for x in BACK]


def _winding() -> list[Float64s]:
    """A wall on either side of the way."""
    outline = CORNERS["winding"]
    length = float(np.hypot(*np.diff(outline, axis=0, append=outline[:1]).T).sum())
    way = follow(outline, Pace(1.0, 9.0, 9.0, RADIUS), 2.0 * length)(np.arange(0.0, 2.0 * length, SPACING))
    # Back at the start, at 1 m/s long after the rest there.
    home = np.flatnonzero((np.hypot(*(way[:, :2] - way[0, :2]).T) < SPACING) & (np.arange(len(way)) > 50))[0]
    lap = np.concatenate((way[:home], way[:1]))
    beside = HALF["winding"] * np.column_stack((-np.sin(lap[:, 2]), np.cos(lap[:, 2])))
    return [fence(lap[:, :2] + side * beside, LOW, HIGH) for side in (1.0, -1.0)]
