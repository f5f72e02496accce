"""A start in motion: matches in maps of their own, until they have shown the filter its attitude and velocity.

A base at rest is levelled by its accelerometers. In motion these measure its acceleration, too, so that what is
mapped first is askew. It is given up, and mapped anew with what was learned of the motion.
"""

import numpy as np

from slam_core import geometry
from slam_core.config import SlamConfig
from slam_core.localization.localiser import Localiser
from slam_core.mapping.mapper import Mapper
from slam_core.mapping.pyramid import Pyramid
from slam_core.measurements import LaserScan
from slam_core.navigation.ego_motion import EgoMotion
from slam_core.scan.stabilise import StabilisedScan

FIRST_NS, STAGE_NS, LONGEST_NS = 1_000_000_000, 2_000_000_000, 8_000_000_000
FEWEST = 4  # scans of a stage
LEVEL = 0.05  # rad, nearly: so much the vertical turns in the axes of a base that drives on a floor
VERTICAL = np.array([[0.0, 0.0, 1.0]])


class StartInMotion:
    """One for each run. Of a base in motion: a short stage, and others until each scan of one fits its map.

    One that tilts needs a stage more: its acceleration and its tilt are told apart later.
    is_over: whether there was one, and the map has begun.
    """

    def __init__(self, motion: EgoMotion) -> None:
        self.is_over = False
        self._motion = motion
        self._begin_ns = 0
        self._stages = 0
        self._stage: _Stage | None = None

    def takes(self, scan: LaserScan, stabilised: StabilisedScan, config: SlamConfig) -> bool:
        """Whether a scan is used for the motion alone, as the map cannot begin yet."""
        motion, stage, time_ns = self._motion, self._stage, scan.mid_ns
        if not motion.begins_in_motion:
            return False
        self._begin_ns = self._begin_ns or time_ns
        if stage is None or stage.is_over(time_ns, FIRST_NS if self._stages == 1 else STAGE_NS):
            fits = stage is not None and stage.fits
            motion.begin_at_origin(time_ns, has_velocity=fits)
            fewest = 3 if stage and stage.tilts else 2
            if (fits and self._stages >= fewest) or time_ns - self._begin_ns > LONGEST_NS:
                motion.begins_in_motion, self._stage, self.is_over = False, None, True
                return False
            self._stage = stage = _Stage(motion, time_ns, config)
            self._stages += 1
        stage.match(scan, stabilised, config)
        return True


class _Stage:
    """An empty map, with its origin where the base is. fits: whether every scan fitted it so far."""

    def __init__(self, motion: EgoMotion, begin_ns: int, config: SlamConfig) -> None:
        pyramid = Pyramid(config.map)
        self.fits = True
        self._motion, self._begin_ns, self._scans = motion, begin_ns, 0
        self._lowest, self._highest = np.ones(3), -np.ones(3)
        self._localiser = Localiser(pyramid, motion, np.zeros(3), is_prior=False, writes=True)
        self._mapper = Mapper(pyramid, writes=True)

    def is_over(self, time_ns: int, span_ns: int) -> bool:
        """Whether it is long enough."""
        return self._scans >= FEWEST and time_ns - self._begin_ns >= span_ns

    @property
    def tilts(self) -> bool:
        """Whether the base has tilted since its begin, by more than a floor makes it."""
        return bool((self._highest - self._lowest > LEVEL).any())

    def match(self, scan: LaserScan, stabilised: StabilisedScan, config: SlamConfig) -> None:
        """One more scan, sections IV-B, IV-C and V-B."""
        motion, time_ns = self._motion, scan.mid_ns
        prior = motion.prior(time_ns)
        placed, pose, match, verdict = self._localiser.locate(scan, stabilised, prior, config)
        self._mapper.update(placed, pose, match, verdict, time_ns, config.map, unaided=motion.unaided)
        fused, _ = motion.correct(time_ns, match, accepted=verdict.accepted)
        self._localiser.fused = fused.mean
        self.fits = self.fits and verdict.state == "tracking"
        up = geometry.rotate(geometry.conjugate(motion.motion_at([time_ns])[0, 3:7]), VERTICAL)[0]
        self._lowest, self._highest = np.minimum(self._lowest, up), np.maximum(self._highest, up)
        self._scans += 1
