"""What rejected matches show where the pose is not sure: the robot left its map, or its prediction is wrong."""

from slam_core.config import TrackingConfig
from slam_core.localization.tracking import MOSTLY
from slam_core.results import Fit

CONTRADICTS = 0.5  # of the usual inlier ratio: a scan on known cells that hits less was not made there


class RejectedMatches:
    """Those since the robot was sure of its pose."""

    def __init__(self) -> None:
        self._count = self._contradicting = 0
        self._first, self._known = 0, 0.0

    def add(self, fit: Fit, usual: float, config: TrackingConfig, *, is_vague: bool) -> None:
        """One more. usual: the mean inlier ratio of accepted ones. is_vague: it was not known where to match."""
        self._count += 1
        if self._count <= config.lost_after:
            self._first += 1
            self._known += fit.known
        on_map = fit.known >= config.min_overlap
        self._contradicting += on_map and not is_vague and fit.hit < CONTRADICTS * usual

    @property
    def contradict(self) -> bool:
        """Whether most of them fit so badly at a certain prediction that this is wrong: the robot was carried."""
        return 2 * self._contradicting > self._count

    @property
    def outside_map(self) -> bool:
        """Whether the first of them lie mostly on unknown cells, and the prediction is not known to be wrong.

        The first, as a wrong prediction leaves the map sooner or later.
        """
        return self._count > 0 and self._known < MOSTLY * self._first and not self.contradict
