"""Faults put into drives: what the check of the matches is for. Plain has neither that nor patience."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from functools import cache
from itertools import takewhile

import numpy as np
import pytest

from hectorscope.inputs import Item
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from hectorscope.simulation.options import SceneOptions
from hectorscope.simulation.sensors import START_NS
from hectorscope.simulation.simulation import Simulation
from slam_core.config import SlamConfig, with_value
from slam_core.evaluation.trajectory import Trajectory, evaluate, first_on_first, interpolate, move
from slam_core.localization.confirmation import FEW
from slam_core.measurements import LaserScan

START_S, DEAD_S = 15.0, 1.5
ENTERS_S = 12.0  # when the robot passes a door
BROKEN_SCANS = 10
SCANS_A_SECOND = 20
Fault = Callable[[Iterable[Item]], Iterator[Item]]


@cache
def drive(imu: bool) -> tuple[Item, ...]:
    """Twenty seconds through the rooms, with a turn at START_S."""
    options = SceneOptions(seed=2, imu=imu, duration=20.0, beams=361, scan_rate=float(SCANS_A_SECOND))
    return tuple(Simulation("rooms", options).items())


def scans_removed(items: Iterable[Item]) -> Iterator[Item]:
    """No scan for a second and a half."""
    items = list(items)
    begin = items[0].stamp_ns
    for item in items:
        if not (isinstance(item, LaserScan) and START_S <= (item.stamp_ns - begin) * 1e-9 < START_S + DEAD_S):
            yield item


def ranges_broken(items: Iterable[Item], start_s: float = START_S) -> Iterator[Item]:
    """Ten scans whose ranges are noise."""
    items = list(items)
    rng, broken = np.random.default_rng(0), 0
    for item in items:
        late = isinstance(item, LaserScan) and item.stamp_ns - items[0].stamp_ns >= start_s * 1e9
        if isinstance(item, LaserScan) and late and broken < BROKEN_SCANS:
            broken += 1
            noise = rng.uniform(0.5, 10.0, len(item.ranges)).astype(np.float32)
            yield replace(item, ranges=noise)
        else:
            yield item


def kidnapped(imu: bool) -> Iterator[Item]:
    """The drive up to START_S, then what it saw from the fourth second on: carried back, in no time."""
    items = drive(imu)
    begin, jump = items[0].stamp_ns, round((START_S - 4.0) * 1e9)
    yield from (item for item in items if item.stamp_ns - begin < START_S * 1e9)
    for item in items:
        if 4.0 <= (item.stamp_ns - begin) * 1e-9 < START_S - 1.0:
            yield replace(item, stamp_ns=item.stamp_ns + jump)


def run(items: Iterable[Item], check: bool) -> tuple[Pipeline, float]:
    """The pipeline after all of it, and its aligned error."""
    plain = with_value(with_value(SlamConfig(), "tracking.check", False), "map.keyframe_max_delay", 0.0)
    pipeline = Pipeline(Settings(SlamConfig() if check else plain))
    for item in items:
        for measurement in pipeline.admit(item):
            pipeline.step(measurement)
    for measurement in pipeline.flush():
        pipeline.step(measurement)
    error = evaluate(Trajectory.from_rows(pipeline.trajectory), Trajectory.from_rows(pipeline.truth))
    assert error is not None
    return pipeline, error.aligned


@pytest.mark.parametrize("fault", [scans_removed, ranges_broken])
def test_a_fault_without_inertial_data_loses_the_plain_match_and_not_the_checked_one(fault: Fault):
    """Plain ends far off; checked says that it was in trouble, comes back, and ends within 5 cm."""
    _, plain = run(fault(drive(False)), check=False)
    pipeline, checked = run(fault(drive(False)), check=True)
    assert plain > 0.2
    assert checked < 0.05
    assert pipeline.states["recovered"] >= 1
    assert pipeline.result is not None
    assert pipeline.result.tracking == "tracking"


def test_a_robot_that_was_lost_on_its_way_into_new_rooms_is_found():
    """The map explains less and less of its scans; no other place explains as much, so it is sure within 2 s."""
    items = drive(False)
    pipeline, error = run(ranges_broken(items, ENTERS_S), check=True)
    assert error < 0.05
    assert pipeline.states["recovered"] == 1
    assert pipeline.states["lost"] < 2 * SCANS_A_SECOND


@pytest.mark.parametrize(("imu", "lost"), [(True, 1), (False, SCANS_A_SECOND)])
def test_broken_scans_do_not_touch_the_map(imu: bool, lost: int):
    """Not one cell changes while the scans are noise, nor before the pose is confirmed again.

    Inertial data predicts it surely: few good scans do. Without, it takes a second, in which the map is searched.
    """
    pipeline = Pipeline(Settings(SlamConfig()))
    levels = pipeline.slam.map.levels
    for item in ranges_broken(drive(imu)):
        for measurement in pipeline.admit(item):
            before = [level.log_odds.copy() for level in levels] if _is_near(measurement, drive(imu)) else []
            result = pipeline.step(measurement)
            if result is not None and before and result.tracking in {"degraded", "lost"}:
                assert not result.map_updated
                assert all(np.array_equal(a, level.log_odds) for a, level in zip(before, levels, strict=True))
    assert pipeline.states["degraded"] == BROKEN_SCANS - 1 + (FEW - 1 if imu else 0)
    assert pipeline.states["lost"] == lost
    assert pipeline.states["recovered"] == 1


def _is_near(item: Item, items: tuple[Item, ...]) -> bool:
    return isinstance(item, LaserScan) and 0.0 <= (item.stamp_ns - items[0].stamp_ns) * 1e-9 - START_S < 0.6


@pytest.mark.parametrize(("imu", "within"), [(True, 4), (False, 7)])
def test_a_robot_that_was_carried_away_is_found_in_the_whole_map(imu: bool, within: int):
    """Put down metres away in a known room, it is sure of its place again in some seconds; else it stays away."""
    ends = {}
    for relocalise in (False, True):
        pipeline = Pipeline(Settings(with_value(SlamConfig(), "tracking.relocalise", relocalise)))
        for item in kidnapped(imu):
            for measurement in pipeline.admit(item):
                pipeline.step(measurement)
        there = pipeline.truth[-1, 1:3] - pipeline.truth[0, 1:3]
        ends[relocalise] = float(np.hypot(*(pipeline.trajectory[-1, 1:3] - there)))
    assert pipeline.states["degraded"] + pipeline.states["lost"] < within * SCANS_A_SECOND
    assert ends[False] > 1.0
    assert ends[True] < 0.1


def test_a_healthy_drive_is_never_doubted():
    """The same bytes of trajectory with and without the check, and no state but tracking."""
    plain, _ = run(drive(True), check=False)
    checked, _ = run(drive(True), check=True)
    assert checked.trajectory.tobytes() == plain.trajectory.tobytes()
    assert set(checked.states) == {"tracking"}


def test_the_same_fault_gives_the_same_trajectory():
    """Search and recovery are deterministic."""
    first, again = (run(scans_removed(drive(False)), check=True)[0].trajectory.tobytes() for _ in range(2))
    assert first == again


def test_somebody_who_walks_along_a_corridor_does_not_take_the_robot_with_them():
    """By the laser alone, five scans a second: a match half a metre from good predictions is no motion of a robot.

    Matches that followed a person made its estimate fly down the corridor at 6 m/s, and the map was written there.
    """
    scene = Simulation("offices", SceneOptions(seed=1, imu=False, scan_rate=4.7, beams=361))
    pipeline, results = Pipeline(Settings(SlamConfig())), []
    for item in takewhile(lambda item: item.stamp_ns < START_NS + 380e9, scene.items()):
        results += [pipeline.step(measurement) for measurement in pipeline.admit(item)]
    truth, covered = interpolate(Trajectory.from_rows(pipeline.truth), pipeline.trajectory[:, 0])
    ours = Trajectory.from_rows(pipeline.trajectory[covered])
    there = move(first_on_first(truth.planar, ours.planar), truth.planar)
    off = np.hypot(*(ours.planar - there)[:, :2].T)
    written = np.array([result.map_updated for result in results if result])[covered]
    assert off[written].max() < 0.2
    assert off.max() < 1.0
