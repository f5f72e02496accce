"""The cost of eq. (7) over a plane of poses, and from which of them the matcher finds its way."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hectorscope.run.xray import Plane
from hectorscope.run.xray.match_problem import MatchProblem, apart
from slam_core.matching.landscape import costs
from slam_core.measurements import Float64s

SIDE = 61  # poses along each axis; odd: the middle is the matched pose
YAW_SPAN = 0.5  # radians to each side, in the plane of x and yaw
STRIDES = (12, 6, 3, 1)  # of the basin: each pass halves the distance between starts
# An end belongs to the matched pose within so many cells of the finest level, and radians.
SAME_CELLS, SAME_YAW = 1.0, 0.02
UNTRIED, FAILED, FOUND = 0, 1, 2


@dataclass(frozen=True)
class Around:
    """A plane of poses around the matched one. span: metres to each side; yaw: radians that it is turned by."""

    plane: Plane
    span: float
    yaw: float = 0.0

    @property
    def step(self) -> tuple[float, float]:
        """From one pose to the next along both axes: metres, and metres or radians."""
        half = SIDE // 2
        return self.span / half, (self.span if self.plane == "xy" else YAW_SPAN) / half

    def poses(self, centre: Float64s) -> Float64s:
        """(SIDE, SIDE, 3): rows along y or yaw, columns along x, both growing."""
        offsets = np.arange(SIDE) - SIDE // 2
        poses = np.empty((SIDE, SIDE, 3))
        poses[:] = centre
        poses[..., 0] += self.step[0] * offsets
        poses[..., 1 if self.plane == "xy" else 2] += self.step[1] * offsets[:, None]
        if self.plane == "xy":
            poses[..., 2] += self.yaw
        return poses


@dataclass(frozen=True, eq=False)
class Landscape:
    """costs: (SIDE, SIDE) of eq. (7) at the poses. lowest: (3,) the pose that costs least."""

    level: int
    around: Around
    costs: Float64s
    lowest: Float64s


def landscape(problem: MatchProblem, level: int, around: Around) -> Landscape:
    """Of one level, with all beams that the run matched."""
    poses = around.poses(problem.matched).reshape(-1, 3)
    found = costs(problem.pyramid.levels[level], problem.points, poses)
    return Landscape(level, around, found.reshape(SIDE, SIDE), poses[np.argmin(found)])


class Basin:
    """Where the matcher ends from each pose of a plane: whether at the matched one. Refined as time allows.

    outcome: (SIDE, SIDE) UNTRIED, FAILED or FOUND.
    """

    def __init__(self, problem: MatchProblem, around: Around) -> None:
        self.outcome: NDArray[np.uint8] = np.zeros((SIDE, SIDE), np.uint8)
        self._problem, self._poses = problem, around.poses(problem.matched)
        self._order: Iterator[tuple[int, int]] = _coarse_to_fine()
        self.tried = 0

    @property
    def whole(self) -> bool:
        """Whether every start was tried."""
        return self.tried == SIDE * SIDE

    def try_next(self) -> None:
        """Match from one more start."""
        row, column = next(self._order)
        end = self._problem.end(self._poses[row, column]).pose
        self.outcome[row, column] = FOUND if is_same(self._problem, end) else FAILED
        self.tried += 1

    def coarse(self) -> NDArray[np.uint8]:
        """(SIDE, SIDE) the outcome, for untried starts that of the nearest tried one before them on the way."""
        filled = self.outcome
        for stride in STRIDES:
            at = np.arange(SIDE) // stride * stride
            filled = np.where(filled == UNTRIED, filled[np.ix_(at, at)], filled)
        return np.where(filled == UNTRIED, self.outcome[np.ix_(at, at)], filled).astype(np.uint8)


def is_same(problem: MatchProblem, end: Float64s) -> bool:
    """Whether a match ended at the matched pose."""
    metres, radians = apart(end, problem.matched)
    return metres <= SAME_CELLS * problem.pyramid.levels[0].resolution and radians <= SAME_YAW


def _coarse_to_fine() -> Iterator[tuple[int, int]]:
    """Every row and column once: those of the coarsest stride first."""
    done = np.zeros((SIDE, SIDE), bool)
    for stride in STRIDES:
        for row in range(0, SIDE, stride):
            for column in range(0, SIDE, stride):
                if not done[row, column]:
                    done[row, column] = True
                    yield row, column
