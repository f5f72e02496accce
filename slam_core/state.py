"""The parts of a `HectorSlam`, and what can be asked of it and set between two measurements."""

from collections import Counter
from collections.abc import Callable, Sequence

import numpy as np

from slam_core.config import ConfigError, SlamConfig, needs_restart
from slam_core.diagnostics import NOT_LOCALISED, Diagnostic
from slam_core.localization.localiser import Localiser
from slam_core.localization.locator import Locator
from slam_core.localization.prior_map import PriorMap
from slam_core.localization.start_in_motion import StartInMotion
from slam_core.mapping.mapper import Mapper
from slam_core.mapping.pyramid import Pyramid
from slam_core.measurements import Float64s
from slam_core.navigation.ego_motion import EgoMotion
from slam_core.results import PlanarGaussian, PoseRecord, Poses, Status
from slam_core.scan.repeats import Repeats
from slam_core.scan.smoothing import Smoothing
from slam_core.scan.stabilise import stabilise
from slam_core.sequencer import Sequencer
from slam_core.timing import Stopwatch


class SlamState:
    """Map, motion, localisation, and the poses so far.

    prior_map: the map to begin with; without one, the map begins at the first scan. clock: nanoseconds, for the
    durations in the results; without one they are 0.
    """

    def __init__(
        self,
        config: SlamConfig | None = None,
        prior_map: PriorMap | None = None,
        clock: Callable[[], int] = lambda: 0,
    ) -> None:
        self.config = config or SlamConfig()
        self._skipped: Counter[str] = Counter()
        self._sequencer = Sequencer()
        self._motion = EgoMotion(self.config)
        writes, start = (prior_map.write, prior_map.start) if prior_map else (True, np.zeros(3))
        pyramid = prior_map.pyramid(self.config.map) if prior_map else Pyramid(self.config.map)
        localiser = Localiser(pyramid, self._motion, start, is_prior=prior_map is not None, writes=writes)
        self._start = None if prior_map else StartInMotion(self._motion)
        self._scans, self._scan_ns = 0, 0
        self._record = PoseRecord()
        self._repeats = Repeats()
        self._smoothing = Smoothing()
        self._stopwatch = Stopwatch(clock)
        # The stages of figure 1, with their durations.
        timed = self._stopwatch.timed
        self._take, self._stabilise = timed("filter", self._motion.take), timed("stabilise", stabilise)
        self._smooth = timed("stabilise", self._smoothing.take)
        self._predict, self._fuse = timed("filter", self._motion.prior), timed("filter", self._motion.correct)
        self._use(pyramid, localiser, Mapper(pyramid, writes=writes))

    def _use(self, pyramid: Pyramid, localiser: Localiser, mapper: Mapper) -> None:
        """The map, and what locates scans in it and writes them."""
        self.map, self._mapper = pyramid, mapper
        self._locator = Locator(pyramid, self._motion, localiser, mapper)
        timed = self._stopwatch.timed
        self._locate, self._update = timed("match", self._locator.locate), timed("update", mapper.update)

    def configure(self, config: SlamConfig) -> None:
        """Change settings from the next measurement on; ConfigError if the map would have to be rebuilt."""
        if needs_restart(self.config, config):
            raise ConfigError("this change needs a new map: restart the run with it")
        # An equal one, as behind a checkpoint, would settle every estimate of the filter.
        if config != self.config:
            self._motion.configure(config)
        self.config = config

    def start_estimate(self, prior: PlanarGaussian, config: SlamConfig) -> Float64s:
        """(3,) where the match of the next scan begins, by the prediction at its time and the settings then."""
        return self._locator.localiser.start_estimate(prior, config)

    def reset_pose(self, pose: PlanarGaussian) -> bool:
        """Continue at a pose in the map, with its covariance, as from the last scan on.

        Whether that was possible: a scan has to have been looked for in a map.
        """
        possible = self._scans > 0 or self._skipped[NOT_LOCALISED] > 0
        if possible:
            self._locator.reset(self._scan_ns, pose)
        return possible

    @property
    def matched_map(self) -> Pyramid:
        """What the next scan is matched with: the map, or a local one while the pose in the map is unknown."""
        return self._locator.pyramid

    @property
    def trajectory(self) -> Poses:
        """The pose of every scan given to `add` so far, at the middle of its sweep."""
        return self._record.poses

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """What is wrong at the time of the last scan."""
        limit = self.map.stopped_at
        full = (Diagnostic("map_limit", value=limit),) if limit else ()
        return full + self._sequencer.diagnostics(self._scan_ns) + self._motion.diagnostics(self._scan_ns)

    @property
    def status(self) -> Status:
        """Whether the pose in the map is known, and what was not used so far."""
        relocaliser = self._locator.relocaliser
        moved = self._start is not None and self._start.is_over
        return Status(relocaliser.failure, relocaliser.found, moved, self._skipped, self._motion.unused)

    @property
    def now_ns(self) -> int | None:
        """Time of the latest measurement that the motion is known at; None before the first scan."""
        return self._motion.latest_ns(self._scan_ns) if self._scans else None

    def motion_at(self, times_ns: Sequence[int]) -> Float64s:
        """(k, 10) position, attitude, velocity in the map at k times, predicted where they are later."""
        return self._motion.motion_at(times_ns)
