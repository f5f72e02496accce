"""Doors and boxes in a world, which a hand moves while a robot drives there."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from hectorscope.simulation.worlds import Surface, World, box
from hectorscope.steering import Place
from slam_core.measurements import Float64s

Rectangle = tuple[float, float, float, float]

# The doorways of each world as x0, y0, x1, y1 in metres; they are open at first.
DOORS: Mapping[str, tuple[Rectangle, ...]] = {
    "rooms": ((7.42, 4.7, 7.58, 6.3), (7.42, 9.2, 7.58, 10.8), (14.42, -0.2, 14.58, 1.2)),
}
BOXES = 2
HALF = 0.3  # m: half the side of a box
AHEAD = 1.5  # m from the robot
CLEAR = 0.5  # m that stay free around the middle of the robot
FARTHEST = 100.0  # m from the start
DEPTH = 20.0  # m over and under the base, as the walls are
TOO_NEAR = "It would stand in the robot: drive away first"


class Furniture:
    """Boxes are away at first. numbers count from 0; those of nothing are ignored."""

    def __init__(self, bare: World, name: str) -> None:
        self._bare, self._ways = bare, DOORS.get(name, ())
        self.doors: tuple[bool, ...] = (True,) * len(self._ways)
        self.boxes: tuple[Place | None, ...] = (None,) * BOXES
        self._world: World | None = bare

    @property
    def world(self) -> World:
        """The world with what stands in it; built again after a change only."""
        if self._world is None:
            shapes = [box(*each, -DEPTH, DEPTH) for each in self._standing()]
            extra = [Surface(np.concatenate(shapes))] if shapes else []
            self._world = replace(self._bare, surfaces=(*self._bare.surfaces, *extra))
        return self._world

    def _standing(self) -> list[Rectangle]:
        closed = [way for way, is_open in zip(self._ways, self.doors, strict=True) if not is_open]
        return [*closed, *(_around(place) for place in self.boxes if place)]

    def set_door(self, number: int, is_open: bool, robot: Float64s) -> str:
        """Open or close one; a sentence if the robot stands in the doorway."""
        if not 0 <= number < len(self._ways):
            return ""
        if not is_open and _near(self._ways[number], robot):
            return TOO_NEAR
        self.doors = tuple(is_open if k == number else each for k, each in enumerate(self.doors))
        self._world = None
        return ""

    def put_box(self, number: int, place: Place | None, robot: Float64s) -> str:
        """Put one somewhere, None: ahead of the robot (3,) x, y, yaw; a sentence if it would stand in it."""
        if not 0 <= number < BOXES:
            return ""
        x, y, yaw = robot.tolist()
        wanted = place or (x + AHEAD * np.cos(yaw), y + AHEAD * np.sin(yaw))
        found = tuple(np.clip(np.nan_to_num(wanted), -FARTHEST, FARTHEST).tolist())
        if _near(_around(found), robot):
            return TOO_NEAR
        self._place(number, found)
        return ""

    def take_box(self, number: int) -> None:
        """Take one out of the world."""
        self._place(number, None)

    def _place(self, number: int, place: Place | None) -> None:
        self.boxes = tuple(place if k == number else each for k, each in enumerate(self.boxes))
        self._world = None


def _around(place: Place) -> Rectangle:
    x, y = place
    return x - HALF, y - HALF, x + HALF, y + HALF


def _near(area: Rectangle, robot: Float64s) -> bool:
    x, y = float(robot[0]), float(robot[1])
    return area[0] - CLEAR < x < area[2] + CLEAR and area[1] - CLEAR < y < area[3] + CLEAR
