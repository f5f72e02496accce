"""How well the pipeline does on recordings whose truth somebody else measured."""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.ensembles import follow, outcomes, varied
from hectorscope.inputs import SourceOptions, SourceReport
from hectorscope.run.headless import run_headless
from hectorscope.run.marks import marks
from hectorscope.run.metrics import metrics
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.series import SERIES_DTYPE
from hectorscope.run.settings import Settings
from hectorscope.sources import open_source
from slam_core.config import SlamConfig, with_value
from slam_core.diagnostics import REPEATED
from slam_core.measurements import LaserScan
from slam_core.results import MatchResult

pytestmark = pytest.mark.real

JACKAL = "jackal_vicon/test_2026-02-17-15-54-31"


def run(path: Path, config: SlamConfig | None = None, **options: Any) -> tuple[Pipeline, dict[str, Any]]:
    """The whole recording with the default configuration, and its metrics."""
    source = open_source(str(path), SourceOptions(**options))
    pipeline, effort = run_headless(source, Settings(config or SlamConfig()))
    return pipeline, metrics(pipeline, source.report, effort)


def test_jackal_is_within_two_centimetres_from_every_container(recordings: Path):
    """As .bag, sqlite3 and mcap: the same bytes of trajectory, at most 0.020 m from motion capture."""
    runs = [run(recordings / f"{JACKAL}{suffix}") for suffix in (".bag", "", "_mcap")]
    for _, figures in runs:
        assert figures["truth"]["aligned_rmse_m"] <= 0.020
    first, *others = (pipeline.trajectory.tobytes() for pipeline, _ in runs)
    assert all(other == first for other in others)


def test_jarvis_is_within_four_centimetres_with_its_mount(recordings: Path):
    """The mount from tf is used: at most 0.04 m from the reflector system."""
    _, figures = run(recordings / "jarvis_nav350/jarvis_circular_path_fast.bag")
    assert figures["truth"]["aligned_rmse_m"] <= 0.04


