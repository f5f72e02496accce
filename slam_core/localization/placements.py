"""Where in the map a local map may lie: places that searches found, until the map explains the scans at one alone.

A place that merely looks alike explains some of the scans as well as the true one does. Sooner or later endpoints
lie in what was free space there, and beams cross walls. What counts is therefore the local map as a whole.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from slam_core import geometry
from slam_core.config import SlamConfig
from slam_core.kernels.back_faces import find_behind
from slam_core.kernels.planar import transform_points
from slam_core.kernels.structures import Level
from slam_core.localization.map_view import PARTLY, agrees, crossings, looked_at
from slam_core.localization.place_search import apart
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.matcher import beams_of, coarse_to_fine
from slam_core.measurements import Float64s
from slam_core.scan.stabilise import StabilisedScan

COMPARED = 60  # scans of a local map, the newest: 12 m of path
POINTS = 40  # of each scan, with which a placement is refined
REFINED = (0.5, 0.3)  # metres, radians by which a match corrects a placement at most
EVIDENCE = 5.0  # scans' worth of known endpoints from which a placement can be judged
LEAST, MOST = 0.5, 0.7  # of these in scans that agree: for a placement to be kept, and to be the one
SPREAD = 2.75  # metres between scans that agree
# Beams may cross walls, and end on none, so many times as often as usual, and this share of them besides. With
# more, a placement is not the one; with far more, it is given up.
OFTEN, CROSSING, UNLIKELY = 1.5, 0.04, 0.15
MISSES = 0.05  # of the known endpoints: what misses walls beyond that in usual scans is noise, which all share
RIVAL = 2.0  # times the misfit of the best: with less, another placement may be the true one as well
HELD_NS = 1_000_000_000  # for which a placement has to be the best
TRIED = 12  # placements at most


class KeptScan(NamedTuple):
    """A scan of a local map, its pose (3,) there, and its time."""

    scan: StabilisedScan
    pose: Float64s
    time_ns: int


class Usual(NamedTuple):
    """Of scans whose place is sure: mean shares of endpoints that hit, and of beams that cross walls."""

    hit: float
    crossing: float


class Support(NamedTuple):
    """How a map explains the scans of a local map at a placement.

    known: how many scans' worth of endpoints lie on known cells. agreeing: of these, in scans that agree. spread:
    metres between two of these scans at most. misfit: mean share of their known endpoints that hit no wall, plus
    that in free space, less what is noise. crossing: share of beams that cross walls, less what is usual; 0 with
    too little evidence.
    """

    known: float
    agreeing: float
    spread: float
    misfit: float
    crossing: float

    @property
    def contradicts(self) -> bool:
        """Whether the local map does not lie there."""
        return self.known >= EVIDENCE and (self.agreeing < LEAST * self.known or self.crossing > UNLIKELY)

    @property
    def suffices(self) -> bool:
        """Whether it may lie there, and enough of it is known."""
        return self.known >= EVIDENCE and self.agrees and self.crossing <= CROSSING

    @property
    def agrees(self) -> bool:
        """Whether most of what is known there agrees."""
        return self.agreeing >= MOST * self.known > 0.0

    def rivals(self, best: "Support") -> bool:
        """Whether the local map may lie here as well as at the best placement."""
        return self.known >= EVIDENCE and not self.contradicts and self.misfit < RIVAL * best.misfit


NOTHING = Support(0.0, 0.0, 0.0, 1.0, 0.0)


@dataclass(slots=True, eq=False)
class Placement:
    """moved: (3,) the pose of the local map in the map. compared_ns: the newest scan that it was compared with."""

    moved: Float64s
    support: Support = NOTHING
    compared_ns: int = 0


class Placements:
    """The placements of one local map."""

    def __init__(self) -> None:
        self._tried: list[Placement] = []
        self._next = 0
        self._best: Placement | None = None
        self._best_ns = 0

    def __len__(self) -> int:
        return len(self._tried)

    def add(self, places: Iterable[Float64s], here: Float64s) -> None:
        """Places (3,) of the map where the robot may be, which is `here` (3,) in the local map."""
        for place in places:
            known = (geometry.compose(other.moved, here) for other in self._tried)
            if len(self._tried) < TRIED and all(apart(place, other) for other in known):
                self._tried.append(Placement(geometry.compose(place, geometry.inverse(here))))

    def judge(self, pyramid: Pyramid, scans: Sequence[KeptScan], usual: Usual, config: SlamConfig) -> bool:
        """Look at the next placement that was not compared with the newest scan. It may be given up then.

        False if there was none any more: each had its turn, and the first is the next.
        """
        newest_ns = scans[-1].time_ns if scans else 0
        while self._next < len(self._tried) and self._tried[self._next].compared_ns == newest_ns:
            self._next += 1
        if self._next >= len(self._tried):
            self._next = 0
            return False
        placement = self._tried[self._next]
        placement.compared_ns = newest_ns
        placement.moved = refined(pyramid, scans, placement.moved, config)
        placement.support = support(pyramid, scans, placement.moved, usual)
        if placement.support.contradicts:
            del self._tried[self._next]
        else:
            self._next += 1
        return True

    def best(self, here: Float64s, time_ns: int) -> Placement | None:
        """The one that has explained the scans for a while, and no other nearly as well; None without.

        To be asked each time that all were judged. here: (3,) where the robot is in the local map.
        """
        best = self._unrivalled(here)
        if best is None or best is not self._best:
            self._best, self._best_ns = best, time_ns
        return best if best and time_ns - self._best_ns >= HELD_NS else None

    def _unrivalled(self, here: Float64s) -> Placement | None:
        sufficient = [each for each in self._tried if each.support.suffices]
        if not sufficient:
            return None
        best = min(sufficient, key=lambda each: each.support.misfit)
        there = geometry.compose(best.moved, here)
        for each in self._tried:
            if each.support.rivals(best.support) and apart(geometry.compose(each.moved, here), there):
                return None
        return best if best.support.spread >= SPREAD else None

    @property
    def any_supported(self) -> bool:
        """Whether the scans agree with the map at one of them."""
        return any(each.support.known >= EVIDENCE for each in self._tried)

    def at(self, place: Float64s, here: Float64s, distance: float, angle: float) -> Placement | None:
        """The one that explains the scans and has the robot near a place (3,), in metres and radians."""
        for each in self._tried:
            there = geometry.compose(each.moved, here)
            if each.support.agrees and not geometry.apart(there, place, distance, angle):
                return each
        return None


def refined(pyramid: Pyramid, scans: Sequence[KeptScan], moved: Float64s, config: SlamConfig) -> Float64s:
    """A placement (3,) after a match of endpoints of all scans that are compared; as it was if too few are known.

    A match of next to nothing goes anywhere. Endpoints that come to lie on walls seen from behind are left out:
    the side that they belong to lies the thickness of the wall further on.
    """
    compared = list(scans)[-COMPARED:]
    here = compared[-1].pose
    there, back = geometry.compose(moved, here), geometry.inverse(here)
    ends = [scan.points[:: max(1, len(scan.points) // POINTS)] for scan, _, _ in compared]
    poses = np.array([geometry.compose(back, pose) for _, pose, _ in compared])
    points = np.concatenate([transform_points(*each) for each in zip(poses, ends, strict=True)]).astype(np.float32)
    beams, first = beams_of(np.concatenate(ends)), np.cumsum([0, *map(len, ends)])

    def in_front(place: Float64s) -> NDArray[np.bool_]:
        pyramid.cover(points, place)
        level, behind = pyramid.levels[0], np.empty(len(points), np.bool_)
        walls = Level(level.surfels, level.corner, 1.0 / level.resolution)
        find_behind(walls, beams, first, poses, place, behind)
        return ~behind

    # They have no origin in common, so that the match itself cannot tell from which side a wall is seen.
    matcher = replace(config.matcher, back_face_share=1.0, surfel_weight=0.0)
    kept = in_front(there)
    while True:
        place = coarse_to_fine(pyramid, points[kept], there, matcher).pose
        if geometry.apart(place, there, *REFINED):
            return moved
        fewer = kept & in_front(place)
        if fewer.sum() == kept.sum():
            return geometry.compose(place, back)
        kept = fewer


def support(pyramid: Pyramid, scans: Sequence[KeptScan], moved: Float64s, usual: Usual) -> Support:
    """How a map explains the scans at a placement (3,)."""
    known = misfit = 0.0
    agreeing, poses = 0.0, []
    compared = [(scan, pose, geometry.compose(moved, pose)) for scan, pose, _ in list(scans)[-COMPARED:]]
    for scan, pose, there in compared:
        fit, free = looked_at(pyramid, scan, there)
        if fit.known < PARTLY:
            continue
        known += fit.known
        misfit += fit.known * (1.0 - fit.hit + free)
        if agrees(fit, free, usual.hit):
            agreeing += fit.known
            poses.append(pose)
    spread = max((math.hypot(*(pose - poses[0])[:2]) for pose in poses), default=0.0)
    share = 0.0
    if known >= EVIDENCE:
        beams, crossing = np.sum([crossings(pyramid, scan, there) for scan, _, there in compared], axis=0)
        share = float(crossing / max(beams, 1)) - OFTEN * usual.crossing
    noise = max(0.0, 1.0 - usual.hit - MISSES)
    return Support(known, agreeing, spread, max(0.0, misfit / known - noise) if known else 1.0, share)
