"""What a step returns: plain values that never change, for views, exporters and tests to read.

Named tuples, as a step makes a dozen of them: a frozen dataclass takes three times as long.
"""

import math
from array import array
from collections import Counter
from collections.abc import Mapping
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from slam_core.config import ScanConfig
from slam_core.measurements import Float32s, Float64s, Int64s, LaserScan, Transform

Tracking = Literal["tracking", "recovered", "degraded", "lost"]
_NOTHING: Mapping[str, int] = {}
NOWHERE = np.zeros(2)  # in the place of a direction
NONE = np.zeros(0, np.int64)  # in the place of numbers of beams


class PlanarGaussian(NamedTuple):
    """A planar pose with its uncertainty: mean (3,) x, y in metres and heading in radians; covariance (3, 3)."""

    mean: Float64s
    covariance: Float64s

    def distance_to(self, pose: Float64s) -> float:
        """Metres between the mean position and that of a pose (3,)."""
        return math.hypot(pose.item(0) - self.mean.item(0), pose.item(1) - self.mean.item(1))

    @property
    def sigma(self) -> float:
        """The larger standard deviation of the position along x and y, metres."""
        return math.sqrt(max(self.covariance.item(0, 0), self.covariance.item(1, 1)))


class Fit(NamedTuple):
    """How the endpoints of a scan meet a level.

    known: share of them on known cells. hit: share of those that lie on occupied cells.
    """

    known: float
    hit: float

    @classmethod
    def counted(cls, beams: int, known: int, hits: int) -> "Fit":
        """Of so many beams so many on known cells, and of those so many on occupied ones."""
        return cls(known / max(beams, 1), hits / max(known, 1))


FEW = 0.1  # of the beams, as a share: fewer fix a direction badly


class MatchResult(NamedTuple):
    """The outcome of section IV-B on one scan.

    pose: (3,) xi* = x, y, psi of the stabilised frame in the map. covariance: (3, 3) R of eq. (15), metres
    and radians. hessian: (3, 3) H of eq. (13) at the finest level, per metre and radian.
    residuals: (n,) 1 - M(S_i(xi*)) of every endpoint, at the finest level; where many lie on walls seen from
    behind, theirs are 0.5, as on unknown cells, at least. iterations: finest level first.
    trace: (k, 4) level, x, y, psi after each Gauss-Newton step, coarse to fine, before the pose settles on the
    surfels; (0, 4) when not asked for.
    weakest_share: share of the beams that fix the position in the direction that the scan's shape fixes worst.
    unobservable: (2,) that direction in the map, where too few beams fix it and the pose keeps its start estimate
    along it; else zero.
    fit: at the coarsest level. left_out: (k,) numbers of the endpoints that were not matched, as they are on
    objects that may move.
    """

    pose: Float64s
    covariance: Float64s
    hessian: Float64s
    residuals: Float32s
    iterations: tuple[int, ...]
    converged: bool
    trace: Float64s
    unobservable: Float64s = NOWHERE
    weakest_share: float = 1.0
    fit: Fit = Fit(1.0, 1.0)
    left_out: Int64s = NONE

    @property
    def mean_residual(self) -> float:
        """Mean of the residuals: 0 is a perfect fit, 0.5 an unknown map."""
        n = len(self.residuals)
        return float(np.add.reduce(self.residuals)) / n if n else float("nan")

    @property
    def leaves_direction(self) -> bool:
        """Whether too few beams fix the position in some direction, which is `unobservable`."""
        return self.unobservable.item(0) != 0.0 or self.unobservable.item(1) != 0.0

    @property
    def is_badly_fixed(self) -> bool:
        """Whether few beams fix the position along the direction that the scan's shape fixes worst."""
        return self.weakest_share < FEW

    @property
    def weakest_sigma(self) -> float:
        """Sigma of the position along the direction that the scan determines worst, metres."""
        (xx, xy, _), (_, yy, _), _ = self.covariance.tolist()
        return math.sqrt(0.5 * (xx + yy + math.hypot(xx - yy, 2.0 * xy)))

    @property
    def weakest_direction(self) -> Float64s:
        """(2,) that direction in the map, a unit vector."""
        (xx, xy, _), (_, yy, _), _ = self.covariance.tolist()
        angle = 0.5 * math.atan2(2.0 * xy, xx - yy)
        return np.array([math.cos(angle), math.sin(angle)])

    @property
    def gaussian(self) -> PlanarGaussian:
        """xi* with R."""
        return PlanarGaussian(self.pose, self.covariance)


