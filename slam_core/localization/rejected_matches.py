"""What rejected matches show where the pose is not sure: the robot left its map, or its prediction is wrong."""

from slam_core.config import TrackingConfig
from slam_core.localization.tracking import MOSTLY
from slam_core.results import Fit

CONTRADICTS = 0.5  # of the usual inlier ratio: a scan on known cells that hits less was not made there


class RejectedMatches:
    """Those since the robot was sure of its pose. count: the first ones, up to `tracking.lost_after`."""

    def __init__(self) -> None:
        self.count, self._known = 0, 0.0
        self._certain = self._contradicting = 0

    def add(self, fit: Fit, usual: float, config: TrackingConfig, *, is_vague: bool) -> None:
        """One more. usual: the mean inlier ratio of accepted ones. is_vague: it was not known where to match."""
        if self.count < config.lost_after:
            self.count += 1
            self._known += fit.known
        if not is_vague:
            self._certain += 1
            self._contradicting += fit.known >= config.min_overlap and fit.hit < CONTRADICTS * usual

    @property
    def contradict(self) -> bool:
        """Whether most of those at a certain prediction fit so badly that this is wrong: the robot was carried."""
        return 2 * self._contradicting > self._certain

    @property
    def outside_map(self) -> bool:
        """Whether the first of them lie mostly on unknown cells, and the prediction is not known to be wrong.

        The first, as a wrong prediction leaves the map sooner or later.
        """
        return self.count > 0 and self._known < MOSTLY * self.count and not self.contradict
