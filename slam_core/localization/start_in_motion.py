"""A start in motion: matches in maps of their own, until they have shown the filter its attitude and velocity.

A base at rest is levelled by its accelerometers. In motion these measure its acceleration, too, so that what is
mapped first is askew. It is given up, and mapped anew with what was learned of the motion.
"""

import numpy as np

from slam_core.config import SlamConfig
from slam_core.localization.localiser import Localiser
from slam_core.mapping.mapper import Mapper
from slam_core.mapping.pyramid import Pyramid
from slam_core.measurements import LaserScan
from slam_core.navigation.ego_motion import EgoMotion
from slam_core.scan.stabilise import StabilisedScan

FIRST_NS, STAGE_NS, LONGEST_NS = 1_000_000_000, 2_000_000_000, 6_000_000_000
FEWEST = 4  # scans of a stage


class StartInMotion:
    """One for each run. Of a base in motion: a short stage, and others until each scan of one fits its map."""

    def __init__(self, motion: EgoMotion) -> None:
        self._motion = motion
        self._begin_ns: int | None = None
        self._stages = 0
        self._fits = False

    def takes(self, scan: LaserScan, stabilised: StabilisedScan, config: SlamConfig) -> bool:
        """Whether a scan is used for the motion alone, as the map cannot begin yet."""
        if not self._motion.begins_in_motion:
            return False
        time_ns = scan.mid_ns
        self._begin_ns = self._begin_ns or time_ns
        ends = not self._stages or self._is_long(time_ns)
        settled = ends and self._stages > 1 and self._fits
        if settled or time_ns - self._begin_ns > LONGEST_NS:
            self._motion.begin_at_origin(time_ns, has_velocity=True)
            self._motion.begins_in_motion = False
            return False
        if ends:
            self._begin_stage(time_ns, config)
        self._match(scan, stabilised, config)
        return True

    def _is_long(self, time_ns: int) -> bool:
        """Whether the stage may end."""
        span_ns = FIRST_NS if self._stages == 1 else STAGE_NS
        return self._scans >= FEWEST and time_ns - self._stage_ns >= span_ns

    def _begin_stage(self, time_ns: int, config: SlamConfig) -> None:
        """An empty map, with its origin where the base is."""
        pyramid = Pyramid(config.map)
        self._localiser = Localiser(pyramid, self._motion, np.zeros(3), is_prior=False, writes=True)
        self._mapper = Mapper(pyramid, writes=True)
        self._motion.begin_at_origin(time_ns, has_velocity=self._fits)
        self._stage_ns, self._scans, self._fits = time_ns, 0, True
        self._stages += 1

    def _match(self, scan: LaserScan, stabilised: StabilisedScan, config: SlamConfig) -> None:
        """Sections IV-B, IV-C and V-B."""
        motion, time_ns = self._motion, scan.mid_ns
        prior = motion.prior(time_ns)
        placed, pose, match, verdict = self._localiser.locate(scan, stabilised, prior, config)
        self._mapper.update(placed, pose, match, verdict, time_ns, config.map, unaided=motion.unaided)
        fused, _ = motion.correct(time_ns, match, accepted=verdict.accepted)
        self._localiser.fused = fused.mean
        self._fits = self._fits and verdict.state == "tracking"
        self._scans += 1
