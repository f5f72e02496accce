"""Which beam of a sweep an endpoint is, and the other way round.

The kernel that places the beams keeps no list of those that it leaves out. It treats each beam by itself and keeps
their order, so a beam's endpoint is the one behind as many as the beams before it leave. They are counted by the
same kernel, with the later ranges taken away: nothing is slower for scans at which nobody looks.
"""

from bisect import bisect_right
from dataclasses import replace

import numpy as np

from slam_core.results import Sweep
from slam_core.scan.stabilise import stabilise


def endpoint_of(sweep: Sweep, beam: int) -> int | None:
    """The index of a beam's endpoint among the points of its scan; None if the beam has none."""
    before = _endpoints_before(sweep, beam)
    return before if _endpoints_before(sweep, beam + 1) > before else None


def beam_of(sweep: Sweep, endpoint: int) -> int:
    """The index of the beam that an endpoint of the scan belongs to."""
    counts = range(1, len(sweep.scan.ranges) + 1)
    return bisect_right(counts, endpoint, key=lambda beams: _endpoints_before(sweep, beams))


def _endpoints_before(sweep: Sweep, beam: int) -> int:
    """How many endpoints the beams before one leave."""
    ranges = sweep.scan.ranges.copy()
    ranges[beam:] = np.nan
    return len(stabilise(replace(sweep.scan, ranges=ranges), lambda *_: sweep.poses, sweep.config).points)
