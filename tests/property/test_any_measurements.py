"""Whatever is measured, however settings move: results are numbers, covariances positive, the map bounded."""

import math
from collections.abc import Mapping

import numpy as np
import pytest
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, rule

from slam_core import HectorSlam, SlamConfig, StepResult, with_values
from slam_core.config import Leaf, leaves, with_value
from slam_core.geometry import yaw_quaternion
from slam_core.mapping.pyramid import megabytes
from slam_core.measurements import (
    Attitude,
    GpsPosition,
    GpsVelocity,
    GroundDistance,
    Height,
    Imu,
    LaserScan,
    MagneticField,
    Measurement,
    Odometry,
    Transform,
)
from tests.worlds import room_ranges

SMALL_MAP = {"map.size": 64, "map.limit": 4.0}
START = with_values(SlamConfig(), SMALL_MAP)
BEAMS = 60
ANGLES = np.linspace(-math.pi, math.pi, BEAMS, endpoint=False)

EXTREME = st.sampled_from(
    [0.0, -0.0, 1e-300, 0.3, -7.0, 51.2, -2e3, 1e7, -1e19, 1e200, math.inf, -math.inf, math.nan]
)
NUMBERS = st.floats(-20.0, 20.0) | EXTREME
SMALL = st.floats(-1.0, 1.0)
VECTORS = st.tuples(NUMBERS, NUMBERS, NUMBERS).map(np.array)
PLAIN_VECTORS = st.tuples(SMALL, SMALL, SMALL).map(np.array)
# Most steps of time are those of a sensor; some are gaps of an hour, none at all, or backwards.
STEPS_NS = st.sampled_from([25_000_000] * 8 + [0, 3_600_000_000_000, -30_000_000, -20_000_000_000, 600_000_000])
ROTATIONS = st.tuples(NUMBERS, NUMBERS, NUMBERS, NUMBERS).map(np.array) | st.floats(-3.0, 3.0).map(yaw_quaternion)
MOUNTS = st.just(Transform()) | st.builds(Transform, PLAIN_VECTORS, st.floats(-3.0, 3.0).map(yaw_quaternion))
NO_RESTART = [leaf for leaf in leaves(START) if not leaf.param.restart]
REST = np.array([0.0, 0.0, 9.81])


def legal(leaf: Leaf) -> st.SearchStrategy[float | bool | str]:
    """Every value that a setting takes."""
    if leaf.choices:
        return st.sampled_from(leaf.choices)
    if leaf.type is bool:
        return st.booleans()
    low, high = leaf.param.low, leaf.param.high
    if leaf.type is int:
        return st.integers(int(low or 0), int(high if high is not None else 100))
    return st.floats(low if low is not None else 0.0, high if high is not None else 100.0)


CHANGES = st.sampled_from(NO_RESTART).flatmap(lambda leaf: st.tuples(st.just(leaf.name), legal(leaf)))


