"""Recordings that others made, in every container, with every peculiarity."""

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hectorscope.checks.findings import remedy
from hectorscope.checks.inspect import inspect_bag
from hectorscope.checks.sensor_check import CheckedSource, SensorError
from hectorscope.inputs import Item, Source, SourceOptions
from hectorscope.sources import open_source
from slam_core import geometry
from slam_core.measurements import Attitude, LaserScan, Odometry, TruthPose

pytestmark = pytest.mark.real

JACKAL = "jackal_vicon/test_2026-02-17-15-54-31"
JARVIS = "jarvis_nav350/jarvis_circular_path_fast.bag"


def open_recording(path: Path, **options: Any) -> Source:
    return open_source(str(path), SourceOptions(**options))


def first_scan(items: list[Item]) -> LaserScan:
    return next(item for item in items if isinstance(item, LaserScan))


def content(source: Source) -> list[tuple[Any, ...]]:
    """Every number of every item, as bytes."""
    out: list[tuple[Any, ...]] = []
    for item in source.items():
        if isinstance(item, LaserScan):
            out.append(
                (item.stamp_ns, item.ranges.tobytes(), item.angle_min, item.angle_increment, item.range_max)
            )
        elif isinstance(item, TruthPose):
            pose = item.T_map_base
            out.append((item.stamp_ns, pose.translation.tobytes(), pose.rotation.tobytes()))
    return out


def test_three_containers_hold_one_run(recordings: Path) -> None:
    """The same measurements come from the .bag, the sqlite3 folder, the mcap folder and the bare files."""
    bag = content(open_recording(recordings / f"{JACKAL}.bag"))
    assert len(bag) == 414 + 4734
    bare = [next((recordings / JACKAL).glob("*.db3")), next((recordings / f"{JACKAL}_mcap").glob("*.mcap"))]
    for other in (recordings / JACKAL, recordings / f"{JACKAL}_mcap", *bare):
        assert content(open_recording(other)) == bag