class Rejection(NamedTuple):
    """Why a match was rejected or is not enough: a figure, its value, and the limit or the usual value it missed.

    overlap: share of the scan on known cells. inlier_ratio: share of the known endpoints on occupied cells,
    against its running mean. mahalanobis_distance: sigmas from the prediction. hidden: share of the beams that end
    before the walls of the map. objects: share of the endpoints on compact objects. endpoints: their number.
    unobservable: sigma of the position, metres, along a direction that no beam fixes.
    """

    code: Literal[
        "overlap", "inlier_ratio", "mahalanobis_distance", "hidden", "objects", "endpoints", "unobservable"
    ]
    value: float
    limit: float


class Verdict(NamedTuple):
    """What became of a scan's match.

    accepted: the pose is that of the match; else it is the prediction, or the last sure pose of a lost robot whose
    motion only matches observe. rejection: what spoke against the first match. outside_map: the robot got lost
    where there is no map yet. recovery: "relocalised" by a search of the whole map, or "continued" from the
    prediction. confirmed: the pose explained several scans, or was never in doubt; else no scan is written there.
    """

    state: Tracking = "tracking"
    rejection: Rejection | None = None
    accepted: bool = True
    outside_map: bool = False
    recovery: Literal["", "relocalised", "continued"] = ""
    confirmed: bool = True

    @property
    def hidden(self) -> bool:
        """Whether the scan tells nothing of the pose: something hides the map or moves, or few beams return."""
        return self.rejection is not None and self.rejection.code in ("hidden", "objects", "endpoints")

    @property
    def undoubted(self) -> bool:
        """Whether nothing speaks against the match: at most, no beam fixes one direction."""
        return self.state == "tracking" or (self.rejection is not None and self.rejection.code == "unobservable")


ACCEPTED = Verdict()


class SearchFailure(NamedTuple):
    """Why the pose of the robot in the map is unknown.

    pending: no search has ended yet. no_place: at best the share `value` of the scan agrees with the map (0: no
    candidate), and `limit` is needed. ambiguous: it fits `value` places alike. crowded: more places than can be
    compared. unconfirmed: the robot is tracked in a local map, which may lie at `value` places of the map.
    """

    code: Literal["pending", "no_place", "ambiguous", "crowded", "unconfirmed"]
    value: float = 0.0
    limit: float = 0.0


class StartFound(NamedTuple):
    """Where the run began in a prior map: pose (3,), the share of the scan that agrees with the map there.

    elsewhere: at another place than the one that was given.
    """

    pose: Float64s
    agreement: float
    elsewhere: bool


class Status(NamedTuple):
    """The pipeline at the time of the last scan.

    search_failure: why the pose in the map is unknown; None while it is known. start_found: where the run began in
    a prior map, once that is known. moved_at_start: whether the map began later than the scans, as the base
    moved. skipped: scans without a result, by reason. unused: other measurements that were not used as they came,
    by reason.
    """

    search_failure: SearchFailure | None
    start_found: StartFound | None
    moved_at_start: bool
    skipped: Counter[str]
    unused: Counter[str]


class NavigationState(NamedTuple):
    """The estimate of the filter at one time (section V-A).

    x: (19,) attitude as a quaternion, position, velocity and biases, as below, and the specific force, smoothed.
    covariance: (15, 15) of the errors of attitude (small rotation about the map's axes), position, velocity, gyro
    bias, accelerometer bias, in that order.
    """

    stamp_ns: int
    x: Float64s
    covariance: Float64s

    @property
    def T_map_base(self) -> Transform:
        """Position and attitude."""
        return Transform(self.x[4:7], self.x[:4])

    @property
    def velocity(self) -> Float64s:
        """(3,) m/s in the map frame."""
        return self.x[7:10]

    @property
    def gyro_bias(self) -> Float64s:
        """(3,) rad/s."""
        return self.x[10:13]

    @property
    def accel_bias(self) -> Float64s:
        """(3,) m/s^2."""
        return self.x[13:16]