def test_ignoring_the_mount_of_jarvis_costs_accuracy(recordings: Path):
    """The same recording with the mount overridden by nothing is clearly worse, even after alignment."""
    bag = recordings / "jarvis_nav350/jarvis_circular_path_fast.bag"
    _, mounted = run(bag)
    _, bare = run(bag, laser_pose=(0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    assert bare["truth"]["aligned_rmse_m"] > 1.3 * mounted["truth"]["aligned_rmse_m"]


def test_kitchen_comes_back_near_its_start_with_its_imu_repaired(recordings: Path):
    """With units, handedness, delay and noise as they are 22 m of path end within 1 m of their begin.

    So they do by its laser alone, without the IMU.
    """
    path = recordings / "mumble_lidar_imu/kitchen_1"
    noisy = with_value(SlamConfig(), "navigation.accel_noise", 0.1)
    mended, figures = run(
        path, noisy, imu_accel_unit="mg", imu_gyro_unit="deg/s", scan_mirrored=True, scan_delay=0.11
    )
    bare, _ = run(path, SlamConfig(), imu_topic="none")
    ends = [float(np.hypot(*pipeline.trajectory[-1, 1:3])) for pipeline in (mended, bare)]
    assert max(ends) < 1.0
    assert figures["tracking"].get("lost", 0) == 0


@pytest.mark.parametrize("name", ["kitchen_1_mcap", "straight"])
def test_a_robot_on_a_floor_keeps_its_height_without_a_source(recordings: Path, name: str):
    """With the noise of the accelerometers as it is by default, which is too small for this sensor on wheels."""
    units = {"imu_accel_unit": "mg", "imu_gyro_unit": "deg/s", "scan_mirrored": True}
    pipeline, _ = run(recordings / "mumble_lidar_imu" / name, **units)
    assert np.abs(pipeline.trajectory[:, 3]).max() < 2.0


def test_mit_csail_is_one_map_with_its_odometry(recordings: Path):
    """Seven minutes at 4.7 Hz: never lost, and within 0.25 m of the poses that somebody's graph corrected."""
    folder = recordings / "mit_csail"
    _, figures = run(folder / "mit-csail.clf", truth_topic=str(folder / "csail-corrected.log.gz"))
    assert figures["scans"]["used"] == 1988
    assert "lost" not in figures["tracking"]
    assert figures["truth"]["poses"] > 900
    assert figures["truth"]["aligned_rmse_m"] <= 0.25


def test_a_small_laser_with_wheels_is_followed(recordings: Path):
    """The tinySLAM recording: 97 % of the scans are tracked, and the path is as long as the wheels say.

    Four scans came twice, and are used once.
    The way leads back onto the first map, which small errors of the long loop contradict for some scans.
    """
    pipeline, figures = run(recordings / "coreslam_urg" / "exp1.dat")
    assert sum(figures["tracking"].values()) == 756 - 4
    assert pipeline.skipped == {REPEATED: 4}
    assert figures["tracking"]["tracking"] >= 0.97 * 756
    path = float(np.hypot(*np.diff(pipeline.trajectory[:, 1:3], axis=0).T).sum())
    assert path == pytest.approx(46.0, rel=0.1)


def test_a_turn_that_the_wheels_do_not_show_is_found_by_the_scans(recordings: Path):
    """Where one scan in ten is missing, the robot turns by 17 degrees more than the wheels say between two scans.

    As it is, in two such variants, and in three that a search took to a place 1 m beside the way, the recording
    gives the same trajectory within 0.5 m.
    """
    items = list(open_source(str(recordings / "coreslam_urg" / "exp1.dat"), SourceOptions()).items())
    runs = [follow(varied(items, variant), SlamConfig(), items[0].stamp_ns) for variant in (1, 3, 6, 11, 42, 52)]
    assert max(outcome.error for outcome in outcomes(runs)) < 0.5


def test_a_plain_corridor_is_as_long_in_each_variant_of_hallway(recordings: Path):
    """With 3 mm of noise: within 0.6 m, half within 5 cm; else matches that scatter part some by over 1 m."""
    source = open_source(str(recordings / "hallway_rplidar/hallway.bag"), SourceOptions(scan_sweep=-0.0693))
    items = list(source.items())
    errors = {}
    for keeps in (True, False):
        config = with_value(SlamConfig(), "tracking.keep_speed", keeps)
        runs = [follow(varied(items, variant), config, items[0].stamp_ns) for variant in range(1, 9)]
        errors[keeps] = [outcome.error for outcome in outcomes(runs)]
    assert max(errors[True]) < 0.6 and np.median(errors[True]) < 0.05
    assert max(errors[False]) > 1.0


def test_a_stated_pose_ends_a_kept_speed(recordings: Path):
    """Somebody who puts the robot where it is, in the plain corridor, is followed by matches again."""
    source = open_source(str(recordings / "hallway_rplidar/hallway.bag"), SourceOptions(scan_sweep=-0.0693))
    pipeline = Pipeline(Settings(SlamConfig()))
    results = (pipeline.step(each) for item in source.items() for each in pipeline.admit(item))
    matches = (result.match for result in results if result and result.match)
    held = next(match for match in matches if match.leaves_direction)
    assert next(matches).leaves_direction
    pipeline.slam.reset_pose(held.gaussian._replace(covariance=np.diag([1e-4] * 3)))
    assert not next(matches).leaves_direction


def test_a_lost_robot_has_no_speed_to_keep(recordings: Path):
    """In the plain corridor its walls seem nearer from some scan on, and no match fits: the robot waits there."""
    source = open_source(str(recordings / "hallway_rplidar/hallway.bag"), SourceOptions(scan_sweep=-0.0693))
    pipeline, held, lost = Pipeline(Settings(SlamConfig())), 0, list[MatchResult]()
    for item in source.items():
        nearer = 0.6 if held > 3 else 1.0
        seen = replace(item, ranges=item.ranges * np.float32(nearer)) if isinstance(item, LaserScan) else item
        for result in filter(None, map(pipeline.step, pipeline.admit(seen))):
            if result.match:
                held += bool(result.match.leaves_direction)
                lost += [result.match] if result.verdict.state == "lost" else []
        if len(lost) == 10:
            break
    assert len(lost) == 10
    assert not any(match.leaves_direction for match in lost[1:])


def test_stabilisation_cleans_the_map_of_a_tilted_laser(recordings: Path):
    """With roll and pitch from tf the map has at least 15 % fewer occupied cells than without stabilisation.

    By cells alone, to see that by itself: surfels hold walls together even where scans are tilted.
    """
    bag = recordings / "ccny_tilted_handheld/demo_v2.bag"
    cells_alone = with_value(SlamConfig(), "matcher.surfel_weight", 0.0)
    _, level = run(bag, cells_alone)
    _, tilted = run(bag, with_value(cells_alone, "scan.stabilise", False))
    assert level["scans"]["used"] >= 0.99 * level["scans"]["read"]
    assert level["occupied_cells"] <= 0.85 * tilted["occupied_cells"]


def test_the_plain_corridor_of_hallway_is_marked(recordings: Path):
    """Where its variants part along the corridor, from second 21 on for five seconds, and nowhere else."""
    pipeline, _ = run(recordings / "hallway_rplidar/hallway.bag", scan_sweep=-0.0693)
    start_ns, series = pipeline.start_ns or 0, pipeline.series.view(SERIES_DTYPE).reshape(-1)
    found = marks(series, start_ns, pipeline.settings, SourceReport())
    (mark,) = (mark for mark in found if mark.kind == "weak")
    assert (mark.time_ns - start_ns) / 1e9 == pytest.approx(21.1, abs=0.5)
    assert re.match(
        r"few beams fix one direction for [45]\.\d s: at worst \d\.\d% of them, and for a time it counted as"
        " unobservable",
        mark.text,
    )