@pytest.mark.parametrize("suffix", ["bag", "mcap"])
def test_half_a_file_gives_nearly_half_the_run(recordings: Path, tmp_path: Path, suffix: str) -> None:
    """A recording cut in the middle is read up to there, with a warning."""
    whole = recordings / f"{JACKAL}.bag"
    if suffix == "mcap":
        whole = next((recordings / f"{JACKAL}_mcap").glob("*.mcap"))
    data = whole.read_bytes()
    (tmp_path / f"half.{suffix}").write_bytes(data[: len(data) // 2])
    source = open_recording(tmp_path / f"half.{suffix}")
    kinds = Counter(type(item) for item in source.items())
    assert kinds[LaserScan] >= (200 if suffix == "bag" else 100)
    assert "cut off or damaged" in source.report.notes[0]


def test_jarvis_has_its_laser_where_tf_says(recordings: Path) -> None:
    """Of two scanners the one with more beams is chosen, and both mounts come from /tf."""
    source = open_recording(recordings / JARVIS)
    items = list(source.items())
    assert len(first_scan(items).ranges) == 1440
    np.testing.assert_allclose(first_scan(items).T_base_laser.translation, [0.194, 0.0, 2.0], atol=1e-3)
    assert Counter(type(item) for item in items) == {LaserScan: 204, TruthPose: 204}
    assert any("--scan-topic takes another" in note for note in source.report.notes)
    other = open_recording(recordings / JARVIS, scan_topic="driver_laser_security/laser_scan")
    scan = first_scan(list(other.items()))
    assert len(scan.ranges) == 761
    np.testing.assert_allclose(scan.T_base_laser.translation, [0.895, 0.0, 0.1], atol=1e-3)


def test_turtlebot4_needs_no_definitions(recordings: Path) -> None:
    """Scan, odometry and the turned mount from /tf_static come out of a bag that describes no type."""
    source = open_recording(recordings / "turtlebot4_rosbag2" / "macfirst_floor_take_2")
    items = list(source.items())
    kinds = Counter(type(item) for item in items)
    assert (kinds[LaserScan], kinds[Odometry]) == (357, 920)
    assert geometry.heading(first_scan(items).T_base_laser.rotation) == pytest.approx(np.pi / 2, abs=1e-3)
    assert not source.report.skipped


@pytest.mark.parametrize(
    "name", [*(pytest.param(name, marks=pytest.mark.slow) for name in ("kitchen_1", "kitchen_1_mcap")), "straight"]
)
def test_mumble_gives_milli_g_and_degrees_and_mirrors_its_scan(recordings: Path, name: str) -> None:
    """Found in the data, with or without definitions in the bag; refused with flags that leave nothing to find."""
    path = recordings / "mumble_lidar_imu" / name
    report = inspect_bag(path, SourceOptions())
    flags = "--imu-accel-unit mg --imu-gyro-unit deg/s --scan-mirrored true"
    assert remedy(report.findings).startswith(flags)
    with pytest.raises(SensorError, match=flags):
        CheckedSource(lambda options: open_source(str(path), options), SourceOptions()).check()
    late = 0.11 if "kitchen" in name else None
    options = SourceOptions(imu_accel_unit="mg", imu_gyro_unit="deg/s", scan_mirrored=True, scan_delay=late)
    repaired = inspect_bag(path, options)
    assert repaired.findings == ()
    assert repaired.measures.turn is not None
    assert repaired.measures.turn.ratio == pytest.approx(1.0, abs=0.1)
    assert repaired.measures.gravity is not None
    assert repaired.measures.gravity.norm == pytest.approx(9.7, abs=0.1)


def test_kitchen_is_scanned_a_tenth_of_a_second_late(recordings: Path) -> None:
    """Its stamps are those of publishing; a laser that is matched alone tells the delay within 40 ms."""
    report = inspect_bag(recordings / "mumble_lidar_imu" / "kitchen_1", SourceOptions())
    flag, seconds = report.findings[-1].repair.split()
    assert flag == "--scan-delay"
    assert float(seconds) == pytest.approx(0.1, abs=0.04)


def test_an_imu_at_rest_shows_its_unit_alone(recordings: Path) -> None:
    """A static recording without a laser: milli-g, and no word on the gyroscope."""
    report = inspect_bag(recordings / "mumble_lidar_imu" / "static_imu_test2", SourceOptions())
    assert remedy(report.findings) == "--imu-accel-unit mg"
    assert report.measures.turn is report.measures.tilt is None


@pytest.mark.parametrize(
    ("name", "flags"),
    [("phidgets_imu_upside_down", "--imu-rotation 3.1416 0 0"), ("ardrone_imu", ""), ("sparkfun_razor", "")],
)
def test_of_three_devices_the_one_upside_down_is_found(recordings: Path, name: str, flags: str) -> None:
    """Two are waved about by hand and keep to their messages; the third hangs."""
    report = inspect_bag(recordings / "imu_only" / f"{name}.bag", SourceOptions())
    assert remedy(report.findings) == flags
    if flags:
        turned = inspect_bag(
            recordings / "imu_only" / f"{name}.bag", SourceOptions(imu_rotation=(3.1416, 0.0, 0.0))
        )
        assert turned.findings == ()
        assert turned.measures.gravity is not None
        assert turned.measures.gravity.up[2] > 0.99


@pytest.mark.parametrize(
    "name",
    [
        f"{JACKAL}.bag",
        JARVIS,
        "ccny_tilted_handheld/demo_v2.bag",
        "hallway_rplidar/eng403_good.bag",
        "stage_sim_gt/run1_fixed.bag",
        "turtlebot4_rosbag2/macfirst_floor_take_2",
        "utm30lx_static_40hz/hokuyo.bag",
    ],
)
def test_devices_that_keep_to_their_messages_are_taken(recordings: Path, name: str) -> None:
    """Nobody is doubted who tells the truth; the wheels of the turtlebot turn as its scans do."""
    rplidars = {"turtlebot4_rosbag2/macfirst_floor_take_2": -0.1336, "hallway_rplidar/eng403_good.bag": -0.0693}
    stated = SourceOptions(scan_sweep=rplidars.get(name))
    source = CheckedSource(lambda options: open_source(str(recordings / name), options), stated)
    source.check()
    assert not source.report.findings
    if "turtlebot4" in name:
        wheels = inspect_bag(recordings / name, stated).measures.wheels
        assert wheels is not None
        assert wheels.correlation > 0.98
        assert wheels.ratio == pytest.approx(1.0, abs=0.05)


def test_ccny_leans_by_its_tf(recordings: Path) -> None:
    """Without an IMU topic the attitude comes from /tf, with the roll and pitch that are known."""
    source = open_recording(recordings / "ccny_tilted_handheld" / "demo_v2.bag")
    items = list(source.items())
    angles = np.degrees([geometry.to_euler(item.rotation)[:2] for item in items if isinstance(item, Attitude)])
    assert len(angles) == 1680
    np.testing.assert_allclose(angles.min(axis=0), [-16.7, -14.6], atol=0.1)
    np.testing.assert_allclose(angles.max(axis=0), [21.1, 18.2], atol=0.1)
    np.testing.assert_allclose(first_scan(items).T_base_laser.translation, [0.05, 0.0, 0.15])
    asked = open_recording(recordings / "ccny_tilted_handheld" / "demo_v2.bag", attitude_topic="tf:odom>base_link")
    assert sum(isinstance(item, Attitude) for item in asked.items()) == 1680


def test_hallway_has_a_topic_without_a_slash(recordings: Path) -> None:
    """`scan` is found by itself and as /scan."""
    path = recordings / "hallway_rplidar" / "hallway.bag"
    for options in ({}, {"scan_topic": "/scan"}):
        assert sum(isinstance(item, LaserScan) for item in open_recording(path, **options).items()) == 881


def test_stage_has_its_truth_on_tf(recordings: Path) -> None:
    """tf:map>base_link gives the simulator's poses as truth."""
    source = open_recording(recordings / "stage_sim_gt" / "run1_fixed.bag", truth_topic="tf:map>base_link")
    kinds = Counter(type(item) for item in source.items())
    assert kinds == {LaserScan: 1838, TruthPose: 1837}


@pytest.mark.parametrize("name", ["ccny_handheld/demo_initial_commit.bag", "utm30lx_static_40hz/hokuyo.bag"])
def test_a_laser_alone_is_enough(recordings: Path, name: str) -> None:
    """Nothing but scans: all of them are used, with their timing."""
    source = open_recording(recordings / name)
    items = list(source.items())
    assert {type(item) for item in items} == {LaserScan}
    assert first_scan(items).time_increment > 0.0
    assert not source.report.skipped


@pytest.mark.parametrize(("name", "late"), [(f"{JACKAL}.bag", 0.04), (JARVIS, 0.13)])
def test_inspect_tells_how_late_scans_are_against_the_truth(recordings: Path, name: str, late: float) -> None:
    """By the turns of both. Those of jackal_vicon have no beam timing, and fit none better than all at once."""
    report = inspect_bag(recordings / name, SourceOptions())
    truth = report.measures.truth
    assert truth is not None
    assert truth.lag == pytest.approx(late, abs=0.02)
    assert truth.ratio == pytest.approx(1.0, abs=0.05)
    assert "truth against the scans" in str(report)
    assert ("the scans fit best as if each was taken at once" in str(report)) == (name != JARVIS)


def test_inspect_needs_no_laser(recordings: Path) -> None:
    """A bag of inertial data alone is described: rate, longest gap, and that nothing plays the scan."""
    report = inspect_bag(recordings / "imu_only" / "ardrone_imu.bag", SourceOptions())
    imu = next(part for part in report.parts if part.role == "imu")
    assert (imu.topic, imu.measurements) == ("/ardrone/imu", 4308)
    line = next(line for line in report.topics if line.name == "/ardrone/imu")
    assert line.rate_hz == pytest.approx(46.6, abs=0.1)
    assert line.longest_gap_s == pytest.approx(1.0, abs=0.01)
    assert next(part for part in report.parts if part.role == "scan").topic is None


@pytest.mark.parametrize(
    ("name", "seconds"),
    [
        ("hallway_rplidar/hallway.bag", -0.07),
        ("hallway_rplidar/eng403_good.bag", -0.07),
        ("turtlebot4_rosbag2/macfirst_floor_take_2", -0.13),
        ("jarvis_nav350/jarvis_circular_path_fast.bag", None),
        ("ccny_handheld/demo_initial_commit.bag", None),
        ("ccny_tilted_handheld/demo_v2.bag", None),
        ("coreslam_urg/exp1.dat", None),
        ("mit_csail/mit-csail.clf", None),
        (f"{JACKAL}.bag", None),
    ],
)
def test_rplidars_give_their_last_beam_first(recordings: Path, name: str, seconds: float | None) -> None:
    """Their driver turns the ranges round; the order is found for each of them, and no sweep for another laser."""
    named = {
        key: value
        for found in inspect_bag(recordings / name, SourceOptions()).findings
        for key, value in found.options.items()
    }
    assert named.get("scan_sweep") == (None if seconds is None else pytest.approx(seconds, abs=0.005))
