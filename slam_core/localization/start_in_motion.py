"""A start in motion: matches in maps of their own, until they have shown the filter its attitude and velocity.

A base at rest is levelled by its accelerometers. In motion these measure its acceleration, too, so that what is
mapped first is askew. It is given up, and mapped anew with what was learned of the motion. The first map that was
begun with what is known, and that every scan fits, is the map of the run.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from slam_core import geometry
from slam_core.config import SlamConfig
from slam_core.localization.localiser import Localiser
from slam_core.mapping.mapper import Mapper
from slam_core.mapping.pyramid import Pyramid
from slam_core.measurements import LaserScan
from slam_core.navigation.ego_motion import EgoMotion
from slam_core.scan.stabilise import StabilisedScan


class _Length(NamedTuple):
    """The least of a stage: nanoseconds, scans."""

    span_ns: int
    scans: int


STAGE, LAST, LAST_OF_ONE_THAT_TILTS = (
    _Length(1_000_000_000, 4),
    _Length(2_000_000_000, 4),
    _Length(2_000_000_000, 25),
)
LONGEST_NS = 8_000_000_000
STAGES, OF_ONE_THAT_TILTS = 2, 4
LEVEL = 0.05  # rad, nearly: so much the vertical turns in the axes of a base that drives on a floor
VERTICAL = np.array([[0.0, 0.0, 1.0]])

Adopt = Callable[[Pyramid, Localiser, Mapper], None]


class StartInMotion:
    """One for each run. Of a base in motion: short stages, and a longer one that every scan has to fit.

    One that tilts needs more of them: its acceleration and its tilt are told apart later. Its last one has more
    scans, as each of them sees less of the walls.
    is_over: whether there was a start in motion, and the map has begun.
    """

    def __init__(self, motion: EgoMotion) -> None:
        self.is_over = False
        self._motion = motion
        self._begin_ns = self._stages = 0
        self._stage: _Stage | None = None

    def takes(self, scan: LaserScan, stabilised: StabilisedScan, config: SlamConfig, adopt: Adopt) -> bool:
        """Whether a scan is used for the motion alone, as there is no map to go on with yet.

        adopt: called with the map of the last stage, and what locates scans in it and writes them.
        """
        motion, stage, time_ns = self._motion, self._stage, scan.mid_ns
        if not motion.begins_in_motion:
            return False
        if stage is not None and time_ns < stage.begin_ns:  # by a clock that was set back
            self._begin_ns, self._stages, stage = time_ns, 0, None
        self._begin_ns = self._begin_ns or time_ns
        last = stage is not None and self._stages >= (OF_ONE_THAT_TILTS if stage.tilts else STAGES)
        if stage is None or stage.is_over(time_ns, last=last):
            fits = stage is not None and stage.fits
            if stage and last and fits:
                adopt(stage.pyramid, stage.localiser, stage.mapper)
                return self._end()
            motion.begin_at_origin(time_ns, has_velocity=fits)
            if time_ns - self._begin_ns > LONGEST_NS:
                return self._end()
            self._stage = stage = _Stage(motion, time_ns, config)
            self._stages += 1
        stage.match(scan, stabilised, config)
        return True

    def _end(self) -> bool:
        """The scan goes to the map of the run."""
        self._motion.begins_in_motion, self._stage, self.is_over = False, None, True
        return False


class _Stage:
    """An empty map, with its origin where the base is. fits: whether every scan fitted it so far."""

    def __init__(self, motion: EgoMotion, begin_ns: int, config: SlamConfig) -> None:
        self.pyramid = Pyramid(config.map)
        self.fits, self.begin_ns = True, begin_ns
        self._motion, self._scans = motion, 0
        self._lowest, self._highest = np.ones(3), -np.ones(3)
        self.localiser = Localiser(self.pyramid, motion, np.zeros(3), is_prior=False, writes=True)
        self.mapper = Mapper(self.pyramid, writes=True)

    def is_over(self, time_ns: int, *, last: bool) -> bool:
        """Whether it is long enough."""
        least = STAGE if not last else LAST_OF_ONE_THAT_TILTS if self.tilts else LAST
        return self._scans >= least.scans and time_ns - self.begin_ns >= least.span_ns

    @property
    def tilts(self) -> bool:
        """Whether the base has tilted since its begin, by more than a floor makes it."""
        return bool((self._highest - self._lowest > LEVEL).any())

    def match(self, scan: LaserScan, stabilised: StabilisedScan, config: SlamConfig) -> None:
        """One more scan, sections IV-B, IV-C and V-B."""
        motion, time_ns = self._motion, scan.mid_ns
        prior = motion.prior(time_ns)
        placed, pose, match, verdict = self.localiser.locate(scan, stabilised, prior, config)
        self.mapper.update(placed, pose, match, verdict, time_ns, config.map, unaided=motion.unaided)
        fused, _ = motion.correct(time_ns, match, accepted=verdict.accepted)
        self.localiser.fused = fused.mean
        self.fits = self.fits and verdict.state == "tracking"
        up = geometry.rotate(geometry.conjugate(motion.motion_at([time_ns])[0, 3:7]), VERTICAL)[0]
        self._lowest, self._highest = np.minimum(self._lowest, up), np.maximum(self._highest, up)
        self._scans += 1
