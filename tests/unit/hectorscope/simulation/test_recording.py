"""Simulations written as bags, read back by another library's reader."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

from hectorscope.ros import aid_messages
from hectorscope.ros.messages import pressure_altitude
from hectorscope.simulation import SceneOptions, SimulateOptions, Simulation, SimulationError, simulate
from hectorscope.simulation.aids import ORIGIN
from hectorscope.simulation.recording import pressure_at
from slam_core.errors import SlamError
from slam_core.measurements import (
    GpsPosition,
    GpsVelocity,
    GroundDistance,
    Imu,
    LaserScan,
    MagneticField,
    Transform,
    TruthPose,
)

EVERYTHING: dict[str, Any] = {"extras": ("gps", "compass", "rangefinder"), "gps_outage": 0.0}
NAMES = ("run.bag", "run.mcap", "run")


def written(folder: Path, name: str, **options: Any) -> Path:
    path = folder / name
    simulate(SimulateOptions(scenario="littoral", out=path, duration=3.0, **options))
    return path


def test_an_outage_needs_a_receiver(tmp_path: Path) -> None:
    """Of a scene that carries none it is refused, and nothing is written."""
    options = SimulateOptions(scenario="rooms", out=tmp_path / "run.bag", gps_outage=5.0)
    with pytest.raises(SimulationError, match="gps_outage is 5 s, but there is no receiver: add gps to extras"):
        simulate(options)
    assert not options.out.exists()


def contents(path: Path) -> dict[str, list[tuple[int, Any]]]:
    """Topic -> (time of receipt, message)."""
    found: dict[str, list[tuple[int, Any]]] = {}
    with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
        for connection, time_ns, raw in reader.messages():
            message = reader.deserialize(raw, connection.msgtype)
            found.setdefault(connection.topic, []).append((time_ns, message))
    return found


def stamp(message: Any) -> int:
    return message.header.stamp.sec * 10**9 + message.header.stamp.nanosec


@pytest.mark.parametrize("name", NAMES)
def test_a_bag_holds_what_was_measured(tmp_path: Path, name: str) -> None:
    """Every topic with its type, the numbers of the simulation, and times of receipt that never run backwards."""
    bag = contents(written(tmp_path, name, **EVERYTHING))
    assert {topic: (messages[0][1].__msgtype__, len(messages)) for topic, messages in bag.items()} == {
        "/tf_static": ("tf2_msgs/msg/TFMessage", 1),
        "/scan": ("sensor_msgs/msg/LaserScan", 120),
        "/imu/data_raw": ("sensor_msgs/msg/Imu", 301),
        "/pressure": ("sensor_msgs/msg/FluidPressure", 31),
        "/imu/mag": ("sensor_msgs/msg/MagneticField", 61),
        "/fix": ("sensor_msgs/msg/NavSatFix", 16),
        "/fix_velocity": ("geometry_msgs/msg/TwistWithCovarianceStamped", 16),
        "/range_down": ("sensor_msgs/msg/Range", 61),
        "/ground_truth": ("geometry_msgs/msg/PoseStamped", 301),
    }
    items = list(Simulation("littoral", SceneOptions(duration=3.0, **EVERYTHING)).items())
    scans = [item for item in items if isinstance(item, LaserScan)]
    for scan, (time_ns, message) in zip(scans, bag["/scan"], strict=True):
        assert stamp(message) == scan.stamp_ns < scan.end_ns < time_ns
        np.testing.assert_array_equal(message.ranges, scan.ranges)
        assert message.header.frame_id == "laser"
        assert message.time_increment == pytest.approx(scan.time_increment)
        assert message.angle_max == pytest.approx(np.radians(135))
    imus = [item for item in items if isinstance(item, Imu)]
    for imu, (_, message) in zip(imus, bag["/imu/data_raw"], strict=True):
        w = message.angular_velocity
        assert (w.x, w.y, w.z) == tuple(imu.angular_velocity)
        assert message.orientation_covariance[0] == -1
    poses = [item for item in items if isinstance(item, TruthPose)]
    for pose, (_, message) in zip(poses, bag["/ground_truth"], strict=True):
        q = message.pose.orientation
        assert (q.w, q.x, q.y, q.z) == tuple(pose.T_map_base.rotation)
    _compare_aids(items, bag)
    times = [time_ns for messages in bag.values() for time_ns, _ in messages]
    assert min(times) == bag["/tf_static"][0][0]


def _compare_aids(items: list[Any], bag: dict[str, list[tuple[int, Any]]]) -> None:
    """What comes out of the messages by the reader's own functions is what was measured."""
    fixes = [item for item in items if isinstance(item, GpsPosition)]
    for fix, (_, message) in zip(fixes, bag["/fix"], strict=True):
        read = aid_messages.gps_position(message, fix.stamp_ns, ORIGIN, fix.antenna)
        np.testing.assert_allclose(read.position, fix.position, atol=1e-4)
        np.testing.assert_allclose(read.covariance, fix.covariance)
    fields = [item.field for item in items if isinstance(item, MagneticField)]
    read_fields = [
        aid_messages.magnetic_field(message, 0, Transform().rotation).field for _, message in bag["/imu/mag"]
    ]
    np.testing.assert_array_equal(read_fields, fields)
    speeds = [item.velocity for item in items if isinstance(item, GpsVelocity)]
    read_speeds = [aid_messages.gps_velocity(message, 0).velocity for _, message in bag["/fix_velocity"]]
    np.testing.assert_array_equal(read_speeds, speeds)
    distances = [item.distance for item in items if isinstance(item, GroundDistance)]
    np.testing.assert_allclose([message.range for _, message in bag["/range_down"]], distances, rtol=1e-6)


