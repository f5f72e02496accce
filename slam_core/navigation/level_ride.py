"""A base that stays level while nothing measures its height: it may drive on a plane."""

import math
from collections.abc import Iterable

from slam_core import geometry
from slam_core.navigation.filter import NavigationFilter
from slam_core.results import AidingStatus

LONG_NS = 20_000_000_000  # of a level ride
EVERY_NS = 1_000_000_000
LEVEL = 0.1  # rad of tilt: a floor, and the error of the tilt
UNSURE = 0.5  # m, of the height's standard deviation
HEIGHT = 5  # the error of the height


class LevelRide:
    """Looks at the filter once a second."""

    def __init__(self) -> None:
        self._since_ns: int | None = None
        self._looked_ns = 0
        self._unknown = False

    def unknown_height(self, estimator: NavigationFilter, aiding: Iterable[AidingStatus], time_ns: int) -> bool:
        """Whether the base stayed level for long, and its height is uncertain as nothing measures it."""
        if estimator.ready and abs(time_ns - self._looked_ns) >= EVERY_NS:
            self._looked_ns, self._unknown = time_ns, self._look(estimator, aiding, time_ns)
        return self._unknown

    def _look(self, estimator: NavigationFilter, aiding: Iterable[AidingStatus], time_ns: int) -> bool:
        state = estimator.at(time_ns)
        up = float(geometry.rotation_matrix(state.T_map_base.rotation)[2, 2])
        measured = any(each.used and (HEIGHT in each.measures or each.source == "ground") for each in aiding)
        if self._since_ns is None or up < math.cos(LEVEL) or measured or time_ns < self._since_ns:
            self._since_ns = time_ns
        sigma = math.sqrt(float(state.covariance[HEIGHT, HEIGHT]))
        return sigma > UNSURE and time_ns - self._since_ns >= LONG_NS
