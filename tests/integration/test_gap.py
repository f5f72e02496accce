"""A gap in all data, as over a link that breaks: the robot is tracked in a local map until its place is found."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from benchmarks import ensemble_cases, ensembles
from hectorscope.run.checkpoints import Checkpoint, Place
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from hectorscope.simulation import SceneOptions, Simulation
from hectorscope.simulation.options import ScenarioName
from slam_core.config import SlamConfig, with_value
from slam_core.evaluation.trajectory import Trajectory, first_on_first, interpolate, move, relative_errors
from slam_core.measurements import Height, Imu, LaserScan, Measurement
from slam_core.results import PlanarGaussian, StepResult

OPTIONS = SceneOptions(scan_rate=10.0, beams=361, duration=60.0)
ROOMS = ("rooms", ((20.0, 26.0),))  # the robot comes to rooms that are half unknown, and back
Gaps = tuple[tuple[float, float], ...]


class Drive:
    """A drive without any data in the given seconds. results: so far. pipeline: the run, which may be replaced."""

    def __init__(
        self,
        scene: ScenarioName,
        gaps: Gaps,
        config: SlamConfig | None = None,
        *,
        imu: bool = True,
        rate: float = 10.0,
    ) -> None:
        items = list(Simulation(scene, replace(OPTIONS, imu=imu, scan_rate=rate)).items())
        self.start_ns = items[0].stamp_ns
        self.pipeline = Pipeline(Settings(config or SlamConfig()), self.start_ns)
        self.results = list[StepResult]()
        self._items, self._gaps = items, gaps

    def on(self) -> Iterator[StepResult]:
        """Go on, result by result."""
        for measurement in self._measurements():
            if result := self.pipeline.step(measurement):
                self.results.append(result)
                yield result

    def to_the_end(self) -> "Drive":
        """All of it."""
        for _ in self.on():
            pass
        return self

    def seconds(self, result: StepResult) -> float:
        """Since the start of the drive."""
        return (result.stamp_ns - self.start_ns) * 1e-9

    @property
    def truth(self) -> np.ndarray:
        """(n, 3) of each result, in the map."""
        times = np.array([self.seconds(result) for result in self.results])
        true = interpolate(Trajectory.from_rows(self.pipeline.truth), times)[0].planar
        return move(first_on_first(true, self.poses), true)

    @property
    def poses(self) -> np.ndarray:
        """(n, 3) of each result."""
        return np.array([result.planar for result in self.results])

    @property
    def off(self) -> np.ndarray:
        """(n,) metres that each result errs."""
        return np.hypot(*(self.poses - self.truth)[:, :2].T)

    @property
    def lost(self) -> np.ndarray:
        """(n,) whether the result says so."""
        return np.array([result.tracking == "lost" for result in self.results])

    def _measurements(self) -> Iterator[Measurement]:
        for item in self._items:
            since = (item.stamp_ns - self.start_ns) * 1e-9
            silent = any(first <= since < last for first, last in self._gaps)
            if not (silent and isinstance(item, (LaserScan, Imu, Height))):
                yield from self.pipeline.admit(item)
        yield from self.pipeline.flush()


@pytest.fixture(scope="module")
def rooms() -> Drive:
    """A drive that is silent while it comes to rooms that are half unknown, to its end."""
    return Drive(*ROOMS).to_the_end()


def cells_along(way: np.ndarray, pipeline: Pipeline) -> np.ndarray:
    """(n,) log-odds of the cells of the map in which poses (n, 3) lie."""
    level = pipeline.slam.map.levels[0]
    columns, rows = np.floor(way[:, :2] / level.resolution).astype(int).T
    cells = [
        level.gather((row, row + 1, column, column + 1))[0, 0] for row, column in zip(rows, columns, strict=True)
    ]
    return np.array(cells)


def assert_found(drive: Drive) -> None:
    """The robot was lost, is found in the end, and was nowhere far off while it was called tracked."""
    assert drive.lost.any()
    assert not drive.lost[-20:].any()
    assert drive.off[-20:].max() < 0.15
    assert drive.off[~drive.lost].max() < 0.3


def test_the_place_is_found_once_the_scans_of_the_local_map_agree_with_the_map(rooms: Drive):
    """Not before: a room that looks alike would have been taken for it."""
    assert_found(rooms)
    recovered = [result for result in rooms.results if result.verdict.recovery == "relocalised"]
    assert len(recovered) == 1
    assert rooms.seconds(recovered[0]) > 28.0


@pytest.mark.parametrize("variant", [1, 4])
def test_a_robot_is_not_taken_to_a_wrong_place_of_a_small_map(variant: int):
    """Most of what it sees after the gap is unknown. Where the rest fits it looks through walls."""
    run = ensembles.run("arena, no data for 5 s from 10 s", variant, {})
    assert run.truth is not None
    true = move(first_on_first(run.truth, run.poses[:, 1:]), run.truth)
    off = np.hypot(*(run.poses[:, 1:] - true)[:, :2].T)
    assert off[run.sure].max() < 0.3
    assert off[-20:].max() < 0.1
    assert not run.lost_at_the_end


def test_a_lost_robot_is_followed_in_its_local_map(rooms: Drive):
    """Its pose does not run away: where it is in the map is wrong by one motion, but its way is right to 5 cm."""
    ours, true = rooms.poses[rooms.lost], rooms.truth[rooms.lost]
    times = np.arange(len(ours), dtype=float)
    errors = relative_errors(ours[10:], true[10:], times[10:], 30.0)
    assert len(errors) > 20
    assert np.hypot(*errors[:, :2].T).max() < 0.05


def test_a_lost_robot_does_not_claim_to_know_its_pose_in_the_map(rooms: Drive):
    """The covariance holds the error, which is metres, while its motion is known to millimetres."""
    for result, off in zip(rooms.results, rooms.off, strict=True):
        if result.tracking == "lost":
            sigma = np.sqrt(result.fused.covariance[:2, :2].diagonal().max())
            assert sigma > 1.0
            assert off < 10.0 * sigma
            assert result.verdict.accepted
            assert not (result.verdict.confirmed or result.map_updated)


def test_what_was_seen_while_the_robot_was_lost_is_in_the_map_afterwards(rooms: Drive):
    """All of its way is free there, of which half was unknown; while it was lost nothing was written."""
    way = rooms.truth[rooms.lost]
    assert (cells_along(way, rooms.pipeline) < 0.0).all()


def test_nothing_is_written_while_the_robot_is_lost():
    """The map is the same to the last cell; scans are matched with the local one."""
    drive = Drive(*ROOMS)
    revisions = set()
    for result in drive.on():
        slam = drive.pipeline.slam
        assert (slam.matched_map is not slam.map) == (result.tracking == "lost")
        if result.tracking == "lost":
            revisions.add(slam.map.revision)
        elif revisions:
            break
    assert len(revisions) == 1
    assert drive.pipeline.slam.status.search_failure is None


def test_the_status_says_that_the_robot_is_in_a_local_map():
    """And how many places there may be."""
    drive = Drive(*ROOMS)
    for result in drive.on():
        if drive.seconds(result) > 28.0:
            break
    failure = drive.pipeline.slam.status.search_failure
    assert failure is not None
    assert failure.code == "unconfirmed"
    assert failure.value >= 1


def test_a_checkpoint_of_a_lost_robot_goes_on_to_the_same_bytes(rooms: Drive):
    """The local map and the places that were tried are part of it."""
    drive, was_lost = Drive(*ROOMS), 0
    for result in drive.on():
        was_lost += result.tracking == "lost"
        if was_lost == 15:
            checkpoint = Checkpoint(drive.pipeline, Place(0, None), None)
            drive.pipeline = checkpoint.pipeline(drive.pipeline.settings)
            was_lost += 1
    assert was_lost > 15
    np.testing.assert_array_equal(drive.pipeline.trajectory, rooms.pipeline.trajectory)
    assert drive.pipeline.slam.map.revision == rooms.pipeline.slam.map.revision


def test_a_pose_that_somebody_states_ends_the_local_map():
    """The run goes on in the map at once, from there."""
    drive = Drive(*ROOMS)
    for result in drive.on():
        if drive.seconds(result) > 28.0:
            break
    assert drive.pipeline.slam.matched_map is not drive.pipeline.slam.map
    true = PlanarGaussian(drive.truth[-1], np.diag([0.1, 0.1, 0.05]) ** 2)
    assert drive.pipeline.slam.reset_pose(true)
    assert drive.pipeline.slam.matched_map is drive.pipeline.slam.map


def test_a_pose_that_somebody_states_keeps_the_rest_of_a_local_map_out_of_the_map():
    """Whoever sets the pose right after a place was found takes that for wrong: the rest is not written."""
    written = []
    for is_reset in (False, True):
        drive = Drive(*ROOMS)
        results = drive.on()
        for result in results:
            if result.verdict.recovery == "relocalised":
                break
        slam, before = drive.pipeline.slam, drive.pipeline.slam.map.updates
        if is_reset:
            assert slam.reset_pose(result.match.gaussian)
        for result, _ in zip(results, range(5), strict=False):
            assert result.tracking != "lost"
        written.append(slam.map.updates - before)
    assert written[0] >= 8
    assert written[1] <= 2


@pytest.mark.parametrize("name", ["tracking.relocalise", "tracking.check"])
def test_without_a_search_there_is_no_local_map(name: str):
    """What the settings say holds: scans are matched with the map alone."""
    drive = Drive(*ROOMS, with_value(SlamConfig(), name, False))
    for result in drive.on():
        assert drive.pipeline.slam.matched_map is drive.pipeline.slam.map
        if drive.seconds(result) > 30.0:
            break


def test_a_robot_that_stands_is_found_where_it_stood():
    """It does not have to move for that, but to stand for two seconds."""
    drive = Drive("people", ((33.0, 37.0),))
    for result in drive.on():
        if drive.seconds(result) > 40.0:
            break
    assert drive.lost.any()
    assert not drive.lost[-1]
    assert drive.off.max() < 0.1
    assert np.ptp(drive.truth[-20:, 0]) < 0.01  # it stood


def test_a_second_gap_begins_another_local_map():
    """Of what came before it nothing is known; the robot is found all the same."""
    drive = Drive("rooms", ((20.0, 26.0), (28.0, 31.0))).to_the_end()
    assert_found(drive)


def test_a_short_gap_needs_no_local_map():
    """After one second a prediction is still of use."""
    drive = Drive("rooms", ((20.0, 21.0),)).to_the_end()
    assert not drive.lost.any()
    assert drive.off.max() < 0.1


def test_slow_scans_find_their_place_as_soon():
    """Placements are judged as often as with fast ones. With one for each scan this robot was lost to the end."""
    drive = Drive("arena", ((23.6, 33.6),), rate=5.0)
    for result in drive.on():
        if drive.seconds(result) > 57.0:
            break
    assert drive.lost.any()
    assert not drive.lost[-20:].any()
    assert drive.off[-20:].max() < 0.3


def test_a_robot_without_inertial_data_is_found_as_well():
    """Its scans show the gap."""
    assert_found(Drive("rooms", ((20.0, 26.0),), imu=False).to_the_end())


@pytest.mark.slow
@pytest.mark.parametrize(
    ("case", "variant"),
    [
        ("arena, no data for 2 s", 1),
        ("arena, no data for 10 s", 2),
        ("arena, laser alone, no data for 10 s", 1),
        ("rooms, no data for 10 s", 1),
        ("people, no data for 10 s", 1),
    ],
)
def test_no_other_room_is_taken_for_the_right_one(case: str, variant: int):
    """Rooms that look alike were believed at once, and the map was drawn there."""
    (outcome,) = ensembles.outcomes([ensembles.run(case, variant, {})])
    assert not (outcome.lost or outcome.misplaced or outcome.silent)


@pytest.mark.slow
@pytest.mark.parametrize("case", ["handheld, no data for 3 s", "handheld, no data for 10 s"])
def test_a_robot_that_does_not_come_back_to_its_map_stays_lost(case: str):
    """It says so, and its motion is right but for the gap; it was believed a kilometre off."""
    run = ensembles.run(case, 1, {})
    (outcome,) = ensembles.outcomes([run])
    assert outcome.lost
    assert not (outcome.misplaced or outcome.silent)
    assert run.truth is not None
    after = run.poses[:, 0] > ensemble_cases.BLIND_S + 11.0
    errors = relative_errors(run.poses[after, 1:], run.truth[after], run.poses[after, 0], 5.0)
    assert np.hypot(*errors[:, :2].T).max() < 0.1
