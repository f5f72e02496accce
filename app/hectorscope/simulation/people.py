"""People as a laser sees them: upright columns that walk, stop and go on."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from slam_core.measurements import Float64s

Way = Callable[[Float64s], Float64s]
"""(m,) seconds -> (m, 2) where somebody is in the map, metres."""


@dataclass(frozen=True, slots=True, eq=False)
class Person:
    """A column of `radius` metres, as high and as deep as any beam goes."""

    way: Way
    radius: float

    def begun(self, seconds: float) -> "Person":
        """The same person from so many seconds on."""

        def way(t: Float64s) -> Float64s:
            return self.way(t + seconds)

        return Person(way, self.radius)


@dataclass(frozen=True, slots=True)
class Gait:
    """How people walk: m/s, metres of radius, and how long they stand when they stop, seconds."""

    speed: tuple[float, float] = (0.5, 1.5)
    radius: tuple[float, float] = (0.13, 0.25)
    rest: tuple[float, float] = (10.0, 20.0)
    stops: float = 0.4  # share of the crossings with a stop on the way


def stroll(lane: Float64s, duration: float, gait: Gait, rng: np.random.Generator) -> Person:
    """Somebody who walks to and fro on a polyline (k, 2), from any place on it, and stops now and then."""
    station = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(lane, axis=0), axis=1))))
    speed = rng.uniform(*gait.speed)
    times, places = [0.0], [rng.uniform(0.0, station[-1])]
    goal = float(rng.choice([0.0, station[-1]]))
    while times[-1] < duration:
        legs = [places[-1], goal]
        if rng.random() < gait.stops:
            legs.insert(1, rng.uniform(*sorted(legs)))
        for here, there in pairwise(legs):
            times.append(times[-1] + abs(there - here) / speed)
            places.append(there)
            if there != goal:
                times.append(times[-1] + rng.uniform(*gait.rest))
                places.append(there)
        goal = station[-1] - goal

    def way(t: Float64s) -> Float64s:
        along = np.interp(t, times, places)
        return np.column_stack([np.interp(along, station, axis) for axis in lane.T])

    return Person(way, rng.uniform(*gait.radius))


def distances(people: Sequence[Person], origins: Float64s, directions: Float64s, t: Float64s) -> Float64s:
    """(n,) metres along unit rays (n, 3), each at its own (n,) second, to the nearest person; inf to nobody."""
    nearest = np.full(len(t), np.inf)
    flat = np.hypot(directions[:, 0], directions[:, 1])
    for person in people:
        ahead = person.way(t) - origins[:, :2]
        with np.errstate(divide="ignore", invalid="ignore"):
            along = np.einsum("ij,ij->i", ahead, directions[:, :2]) / flat
            inside = person.radius**2 - (np.einsum("ij,ij->i", ahead, ahead) - along**2)
            reached = (along - np.sqrt(inside)) / flat
        met = (inside > 0.0) & (reached > 0.0)
        nearest[met] = np.minimum(nearest, reached)[met]
    return nearest
