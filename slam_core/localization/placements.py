"""Where in the map a local map may lie: places that searches found, until the map explains the scans at one alone.

A place that merely looks alike explains some of the scans as well as the true one does. Sooner or later endpoints
lie in what was free space there. What counts is therefore the local map as a whole.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from slam_core import geometry
from slam_core.config import SlamConfig
from slam_core.kernels.correlative import count_hits
from slam_core.kernels.planar import transform_points
from slam_core.localization.place_search import apart
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.matcher import coarse_to_fine
from slam_core.measurements import Float64s
from slam_core.results import Fit
from slam_core.scan.stabilise import StabilisedScan

COMPARED = 60  # scans of a local map, the newest: 12 m of path
POINTS = 40  # of each scan, with which a placement is refined
REFINED = (0.5, 0.3)  # metres, radians by which a match corrects a placement at most
PARTLY = 0.3  # of a scan's endpoints on known cells: with fewer it shows nothing
# A scan agrees if it hits walls nearly as often as usual, and no more endpoints than usual and this share lie in
# free space.
HITS, FREE = 0.8, 0.08
EVIDENCE = 5.0  # scans' worth of known endpoints from which a placement can be judged
LEAST, MOST = 0.5, 0.7  # of these in scans that agree: for a placement to be kept, and to be the one
SPREAD = 2.75  # metres between scans that agree
RIVAL = 2.0  # times the misfit of the best: with less, another placement may be the true one as well
# Times the agreeing scans of the best: with more, it may be, too. With as many times less, and a worse fit, not.
LONGER = 2.0
HELD_NS = 1_000_000_000  # for which a placement has to be the best
TRIED = 12  # placements at most


class KeptScan(NamedTuple):
    """A scan of a local map, its pose (3,) there, and its time."""

    scan: StabilisedScan
    pose: Float64s
    time_ns: int


class Support(NamedTuple):
    """How a map explains the scans of a local map at a placement.

    known: how many scans' worth of endpoints lie on known cells. agreeing: of these, in scans that agree. spread:
    metres between two of these scans at most. misfit: mean share of their known endpoints that hit no wall, plus
    that in free space.
    """

    known: float
    agreeing: float
    spread: float
    misfit: float

    @property
    def contradicts(self) -> bool:
        """Whether the local map does not lie there."""
        return self.known >= EVIDENCE and self.agreeing < LEAST * self.known

    @property
    def suffices(self) -> bool:
        """Whether it may lie there, and enough of it is known."""
        return self.known >= EVIDENCE and self.agreeing >= MOST * self.known

    def rivals(self, best: "Support") -> bool:
        """Whether the local map may lie here as well as at the best placement."""
        if self.known < EVIDENCE or self.contradicts:
            return False
        if LONGER * self.agreeing < best.agreeing and self.misfit > best.misfit:
            return False
        return self.misfit < RIVAL * best.misfit or self.agreeing > LONGER * best.agreeing


NOTHING = Support(0.0, 0.0, 0.0, 1.0)


@dataclass(slots=True, eq=False)
class Placement:
    """moved: (3,) the pose of the local map in the map."""

    moved: Float64s
    support: Support = NOTHING


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

    def judge(self, pyramid: Pyramid, scans: Sequence[KeptScan], usual: float, config: SlamConfig) -> bool:
        """Look at one placement, and give it up if the scans contradict it. Whether it was the last one in turn.

        usual: the mean inlier ratio of the scans in the map.
        """
        if not self._tried:
            return True
        placement = self._tried[self._next]
        placement.moved = refined(pyramid, scans, placement.moved, config)
        placement.support = support(pyramid, scans, placement.moved, usual)
        if placement.support.contradicts:
            del self._tried[self._next]
        else:
            self._next += 1
        ended = self._next >= len(self._tried)
        self._next = 0 if ended else self._next
        return ended

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
            fits = each.support.known > 0.0 and each.support.agreeing >= MOST * each.support.known
            if fits and not geometry.apart(geometry.compose(each.moved, here), place, distance, angle):
                return each
        return None


def refined(pyramid: Pyramid, scans: Sequence[KeptScan], moved: Float64s, config: SlamConfig) -> Float64s:
    """A placement (3,) after a match of endpoints of all scans that are compared; as it was if too few are known.

    A match of next to nothing goes anywhere.
    """
    compared = list(scans)[-COMPARED:]
    here = compared[-1].pose
    back = geometry.inverse(here)
    parts = [
        transform_points(geometry.compose(back, pose), scan.points[:: max(1, len(scan.points) // POINTS)])
        for scan, pose, _ in compared
    ]
    points = np.concatenate(parts).astype(np.float32)
    # Their beams have no origin in common, so walls have no side from which they were seen.
    matcher = replace(config.matcher, back_face_share=1.0, surfel_weight=0.0)
    there = geometry.compose(moved, here)
    match = coarse_to_fine(pyramid, points, there, matcher)
    return moved if geometry.apart(match.pose, there, *REFINED) else geometry.compose(match.pose, back)


def support(pyramid: Pyramid, scans: Sequence[KeptScan], moved: Float64s, usual: float) -> Support:
    """How a map explains the scans at a placement (3,). usual: the mean inlier ratio of the scans in the map."""
    known = misfit = 0.0
    agreeing, poses = 0.0, []
    for scan, pose, _ in list(scans)[-COMPARED:]:
        fit, free = looked_at(pyramid, scan, geometry.compose(moved, pose))
        if fit.known < PARTLY:
            continue
        known += fit.known
        misfit += fit.known * (1.0 - fit.hit + free)
        if agrees(fit, free, usual):
            agreeing += fit.known
            poses.append(pose)
    spread = max((math.hypot(*(pose - poses[0])[:2]) for pose in poses), default=0.0)
    return Support(known, agreeing, spread, misfit / known if known else 1.0)


def looked_at(pyramid: Pyramid, scan: StabilisedScan, pose: Float64s) -> tuple[Fit, float]:
    """How a scan at a pose (3,) fits the map, and the share of its known endpoints that lie in free space."""
    pyramid.cover(scan.points, pose)
    level, n = pyramid.levels[-1], len(scan.points)
    known, hits = count_hits(level.cells, level.corner, 1.0 / level.resolution, scan.points, pose)
    fit = Fit.counted(n, known, hits)
    return fit, float(pyramid.unexpected(scan.points, pose).sum()) / max(known, 1)


def agrees(fit: Fit, free: float, usual: float) -> bool:
    """Whether a scan may have been made there. free: the share of its known endpoints in free space."""
    return fit.hit >= HITS * usual and free <= 1.0 - usual + FREE
