"""Recordings that begin while the robot drives: the map begins once its attitude and velocity are known."""

from collections.abc import Iterable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from benchmarks import ensembles
from hectorscope.inputs import Item
from hectorscope.run.checkpoints import Checkpoint, Place
from hectorscope.run.metrics import truth_errors
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from hectorscope.simulation import SceneOptions, Simulation
from slam_core.config import SlamConfig, with_value
from slam_core.diagnostics import NO_ATTITUDE
from slam_core.localization.prior_map import PriorMap, saved_levels
from slam_core.measurements import LaserScan

IN_A_TURN, AT_A_CONSTANT_VELOCITY = 6.25, 8.5
AT_ONCE = with_value(SlamConfig(), "navigation.start_in_motion", False)


@cache
def drive(begin: float, sway: float, rate: float) -> tuple[Item, ...]:
    """Twenty seconds in the rooms."""
    options = SceneOptions(
        begin=begin, duration=begin + 20.0, sway=sway, sway_frequency=1.2, scan_rate=rate, beams=541
    )
    return tuple(Simulation("rooms", options).items())


def run(items: Iterable[Item], config: SlamConfig, given: PriorMap | None = None) -> Pipeline:
    """All of them."""
    pipeline = Pipeline(Settings(config), prior_map=given)
    for measurement in [each for item in items for each in pipeline.admit(item)] + pipeline.flush():
        pipeline.step(measurement)
    return pipeline


def raw(pipeline: Pipeline) -> float:
    """Error of the positions, metres, the first pose laid on the truth."""
    errors = truth_errors(pipeline.trajectory, pipeline.truth)
    assert errors is not None
    return errors["raw_rmse_m"]


@pytest.mark.parametrize(
    ("begin", "sway", "rate", "goal", "first"),
    [
        (IN_A_TURN, 0.0, 10.0, 0.02, 3.4),
        (IN_A_TURN, 15.0, 10.0, 0.04, 6.1),
        (AT_A_CONSTANT_VELOCITY, 0.0, 5.0, 0.03, 3.5),  # of which inertial data show nothing
        (AT_A_CONSTANT_VELOCITY, 15.0, 20.0, 0.03, 5.4),
        (AT_A_CONSTANT_VELOCITY, 15.0, 5.0, 0.03, 8.7),
    ],
)
def test_the_whole_drive_fits_its_first_pose(
    begin: float, sway: float, rate: float, goal: float, first: float
) -> None:
    """A map that begins at once, by accelerometers that the motion misleads, is twice as bad or worse.

    A base that sways needs two seconds more than one that stays level, and 25 scans for the map of the run.
    """
    items = drive(begin, sway, rate)
    pipeline = run(items, SlamConfig())
    assert raw(pipeline) < min(goal, raw(run(items, AT_ONCE)) / 2.0)
    assert pipeline.trajectory[0, 0] == pytest.approx(first, abs=0.4)
    assert set(pipeline.skipped) == {NO_ATTITUDE}
    assert [
        f"the trajectory begins after {pipeline.trajectory[0, 0]:.1f} s" in note for note in pipeline.notes
    ] == [True]


def test_the_first_result_is_a_match_in_the_map_of_the_last_stage() -> None:
    """Its pose is as good as the others, as a map of two seconds is there."""
    pipeline = Pipeline(Settings(SlamConfig()))
    measurements = (each for item in drive(IN_A_TURN, 15.0, 10.0) for each in pipeline.admit(item))
    first = next(result for each in measurements if (result := pipeline.step(each)))
    assert first.index == 0
    assert first.match is not None
    assert first.match.fit.hit > 0.8
    assert first.match.fit.known > 0.8
    assert 0.1 < np.hypot(*first.fused.mean[:2]) < 3.0  # from where the stage began


def test_a_map_begins_in_the_end_though_scans_fit_no_map() -> None:
    """Every fifth scan is noise, so that no stage is confirmed: after eight seconds the map begins without it."""
    rng, scans = np.random.default_rng(1), 0
    items: list[Item] = []
    for item in drive(IN_A_TURN, 0.0, 10.0):
        if isinstance(item, LaserScan):
            scans += 1
            noise = rng.uniform(1.0, 9.0, len(item.ranges)).astype(np.float32)
            item = replace(item, ranges=noise) if scans % 5 == 0 else item  # noqa: PLW2901
        items.append(item)
    trajectory = run(items, SlamConfig()).trajectory
    assert 8.0 < trajectory[0, 0] < 10.5
    assert np.abs(trajectory[0, 1:4]).max() < 1e-3


@pytest.mark.parametrize("set_back_s", [1.0, 2.5])
def test_a_clock_that_is_set_back_meanwhile_delays_the_map_by_another_start(set_back_s: float) -> None:
    """By a hundred seconds, at some time of the start in motion: scans do not wait until it has caught up."""
    items = drive(IN_A_TURN, 0.0, 10.0)
    begin_ns = items[0].stamp_ns
    changed = [
        replace(item, stamp_ns=item.stamp_ns - 100 * 10**9)
        if item.stamp_ns - begin_ns > set_back_s * 1e9
        else item
        for item in items
    ]
    trajectory = run(changed, SlamConfig()).trajectory
    assert len(trajectory) > 100


def test_a_map_begins_at_once_where_the_robot_rests() -> None:
    """The levelling time is all that a run at rest waits for."""
    pipeline = run(drive(0.0, 0.0, 10.0)[:400], SlamConfig())
    assert pipeline.trajectory[0, 0] < 0.6
    assert not pipeline.notes


def test_nothing_is_waited_for_in_a_map_that_is_there() -> None:
    """Scans in a prior map are matched from the first attitude on."""
    items = drive(IN_A_TURN, 0.0, 10.0)
    first = run(items, AT_ONCE)
    given = PriorMap("rooms", saved_levels(first.slam.map), start=np.zeros(3))
    assert run(items[:400], SlamConfig(), given).trajectory[0, 0] < 0.6


def test_a_checkpoint_before_the_map_begins_goes_on_the_same() -> None:
    """The map that is given up and the one of the run are two."""
    items = drive(IN_A_TURN, 0.0, 10.0)
    straight, halves = Pipeline(Settings(SlamConfig())), Pipeline(Settings(SlamConfig()))
    for k, item in enumerate(items[:2000]):
        if item.stamp_ns - items[0].stamp_ns > 2_000_000_000 and not k % 100:
            halves = Checkpoint(halves, Place(0, None), None).pipeline(halves.settings)
        for pipeline in (straight, halves):
            for measurement in pipeline.admit(item):
                pipeline.step(measurement)
    assert straight.scans > 0
    assert straight.trajectory.tobytes() == halves.trajectory.tobytes()
    assert straight.slam.map.updates == halves.slam.map.updates


@pytest.mark.parametrize("name", ["handheld, no scans for 5 s from 0 s", "rooms, 2 Hz"])
def test_a_laser_may_begin_while_the_robot_drives(name: str) -> None:
    """Inertial data were there before: the map begins at their velocity, and not where they began."""
    found = ensembles.outcomes([ensembles.run(name, 2, {})])
    assert found[0].error < 0.02 and not (found[0].misplaced or found[0].silent)
