"""Short drives through everything that the tables are made by."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from benchmarks.accuracy import along_and_across, corridor, drive, process, replay
from benchmarks.cases import METHODS, Recording
from benchmarks.returning import agreement
from hectorscope.run.map_image import MapImage
from hectorscope.simulation import SceneOptions, Simulation
from slam_core.measurements import LaserScan, Transform, TruthPose

SHORT = SceneOptions(duration=5.0, scan_rate=10.0, beams=271)


def moved(pose: TruthPose, x: float) -> TruthPose:
    there = Transform(pose.T_map_base.translation + np.array([x, 0.0, 0.0]), pose.T_map_base.rotation)
    return TruthPose(pose.stamp_ns, there)


def test_a_short_drive_is_followed_by_both_methods() -> None:
    """Five seconds through the rooms, with and without inertial data: all within 10 cm, none the same."""
    outcomes = drive(SHORT, seed=1)
    assert set(outcomes) == {(method, imu) for method in METHODS for imu in (True, False)}
    assert all(0.0 < each.aligned <= each.raw < 0.1 for each in outcomes.values())
    assert len({each.raw for each in outcomes.values()}) == 4


def test_seeds_differ_and_repeat() -> None:
    """The same seed gives the same figures, another one others."""
    assert drive(SHORT, seed=1) == drive(SHORT, seed=1) != drive(SHORT, seed=2)


def test_a_corridor_is_scored_along_and_across() -> None:
    """Across, the walls leave no doubt; the claim and the share that it holds are figures of the same run."""
    outcomes = corridor(replace(SHORT, duration=6.0), seed=1)
    for outcome in outcomes.values():
        assert outcome.across < 0.05
        assert outcome.sigma_end > 0.0
        assert 0.0 <= outcome.held <= 1.0
    assert outcomes["full"].held_open == outcomes["full, with wheels"].held_open == 1.0
    assert outcomes["full"].along < 0.3 < 1.0 < outcomes["paper"].along
    assert outcomes["full, with wheels"].along < 0.1


def test_an_error_along_shows_as_such() -> None:
    """A truth that is two metres further along x at the end is two metres along and none across."""
    items = list(Simulation("rooms", replace(SHORT, duration=3.0)).items())
    true = process(items, METHODS["full"])
    further = [moved(item, 2.0) if isinstance(item, TruthPose) else item for item in items]
    off = along_and_across(process(further, METHODS["full"]))
    assert off.along_end == pytest.approx(2.0, abs=0.1)
    assert off.across == pytest.approx(along_and_across(true).across)
    assert off.held == 0.0


def test_a_recording_without_truth_is_measured_from_start_to_end(recordings) -> None:
    """No errors, but how far the last pose is from the first, in every scan of the recording."""
    hallway = Recording("hallway", recordings / "hallway_rplidar" / "eng403_good.bag")
    for outcome in replay(hallway).values():
        assert outcome.truth is None
        assert outcome.scans == 487
        assert 0.0 < outcome.start_to_end < 1.0
        assert outcome.returned is not None
        assert outcome.returned > 0.95


def test_doubled_walls_show_where_a_run_comes_back() -> None:
    """Points on the walls agree, points a quarter of a metre beside them do not, points elsewhere do not count."""
    cells = np.ones((40, 40), np.uint8)
    cells[:, 20] = 2
    image = MapImage(0, 0.05, 0.0, 0.0, cells, 0)

    def scan(x: float) -> Any:
        points = np.column_stack([np.full(30, x), np.linspace(0.1, 1.9, 30)]).astype(np.float32)
        return SimpleNamespace(planar=np.zeros(3), points=points)

    assert agreement(image, [scan(1.02)]) == 1.0
    assert agreement(image, [scan(1.27)]) == 0.0
    assert agreement(image, [scan(1.02), scan(9.0)]) == 1.0
    assert agreement(image, [scan(9.0)]) is None


def test_items_are_scans_of_the_drive() -> None:
    """What goes through the pipeline is what the simulation holds: a pose for each scan once it is level."""
    items = list(Simulation("rooms", SHORT).items())
    scans = sum(isinstance(item, LaserScan) for item in items)
    assert scans - 6 <= process(items, METHODS["full"]).scans <= scans
