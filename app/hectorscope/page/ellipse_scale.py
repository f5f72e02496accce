"""How many sigmas large the ellipses are drawn, so that they are well seen in the map."""

import math

import numpy as np

from hectorscope.page.scene import ELLIPSE_SCALE_RANGE
from hectorscope.session.snapshot import Snapshot

STEPS = (1.0, 2.0, 5.0)  # of a decade
SHARE = 0.12  # of the shorter side of the map: the radius of the largest ellipse
SMALLEST, LARGEST = 0.02, 0.2  # shares at which the present number is changed
COLUMNS = [f"{name}_sigma_{axis}" for name in ("match", "prior", "fused") for axis in ("x", "y")]


def fitted(snapshot: Snapshot, now: float) -> float:
    """The number of sigmas: as it is `now` while that suits, else 1, 2 or 5 times a power of ten."""
    radius, side = largest_sigma(snapshot), map_side(snapshot)
    if not (radius > 0.0 and side > 0.0) or SMALLEST <= now * radius / side <= LARGEST:
        return now
    decade = 10.0 ** math.floor(math.log10(SHARE * side / radius))
    step = max(step for step in STEPS if step * decade * radius <= SHARE * side * (1.0 + 1e-9))
    return float(np.clip(step * decade, *ELLIPSE_SCALE_RANGE))


def largest_sigma(snapshot: Snapshot) -> float:
    """Of the covariances of the last scan, metres; 0 if there is none."""
    if not len(snapshot.series):
        return 0.0
    sigmas = [float(snapshot.series[-1][column]) for column in COLUMNS]
    return max((sigma for sigma in sigmas if math.isfinite(sigma)), default=0.0)


def map_side(snapshot: Snapshot) -> float:
    """The shorter side of the known map, metres; 0 before the first update."""
    if not snapshot.maps:
        return 0.0
    image = snapshot.maps[0]
    return float(image.resolution * min(image.cells.shape))
