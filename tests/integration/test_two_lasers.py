"""Two lasers on one topic, one to the right and one to the left, of which neither sees what the other does."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.additions.faults import two_lasers
from hectorscope.run.metrics import truth_errors
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from hectorscope.simulation import ScenarioName, SceneOptions, Simulation
from slam_core import geometry
from slam_core.measurements import Imu, LaserScan, Transform
from slam_core.results import StepResult
from slam_core.slam import HectorSlam


@pytest.mark.parametrize(
    ("scene", "imu", "metres"), [("rooms", False, 0.15), ("rooms", True, 0.05), ("handheld", True, 0.05)]
)
def test_both_lasers_are_tracked_from_the_first_scan_on(scene: ScenarioName, *, imu: bool, metres: float) -> None:
    """The second one begins its map where the first one has the robot; then each has keyframes of its own."""
    drive = Simulation(scene, SceneOptions(scan_rate=10.0, duration=40.0)).items()
    items = two_lasers([item for item in drive if imu or not isinstance(item, Imu)], 1)
    pipeline, results = Pipeline(Settings()), list[StepResult]()
    for item in items:
        results += [result for each in pipeline.admit(item) if (result := pipeline.step(each))]
    tracked = [result.tracking in ("tracking", "recovered") for result in results]
    assert all(tracked[:100])
    assert np.mean(tracked) > 0.97
    errors = truth_errors(pipeline.trajectory, pipeline.truth)
    assert errors is not None
    assert errors["aligned_rmse_m"] < metres


def test_a_second_laser_begins_no_map_where_the_pose_is_not_known() -> None:
    """After a second without any data nobody knows well enough where the second laser looks."""
    drive = Simulation("rooms", SceneOptions(scan_rate=10.0, duration=20.0)).items()
    scans = [item for item in two_lasers(list(drive), 1) if isinstance(item, LaserScan)]
    first, begin_ns = scans[0], scans[0].stamp_ns
    before = [s for s in scans if s.T_base_laser is first.T_base_laser and s.stamp_ns < begin_ns + 8_000_000_000]
    behind = [
        s for s in scans if s.T_base_laser is not first.T_base_laser and s.stamp_ns > begin_ns + 9_200_000_000
    ]
    slam = HectorSlam()
    assert all(result.tracking == "tracking" for scan in before for result in slam.add(scan))
    (found,) = [result for scan in behind[:1] for result in [*slam.add(scan), *slam.finish()]][-1:]
    assert found.tracking not in ("tracking", "recovered")


@pytest.mark.parametrize("share", [0.0, 1.0])
def test_a_laser_that_is_mounted_no_other_way_is_no_second_one(share: float) -> None:
    """A laser alone that suddenly sees nothing known is no laser that looks elsewhere; a second one is."""
    drive = Simulation("rooms", SceneOptions(scan_rate=10.0, duration=3.0)).items()
    scans = [item for item in two_lasers(list(drive), 1) if isinstance(item, LaserScan)]
    right, left = scans[0], scans[1]
    turned = geometry.multiply(
        right.T_base_laser.rotation,
        geometry.from_euler(0.0, 0.0, share * geometry.heading(left.T_base_laser.rotation)),
    )
    slam = HectorSlam()
    results = [
        *slam.add(right),
        *slam.add(replace(left, T_base_laser=Transform(right.T_base_laser.translation, turned))),
    ]
    found = [*results, *slam.finish()][-1]
    assert (found.tracking == "recovered") == (share == 1.0)
