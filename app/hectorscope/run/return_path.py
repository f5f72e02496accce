"""The way back to the start: a shortest path over free cells that keeps away from walls (A*)."""

import heapq
import math

import numpy as np
from numpy.typing import NDArray

from hectorscope.run.map_image import FREE, OCCUPIED, MapImage

CELL = 0.1  # m: the map is looked at in cells of at least this length
CLEARANCE = 0.25  # m from a wall that the middle of the robot keeps
COMFORT = 0.5  # m from a wall within which a way costs more
NEAR_WALL = 3.0  # times as much
STEPS = tuple((dr, dc, math.hypot(dr, dc)) for dr in (-1, 0, 1) for dc in (-1, 0, 1) if dr or dc)

Cells = NDArray[np.bool_]
Cell = tuple[int, int]


def return_path(level: MapImage, trajectory: NDArray[np.float64]) -> NDArray[np.float64]:
    """(n, 2) from the last position of a trajectory (m, 8) to its first, over free cells or where it went itself.

    The trajectory itself, backwards, where there is no such way.
    """
    driven = trajectory[::-1, 1:3]
    times = max(1, round(CELL / level.resolution))
    size, origin = level.resolution * times, np.array([level.y, level.x])
    wall, free = (_coarser(level.cells == kind, times) for kind in (OCCUPIED, FREE))
    cost = np.where(free & ~_grown(wall, CLEARANCE / size), 1.0, np.inf)
    cost[np.isfinite(cost) & _grown(wall, COMFORT / size)] = NEAR_WALL
    passed = np.floor((driven[:, ::-1] - origin) / size).astype(int)
    inside = ((passed >= 0) & (passed < cost.shape)).all(axis=1)
    rows, columns = passed[inside].T
    cost[rows, columns] = np.minimum(cost[rows, columns], NEAR_WALL)  # the robot was there
    if not (inside[0] and inside[-1]):
        return driven
    way = _search(cost, (int(passed[0, 0]), int(passed[0, 1])), (int(passed[-1, 0]), int(passed[-1, 1])))
    if way is None:
        return driven
    middle = (np.array(way) + 0.5) * size + origin
    return np.concatenate([driven[:1], middle[1:-1, ::-1], driven[-1:]])


def _search(cost: NDArray[np.float64], start: Cell, goal: Cell) -> list[Cell] | None:
    """The cheapest way between two cells; None without any."""
    best, came = {start: 0.0}, {start: start}
    waiting = [(0.0, start)]
    done: set[Cell] = set()
    while waiting:
        _, here = heapq.heappop(waiting)
        if here == goal:
            return _traced(came, goal)
        if here in done:
            continue
        done.add(here)
        for down, right, length in STEPS:
            there = here[0] + down, here[1] + right
            if not (0 <= there[0] < cost.shape[0] and 0 <= there[1] < cost.shape[1]):
                continue
            spent = best[here] + length * float(cost[there])
            if spent < best.get(there, math.inf):
                best[there], came[there] = spent, here
                heapq.heappush(waiting, (spent + math.dist(there, goal), there))
    return None


def _traced(came: dict[Cell, Cell], goal: Cell) -> list[Cell]:
    way = [goal]
    while came[way[-1]] != way[-1]:
        way.append(came[way[-1]])
    return way[::-1]


def _coarser(cells: Cells, times: int) -> Cells:
    """Cells so many times as long: those in which one is set."""
    rows, columns = (-(-length // times) for length in cells.shape)
    padded = np.zeros((rows * times, columns * times), bool)
    padded[: cells.shape[0], : cells.shape[1]] = cells
    return np.asarray(padded.reshape(rows, times, columns, times).any(axis=(1, 3)), bool)


def _grown(cells: Cells, radius: float) -> Cells:
    """Every cell whose middle is nearer than so many cells to the middle of one that is set."""
    reach = int(radius)
    padded, (rows, columns) = np.pad(cells, reach), cells.shape
    grown = cells.copy()
    for down in range(-reach, reach + 1):
        for right in range(-reach, reach + 1):
            if math.hypot(down, right) <= radius:
                moved = padded[reach + down : reach + down + rows, reach + right : reach + right + columns]
                np.logical_or(grown, moved, out=grown)
    return grown
