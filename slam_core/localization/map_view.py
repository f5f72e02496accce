"""How a map explains a scan at a pose: endpoints on walls, in free space, and beams that cross walls."""

from slam_core.kernels.correlative import count_hits
from slam_core.kernels.crossings import count_crossing
from slam_core.mapping.pyramid import Pyramid
from slam_core.measurements import Float64s
from slam_core.results import Fit
from slam_core.scan.stabilise import StabilisedScan

PARTLY = 0.3  # of a scan's endpoints on known cells: with fewer it shows nothing
# A scan agrees if it hits walls nearly as often as usual, and no more endpoints than usual and this share lie in
# free space.
HITS, FREE = 0.8, 0.08
BEAMS = 20  # of each scan that are followed
SLACK = 0.4  # metres before its end in which a beam may touch walls: those that it ends on


def crossings(pyramid: Pyramid, scan: StabilisedScan, pose: Float64s, beams: int = BEAMS) -> tuple[int, int]:
    """How many of some beams of a scan at a pose (3,) the map knows something of, and how many cross walls."""
    pyramid.cover(scan.points, pose)
    level, every = pyramid.levels[0], max(1, len(scan.points) // beams)
    inverse = 1.0 / level.resolution
    slack = SLACK * inverse
    counts: tuple[int, int] = count_crossing(
        level.cells, level.corner, inverse, scan.points, scan.laser, pose, slack, every
    )
    return counts


def looked_at(pyramid: Pyramid, scan: StabilisedScan, pose: Float64s) -> tuple[Fit, float]:
    """How a scan at a pose (3,) fits the map, and the share of its known endpoints that lie in free space."""
    pyramid.cover(scan.points, pose)
    level, n = pyramid.levels[-1], len(scan.points)
    known, hits = count_hits(level.cells, level.corner, 1.0 / level.resolution, scan.points, pose)
    fit = Fit.counted(n, known, hits)
    return fit, float(pyramid.unexpected(scan.points, pose).sum()) / max(known, 1)


def agrees(fit: Fit, free: float, usual: float) -> bool:
    """Whether a scan may have been made there. free: the share of its known endpoints in free space.

    usual: the mean inlier ratio of the scans in the map.
    """
    return fit.hit >= HITS * usual and free <= 1.0 - usual + FREE
