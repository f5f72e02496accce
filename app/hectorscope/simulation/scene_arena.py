"""A rescue arena: plywood walls on a grid of 1.2 m, and floor elements that tilt the robot up to 15 degrees."""

from collections.abc import Callable

import numpy as np

from hectorscope.simulation.course import Pace, follow
from hectorscope.simulation.motion import Channels, Motion
from hectorscope.simulation.options import SceneOptions
from hectorscope.simulation.scene import Scene, Sway, overlay, rocking
from hectorscope.simulation.worlds import Surface, World, box, post, quad, wall
from slam_core.measurements import Float64s, Transform

DURATION = 60.0
SPEED = 0.56  # m/s on straights
LASER = (0.1, 0.0, 0.4)  # m over the base, which is where the tracks touch the ground
CELL = 1.2  # m
RISE = CELL * float(np.tan(np.radians(15.0)))  # m over one element
WALL_TOP, UNDERGROUND = 1.5, -0.3  # m
TRACK, CONTACT = 0.36, 0.5  # m between the tracks, and of each on the ground

# Floor elements: "." level, "P" a raised platform, "NESW" a ramp up to the platform's height, rising that way;
# "nesw" a cross slope: its middle is level with ".", the named side is high, the other low.
_PLAN = """
+-+-+-+-+-+-+-+-+-+-+
|. . .|. . .|e w|. .|
+ +-+-+-+-+ + +-+-+ +
|. .|. .|. n E W .|.|
+ +-+ +-+ +-+ +-+ + +
|. .|n . S|. . . w .|
+-+ +-+-+ + + + + +-+
|. s n E P|. . .|e|.|
+ +-+-+ +-+-+-+ + + +
|e|. .|. .|P W s . .|
+ + + + + + + +-+-+ +
|w . .|.|.|N|. e .|.|
+ +-+ + +-+ +-+ +-+ +
|. . . n s .|. . . .|
+-+ +-+-+ +-+ +-+-+ +
|. .|. .|. . .|. . .|
+-+-+-+-+-+-+-+-+-+-+
""".strip().splitlines()
_START = (1, 1)  # column and row of the element at the origin
_LAP = [(1, 1), (5, 1), (5, 3), (8, 3), (8, 6), (4, 6), (4, 4), (0, 4), (0, 1)]


def build(options: SceneOptions) -> Scene:
    """The scene as `options` ask for it."""
    duration = options.duration or DURATION
    pace = Pace(speed=SPEED * options.speed, turn_rate=np.radians(65), acceleration=0.4, radius=0.45)
    world = World([Surface(np.concatenate(list(_shapes())))], ground=UNDERGROUND)
    course = follow(np.array([_centre(*cell) for cell in _LAP]), pace, duration)
    swaying = overlay(course, rocking(Sway.chosen(options, 0.0, 0.5)))
    motion = Motion.through(on_tracks(world, course, swaying), duration)
    return Scene(world, motion, Transform(np.array(LASER)))


def on_tracks(world: World, course: Callable[[Float64s], Float64s], swaying: Channels) -> Channels:
    """Height and tilt of a plane through the ground under both tracks, added to the swaying motion."""
    along = np.linspace(-CONTACT / 2, CONTACT / 2, 9)

    def channels(t: Float64s) -> Float64s:
        values = swaying(t)
        x, y, yaw = course(t).T[..., None, None]
        ahead, left = np.meshgrid(along, [TRACK / 2, -TRACK / 2])
        east = x + ahead * np.cos(yaw) - left * np.sin(yaw)
        north = y + ahead * np.sin(yaw) + left * np.cos(yaw)
        ground = world.floor_height(east.ravel(), north.ravel()).reshape(east.shape)
        uphill = (ground * ahead).sum(axis=(1, 2)) / (ahead**2).sum()
        lean = (ground * left).sum(axis=(1, 2)) / (left**2).sum()
        values[:, 2] += ground.mean(axis=(1, 2))
        values[:, 3] += np.arcsin(lean / np.sqrt(1 + uphill**2 + lean**2))
        values[:, 4] -= np.arctan(uphill)
        return values

    return channels


def _centre(column: float, row: float) -> tuple[float, float]:
    return (column - _START[0]) * CELL, (row - _START[1]) * CELL


def _shapes() -> list[Float64s]:
    rows = len(_PLAN) // 2
    shapes = _obstacles()
    for line, text in enumerate(_PLAN):
        for place, mark in enumerate(text):
            x, y = _centre(place // 2, rows - 1 - line // 2)
            west, top = x - CELL / 2, y + CELL / 2
            if mark == "-":
                shapes.append(wall((west, top), (west + CELL, top), UNDERGROUND, WALL_TOP, 0.04))
            elif mark == "|":
                shapes.append(wall((west, top - CELL), (west, top), UNDERGROUND, WALL_TOP, 0.04))
            elif mark not in "+ ":
                shapes.append(_element(x, y, mark))
    return shapes


def _element(x: float, y: float, mark: str) -> Float64s:
    """One floor element around (x, y), with its sides down to the ground."""
    h = CELL / 2
    sides = {"n": (0, 0, 1, 1), "e": (0, 1, 1, 0), "s": (1, 1, 0, 0), "w": (1, 0, 0, 1)}
    level = {".": 0.0, "P": RISE}.get(mark, 0.0 if mark.isupper() else -RISE / 2)
    heights = [level + RISE * up for up in sides.get(mark.lower(), (0, 0, 0, 0))]
    plan = [(x - h, y - h), (x + h, y - h), (x + h, y + h), (x - h, y + h)]
    corners = [(*point, height) for point, height in zip(plan, heights, strict=True)]
    feet = [(*point, UNDERGROUND) for point in plan]
    skirt = [quad(feet[i - 1], feet[i], corners[i], corners[i - 1]) for i in range(4)]
    return np.concatenate([quad(*corners), *skirt])


def _obstacles() -> list[Float64s]:
    """Barrels, boxes and poles, in element coordinates (column, row, half sizes or radius, height)."""
    barrels = [(2.3, 2.2, 0.25, 0.9), (6.3, 4.3, 0.28, 0.9), (9.2, 1.2, 0.25, 0.9), (0.8, 6.8, 0.28, 0.9)]
    poles = [(5.4, 0.7, 0.05, 1.5), (8.35, 3.4, 0.05, 1.5), (7.7, 2.2, 0.06, 1.5), (4.3, 6.65, 0.05, 1.5)]
    boxes = [
        *[(1.2, 2.8, 0.3, 0.2, 0.6), (5.3, 5.2, 0.2, 0.3, 1.0), (7.2, 0.9, 0.4, 0.2, 0.7)],
        *[(3.3, 3.3, 0.2, 0.2, 1.2), (4.6, 7.2, 0.5, 0.2, 0.8), (9.3, 5.1, 0.15, 0.4, 1.1)],
        *[(0.2, 0.1, 0.25, 0.25, 0.8), (1.9, 0.05, 0.2, 0.3, 1.0), (6.0, -0.2, 0.5, 0.15, 0.7)],
        *[(1.0, 5.1, 0.3, 0.15, 0.9), (2.6, 6.1, 0.3, 0.2, 1.3), (9.1, 7.2, 0.3, 0.2, 0.9)],
    ]
    shapes = [post(*_centre(c, r), radius, UNDERGROUND, top) for c, r, radius, top in barrels + poles]
    for column, row, half_x, half_y, top in boxes:
        x, y = _centre(column, row)
        shapes.append(box(x - half_x, y - half_y, x + half_x, y + half_y, UNDERGROUND, top))
    return shapes
