"""Where a local map lies in the map, and how the map takes in what it has seen."""

from collections import deque

import numpy as np

from slam_core import geometry
from slam_core.config import MapConfig, SlamConfig
from slam_core.localization.local_map import LocalMap
from slam_core.localization.localiser import LocalisedScan, Localiser
from slam_core.localization.map_view import PARTLY, agrees, crossings, looked_at
from slam_core.localization.placements import KeptScan, Placement, Placements, Usual
from slam_core.mapping.mapper import Mapper
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.matcher import coarse_to_fine
from slam_core.measurements import Float64s
from slam_core.results import MatchResult, PlanarGaussian, SearchFailure

JUDGED_NS = 50_000_000  # from one look at a placement to the next
JUDGING = 2e6  # looks at a cell that take as long
MOST_JUDGED = 4  # placements with one scan
NEAR = (0.1, 0.05)  # metres, radians: so near the scan is matched where the placement has it, or it waits
PLACED = np.diag([0.03, 0.03, 0.01]) ** 2.0  # covariance of a placement: metres, metres, radians
UNSUPPORTED = 12  # scans of a local map, 2.4 m of path, without a placement: the robot may have been carried
RESTED_NS = 2_000_000_000  # a robot at rest before and after a gap, for so long, was not moved over it
SAME = (0.15, 0.15)  # metres, radians
LEARNED = 10  # scans, of which one shows how many beams cross walls where the place is sure
CROSSING, MEMORY = 0.02, 0.03  # of the beams at first; weight of the newest such scan
AT_ONCE = 2  # scans of a local map that are written into the map with one scan


class Joining:
    """One for each run. localiser: of the map. mapper: writes it.

    carried: the local map began as the robot got lost without a gap. If nothing supports a place where it can have
    driven, somebody may have carried it, and it is sought the further away the longer that is ago.
    """

    def __init__(self, pyramid: Pyramid, localiser: Localiser, mapper: Mapper) -> None:
        self._pyramid, self._main, self._mapper = pyramid, localiser, mapper
        self._placements = Placements()
        self._joined: deque[KeptScan] = deque()
        self._crossing, self._located = CROSSING, 0
        self._judged_ns = 0
        self.carried = False

    def begin(self, begin: Float64s) -> None:
        """Look for the place of a new local map, which begins at a pose (3,)."""
        self._placements = Placements()
        self._placements.add((begin, self._main.sure), begin)

    def forget(self) -> None:
        """What was seen by the last local map, and is not written yet."""
        self._joined.clear()

    @property
    def any_supported(self) -> bool:
        """Whether the scans agree with the map at one of the placements."""
        return self._placements.any_supported

    def learn(self, found: LocalisedScan) -> None:
        """Now and then: how many beams cross walls of the map at a place that is sure."""
        self._located += 1
        if self._located % LEARNED == 0 and found.match and found.verdict.accepted and found.verdict.confirmed:
            known, crossed = crossings(self._pyramid, found.scan, found.pose)
            if known:
                self._crossing += MEMORY * (crossed / known - self._crossing)

    def place(self, local: LocalMap, found: LocalisedScan, time_ns: int, config: SlamConfig) -> MatchResult | None:
        """The match in the map once it is known where the local map lies there."""
        main, placements, here = self._main, self._placements, found.pose
        motion = geometry.compose(geometry.inverse(local.begin), here)
        carried = self.carried and len(local.scans) >= UNSUPPORTED and not placements.any_supported
        region = main.region(time_ns if carried else local.begin_ns, motion, local.prior)
        places = main.relocaliser.places(self._pyramid, found.scan, time_ns, here, region, config)
        placements.add(places, here)
        main.relocaliser.failure = SearchFailure("unconfirmed", len(placements))
        if not self._judge(local, time_ns, config):
            return None
        best = placements.best(here, time_ns) or self._at_rest(local, here, time_ns)
        return self._match(local, best, found, config) if best else None

    def _judge(self, local: LocalMap, time_ns: int, config: SlamConfig) -> bool:
        """Look at a placement for each JUDGED_NS since the last one. Whether all of them were looked at by now."""
        passed_ns = time_ns - self._judged_ns
        if 0 <= passed_ns < JUDGED_NS:
            return False
        self._judged_ns = time_ns
        usual = Usual(self._main.usual, self._crossing)
        for _ in range(min(MOST_JUDGED, max(1, passed_ns // JUDGED_NS))):
            if not self._placements.judge(self._pyramid, local.scans, usual, config):
                return True
            self._main.relocaliser.spend(JUDGING)
        return False

    def _at_rest(self, local: LocalMap, here: Float64s, time_ns: int) -> Placement | None:
        """Where a robot stands that stood before the gap, and stands now."""
        main = self._main
        stands = main.rested and time_ns - local.begin_ns >= RESTED_NS
        if not stands or geometry.apart(here, local.begin, *SAME):
            return None
        return self._placements.at(main.sure, here, *SAME)

    def _match(
        self, local: LocalMap, placement: Placement, found: LocalisedScan, config: SlamConfig
    ) -> MatchResult | None:
        """The match where a placement has the robot; what the local map has seen is handed to the mapper.

        The placement comes from all scans, so that it counts where this one alone tells little.
        """
        there = geometry.compose(placement.moved, found.pose)
        prior = PlanarGaussian(there, PLACED)
        match = coarse_to_fine(self._pyramid, found.scan.points, there, config.matcher, prior=prior)
        if geometry.apart(match.pose, there, *NEAR):
            return None
        self.take(local, placement.moved)
        return match

    def take(self, local: LocalMap, moved: Float64s) -> None:
        """Have what a local map has seen written, as it lies in the map at a placement (3,)."""
        self._joined.extend(local.settled(moved))

    def write(self, config: MapConfig) -> None:
        """Some of what the last local map has seen, but for scans that the map contradicts."""
        for _ in range(min(AT_ONCE, len(self._joined))):
            scan, pose, _ = self._joined.popleft()
            fit, free = looked_at(self._pyramid, scan, pose)
            if fit.known < PARTLY or agrees(fit, free, self._main.usual):
                self._mapper.add(scan, pose, config)