class AnyMeasurements(RuleBasedStateMachine):
    """A robot in a room whose sensors measure anything at any time, and somebody who moves every slider.

    map_settings: what the map begins with.
    """

    map_settings: Mapping[str, float] = SMALL_MAP

    def __init__(self) -> None:
        super().__init__()
        self.slam, self.results = HectorSlam(START), list[StepResult]()
        self.now_ns = 1_000_000_000_000

    @initialize(paper=st.booleans(), resting=st.booleans())
    def begin(self, paper: bool, resting: bool) -> None:
        """With the defaults or the method of the paper, with inertial data of a robot at rest or without."""
        base = SlamConfig.paper() if paper else SlamConfig()
        self.slam = HectorSlam(with_values(base, self.map_settings))
        for _ in range(40 if resting else 0):
            self.now_ns += 25_000_000
            self.add(Imu(self.now_ns, np.zeros(3), REST))

    def add(self, measurement: Measurement) -> None:
        """To the pipeline; the invariants look at the results."""
        self.results += self.slam.add(measurement)

    @rule(step_ns=STEPS_NS, x=st.floats(-1.5, 1.5), psi=st.floats(-4.0, 4.0), mount=MOUNTS)
    def scan_the_room(self, step_ns: int, x: float, psi: float, mount: Transform) -> None:
        """A good scan, from somewhere in the room."""
        self.now_ns += step_ns
        ranges = room_ranges(np.array([x, 0.1, psi]), ANGLES).astype(np.float32)
        increment = float(ANGLES[1] - ANGLES[0])
        self.add(LaserScan(self.now_ns, ranges, ANGLES[0], increment, 1e-4, T_base_laser=mount))

    @rule(
        step_ns=STEPS_NS,
        ranges=st.lists(NUMBERS, max_size=8),
        angles=st.tuples(NUMBERS, NUMBERS),
        increment=st.sampled_from([0.0, 1e-4, -1e-4, 0.3]),
        limits=st.tuples(NUMBERS, NUMBERS),
        mount=MOUNTS,
    )
    def scan_anything(
        self,
        step_ns: int,
        ranges: list[float],
        angles: tuple[float, float],
        increment: float,
        limits: tuple[float, float],
        mount: Transform,
    ) -> None:
        """Any ranges at any angles."""
        self.now_ns += step_ns
        with np.errstate(over="ignore"):
            measured = np.array(ranges).astype(np.float32)
        self.add(LaserScan(self.now_ns, measured, *angles, increment, *limits, mount))

    @rule(step_ns=STEPS_NS, rate=PLAIN_VECTORS, tilt=PLAIN_VECTORS, count=st.integers(1, 20))
    def move(self, step_ns: int, rate: np.ndarray, tilt: np.ndarray, count: int) -> None:
        """Inertial data of a robot that moves as robots do."""
        for _ in range(count):
            self.now_ns += step_ns if count == 1 else 5_000_000
            self.add(Imu(self.now_ns, rate, REST + tilt))

    @rule(step_ns=STEPS_NS, rate=VECTORS, force=VECTORS)
    def shake(self, step_ns: int, rate: np.ndarray, force: np.ndarray) -> None:
        """Inertial data of any size."""
        self.now_ns += step_ns
        self.add(Imu(self.now_ns, rate, force))

    @rule(step_ns=STEPS_NS, value=NUMBERS, vector=VECTORS, rotation=ROTATIONS, kind=st.integers(0, 6))
    def aid(self, step_ns: int, value: float, vector: np.ndarray, rotation: np.ndarray, kind: int) -> None:
        """Any other sensor, with any value."""
        self.now_ns += step_ns
        stamp = self.now_ns
        self.add(
            (
                Odometry(stamp, vector[:2], value),
                Height(stamp, value),
                Attitude(stamp, rotation),
                GroundDistance(stamp, value, np.zeros(3), np.array([0.0, 0.0, -1.0])),
                MagneticField(stamp, 1e-5 * vector),
                GpsPosition(stamp, vector, np.diag(np.abs(vector)), np.zeros(3)),
                GpsVelocity(stamp, vector),
            )[kind]
        )

    @rule(change=CHANGES)
    def slide(self, change: tuple[str, float | bool | str]) -> None:
        """A setting takes any legal value, except that the map stays small."""
        if change[0] != "map.limit":
            self.slam.configure(with_value(self.slam.config, *change))

    @rule()
    def finish(self) -> None:
        """What waits is processed."""
        self.results += self.slam.finish()

    @invariant()
    def results_are_numbers(self) -> None:
        """Poses, states and covariances are finite, the latter positive."""
        results, self.results = self.results, []
        for result in results:
            pose = result.T_map_base
            assert np.isfinite([*pose.translation, *pose.rotation, *result.planar]).all()
            assert np.linalg.norm(pose.rotation) == pytest.approx(1.0)
            for estimate in (result.fused, result.prior, result.match.gaussian if result.match else None):
                assert estimate is None or is_gaussian(estimate.mean, estimate.covariance)
            state = result.navigation
            assert state is None or is_gaussian(state.x[:16], state.covariance)

    @invariant()
    def the_map_is_bounded(self) -> None:
        """Its cells are numbers, and take no more memory than they may."""
        levels, limit = self.slam.map.levels, self.slam.config.map.limit
        assert all(np.isfinite(level.log_odds).all() for level in levels)
        assert megabytes(levels[0].log_odds.size, len(levels)) <= limit


def is_gaussian(mean: np.ndarray, covariance: np.ndarray) -> bool:
    """Finite, with a covariance without a negative eigenvalue, but for rounding of the largest one."""
    if not (np.isfinite(mean).all() and np.isfinite(covariance).all()):
        return False
    values = np.linalg.eigvalsh(covariance)
    return bool(values[0] >= -1e-9 * max(values[-1], 1.0))


TestAnyMeasurements = pytest.mark.filterwarnings("ignore::RuntimeWarning")(AnyMeasurements.TestCase)
TestAnyMeasurements.settings = settings(
    max_examples=60,
    stateful_step_count=30,
    derandomize=True,
    deadline=None,
    suppress_health_check=list(HealthCheck),
)


def test_an_estimate_that_is_none_is_found() -> None:
    """The judge of the invariants tells a Gaussian from what is none."""
    identity = np.eye(2)
    assert is_gaussian(np.zeros(2), identity)
    assert not is_gaussian(np.array([math.nan, 0.0]), identity)
    assert not is_gaussian(np.zeros(2), np.diag([1.0, -0.1]))
    assert not is_gaussian(np.zeros(2), np.diag([1.0, math.inf]))