class AidingStatus(NamedTuple):
    """What became of the measurements of one source, up to some instant.

    measures: the error states (0-2 attitude, 3-5 position, 6-8 velocity) that it is about. used, rejected: how
    many passed the gate, and how many not. returns: how often it came back after a rejection that lasted. Of the
    last one: stamp_ns, innovation (m,) with covariance S (m, m), the normalised innovation squared (nis) and the
    bound on that (inf: no gate). used_ns: time of the last that was used. streak, streak_ns: rejections in a row
    that agree with each other, and since when. reading, reading_ns, reading_at: a value that repeats itself, since
    when, and where the base was; frozen: the base moved on and it still does. dropped: those that did not come to
    the gate, by reason.
    """

    source: str
    measures: tuple[int, ...] = ()
    used: int = 0
    rejected: int = 0
    returns: int = 0
    stamp_ns: int = 0
    innovation: Float64s = np.zeros(0)
    S: Float64s = np.zeros((0, 0))
    nis: float = 0.0
    bound: float = math.inf
    used_ns: int = 0
    streak: int = 0
    streak_ns: int = 0
    reading: tuple[float, ...] = ()
    reading_ns: int = 0
    reading_at: tuple[float, ...] = ()
    frozen: bool = False
    dropped: Mapping[str, int] = _NOTHING

    @property
    def sigma(self) -> Float64s:
        """Of the last innovation (m,)."""
        return np.sqrt(np.diag(self.S))

    @property
    def accepted(self) -> bool:
        """Whether the last measurement was used."""
        return self.used > 0 and self.streak == 0 and not self.frozen


class Durations(NamedTuple):
    """Nanoseconds spent in each part of a step, by the clock that was handed to the pipeline."""

    stabilise: int = 0
    match: int = 0
    update: int = 0
    filter: int = 0


class Sweep(NamedTuple):
    """Where the endpoints of a scan come from; `slam_core.scan.beams` finds the beam of an endpoint by it.

    scan: as it was used; its ranges may be smoothed. measured: (n,) its ranges as they came. poses: as
    `place_beams` takes them. config: in force. laser: (2,) where beams start in the stabilised frame.
    """

    scan: LaserScan
    measured: Float32s
    poses: Float64s
    config: ScanConfig
    laser: Float64s


class StepResult(NamedTuple):
    """Everything that one scan brought.

    stamp_ns: the middle of the sweep, which all poses here belong to. T_map_base: the fused 6DOF pose; without
    inertial data the match with the roll and pitch that are known.
    planar: the pose (3,) from which points are drawn. points: (n, 2) endpoints in the stabilised frame, metres.
    heights: (n,) their height over the laser. unexpected: (n,) which of them the map held for free until then.
    prior, fused: the filter projected to the plane before and after the fusion (prior is None where match is);
    fused contains the drift of the map (`MapDrift`); the filter does not, its pose is one on that map.
    navigation: the filter after the fusion; None without an IMU.
    match: None on the first scan of a map, which only makes it.
    verdict: whether planar is the match, and whether that is sure: "tracking", "recovered" after a bad one,
    "degraded", or "lost" when that lasts. An accepted match is "degraded" along a direction that is hardly known.
    aiding: what became of every source's measurements so far. world: the pose of the map in the tangent plane of
    the satellites (east, north, heading from east); None while not known.
    sweep: what the endpoints were made of.
    """

    index: int  # type: ignore[assignment]  # it hides the method of tuples
    stamp_ns: int
    T_map_base: Transform
    planar: Float64s
    points: Float32s
    heights: Float32s
    unexpected: NDArray[np.bool_]
    match: MatchResult | None
    prior: PlanarGaussian | None
    fused: PlanarGaussian
    navigation: NavigationState | None
    map_updated: bool
    beams: int
    durations: Durations
    verdict: Verdict = ACCEPTED
    aiding: tuple[AidingStatus, ...] = ()
    world: PlanarGaussian | None = None
    sweep: Sweep | None = None

    @property
    def tracking(self) -> Tracking:
        """The tracking state."""
        return self.verdict.state


class Poses(NamedTuple):
    """Poses of the base in the map: stamps_ns (n,), positions (n, 3) metres, rotations (n, 4) w, x, y, z."""

    stamps_ns: Int64s
    positions: Float64s
    rotations: Float64s


class PoseRecord:
    """The poses of a run, as compact as arrays."""

    def __init__(self) -> None:
        self._stamps, self._values = array("q"), array("d")

    def append(self, result: StepResult) -> None:
        """Add the pose of a scan."""
        self._stamps.append(result.stamp_ns)
        self._values.extend((*result.T_map_base.translation.tolist(), *result.T_map_base.rotation.tolist()))

    @property
    def poses(self) -> Poses:
        """All so far; a copy."""
        values = np.array(self._values).reshape(-1, 7)
        return Poses(np.array(self._stamps, np.int64), values[:, :3], values[:, 3:])