def test_mounts(tmp_path: Path) -> None:
    """tf_static says where laser, inertial unit, antenna and rangefinder sit on the base."""
    ((_, message),) = contents(written(tmp_path, "run.bag", **EVERYTHING))["/tf_static"]
    laser, imu, gps, rangefinder = message.transforms
    assert (gps.child_frame_id, gps.transform.translation.z) == ("gps", 0.9)
    assert rangefinder.child_frame_id == "rangefinder"
    assert rangefinder.transform.rotation.y == pytest.approx(math.sqrt(0.5))
    assert (laser.header.frame_id, laser.child_frame_id) == ("base_link", "laser")
    assert (laser.transform.translation.x, laser.transform.translation.z) == (0.4, 0.7)
    assert (imu.child_frame_id, imu.transform.translation.x, imu.transform.rotation.w) == ("imu_link", 0.0, 1.0)


@pytest.mark.parametrize("name", NAMES)
def test_same_seed_same_bytes(tmp_path: Path, name: str) -> None:
    """Two recordings of one seed are the same files."""
    one, two = (written(tmp_path / folder, name, beams=61) for folder in ("one", "two"))
    files = [path.relative_to(one) for path in sorted(one.rglob("*"))] if one.is_dir() else [Path()]
    assert files
    for file in files:
        assert (one / file).read_bytes() == (two / file).read_bytes()


def test_pressure_is_height_by_the_barometric_formula(tmp_path: Path) -> None:
    """The reader's formula gives the height back to a millimetre; 8 m are about one hectopascal."""
    assert pressure_at(0.0) - pressure_at(8.0) == pytest.approx(100.0, rel=0.05)
    message = contents(written(tmp_path, "run.bag"))["/pressure"][0][1]
    for height in (-2.0, 0.0, 3.0, 100.0):
        message.fluid_pressure = pressure_at(height)
        assert pressure_altitude(message) == pytest.approx(height, abs=2e-3)


def test_progress(tmp_path: Path) -> None:
    """Progress rises to 1."""
    shares: list[float] = []
    simulate(SimulateOptions(scenario="rooms", out=tmp_path / "r.mcap", duration=3.0, beams=11), shares.append)
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
    assert len(shares) > 100


def test_what_exists_is_kept(tmp_path: Path) -> None:
    """A recording is never written over."""
    path = tmp_path / "kept.bag"
    path.write_bytes(b"precious")
    with pytest.raises(SlamError, match=r"kept\.bag exists: remove it"):
        written(tmp_path, "kept.bag")
    assert path.read_bytes() == b"precious"
