"""Robots that wheels and a laser measure, and no IMU."""

import numpy as np
import pytest

from benchmarks.additions.cases import bare, drive, wheeled
from hectorscope.simulation import SceneOptions
from slam_core.evaluation.trajectory import Trajectory, first_on_first, interpolate, move
from slam_core.kernels.memory import CHECKED
from slam_core.measurements import LaserScan, Odometry, TruthPose
from slam_core.navigation.rejections import SLIPPED
from tests.cases import quick_first
from tests.ensemble import failures, items_of, outcomes, told

VARIANTS = range(1, 5)


@pytest.mark.parametrize("case", quick_first(["people, with wheels, 4 m", "rooms, with wheels, 4 m"]))
def test_a_laser_that_sees_four_metres_is_enough_with_wheels(case: str) -> None:
    """Where wheels weigh no more than another prediction, somebody who walks along drags the match off."""
    found, otherwise = (outcomes(case, VARIANTS, {"matcher.wheels_weight": weight}) for weight in (10.0, 0.0))
    assert sum(each.error for each in found) < 0.8 * sum(each.error for each in otherwise)
    assert failures(found) <= 1


@pytest.mark.parametrize("case", ["people, small robot with wheels", "people, small robot with wheels and IMU"])
def test_people_alone_in_sight_lead_no_robot_away(case: str) -> None:
    """A laser that sees 3.5 m in a hall of 20 m shows nothing else for ten seconds: the wheels tell the way.

    One of 40 robots with an IMU calls itself lost at the end, where it is. Checked kernels round otherwise: two of
    the first eight do.
    """
    has_imu = "IMU" in case
    found = outcomes(case, range(1, 9) if has_imu else VARIANTS, {})
    assert not any(each.misplaced or each.silent for each in found)
    assert sum(each.lost for each in found) <= has_imu * (2 if CHECKED else 1)
    assert max(each.error for each in found) < 0.5


def test_wheels_count_while_scans_wait() -> None:
    """At the start scans wait for inertial data that may come; the wheels of that time are theirs as well."""
    items = wheeled(bare(drive("rooms", SceneOptions(scan_rate=5.0, begin=4.0, duration=7.0))))(1)
    pipeline, _ = told([item for item in items if isinstance(item, LaserScan | Odometry | TruthPose)])
    ours = Trajectory.from_rows(pipeline.trajectory)
    reference, covered = interpolate(Trajectory.from_rows(pipeline.truth), ours.times)
    true = move(first_on_first(reference.planar, ours.planar[covered]), reference.planar)
    assert np.hypot(*(ours.planar[covered] - true)[:, :2].T).max() < 0.05
    assert np.hypot(*true[5, :2]) > 0.5


def test_somebody_who_walks_along_drags_no_match_off() -> None:
    """Wheels know better, so that a match far from their prediction leaves out the foreground."""
    assert not failures(outcomes("people, with wheels, 6 m", [1, 6], {}))


@pytest.mark.parametrize(
    "case", quick_first(["offices, wheels stuck for 2 s in 10", "offices, wheels that spin for 2 s in 10"])
)
def test_wheels_that_slip_are_no_better_than_the_scans(case: str) -> None:
    """Known walls contradict them."""
    assert not failures(outcomes(case, VARIANTS, {}))


def test_the_user_is_told_of_wheels_that_spin() -> None:
    """They are counted, and the faults of the sensors name them."""
    pipeline, faults = told(items_of("rooms, wheels that spin for 2 s in 10"))
    assert "wheels_slip" in faults
    assert pipeline.slam.status.unused[SLIPPED] > 50


def test_wheels_that_roll_are_used_all() -> None:
    """No fault is reported."""
    pipeline, faults = told(items_of("people, with wheels, 6 m"))
    assert not faults
    assert not pipeline.slam.status.unused[SLIPPED]
