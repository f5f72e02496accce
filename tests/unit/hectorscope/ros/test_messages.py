"""Single messages, of both generations."""

import math
from typing import Any

import numpy as np
import pytest

from hectorscope.ros import messages
from hectorscope.ros.messages import BadMessage
from slam_core import geometry
from slam_core.measurements import Transform
from tests.ros_messages import START, Messages

LEVEL = geometry.from_euler(0.0, 0.0, 0.0)
UPSIDE_DOWN = geometry.from_euler(math.pi, 0.0, 0.0)


@pytest.fixture(params=["ros1", "ros2"])
def ros(request: pytest.FixtureRequest) -> Messages:
    """Both generations."""
    return Messages(request.param)


def test_a_scan_keeps_its_numbers(ros: Messages) -> None:
    """Ranges with their special values, angles, timing, limits and mount arrive unchanged."""
    mount = Transform(np.array([0.2, 0.0, 0.1]))
    message = ros.scan(5, ranges=[1.0, math.inf, -math.inf, math.nan], angle_increment=-0.25)
    scan = messages.laser_scan(message, START + 5, mount)
    np.testing.assert_array_equal(scan.ranges, np.float32([1.0, math.inf, -math.inf, math.nan]))
    assert (scan.angle_min, scan.angle_increment, scan.time_increment) == (-0.5, -0.25, 0.001)
    assert (scan.range_min, scan.range_max, scan.T_base_laser) == (0.1, 30.0, mount)
    assert scan.end_ns - scan.stamp_ns == 3_000_000
    assert messages.sweep_ns(message) == 3_000_000


def test_the_ranges_do_not_hold_on_to_the_message(ros: Messages) -> None:
    """A scan that waits in a queue keeps its own floats, not the bytes of the whole message."""
    raw = ros.store.serialize_cdr(ros.scan(), "sensor_msgs/msg/LaserScan")
    message = ros.store.deserialize_cdr(raw, "sensor_msgs/msg/LaserScan")
    ranges = messages.laser_scan(message, 0, Transform()).ranges
    assert ranges.base is None
    assert ranges.flags.aligned


def test_zero_is_no_distance(ros: Messages) -> None:
    """Devices that announce range_min = 0 write 0 for "no return": the limit lies above it."""
    scan = messages.laser_scan(ros.scan(range_min=0.0, range_max=0.0), 0, Transform())
    assert 0.0 < scan.range_min < 0.01
    assert scan.range_max == math.inf


@pytest.mark.parametrize("value", [math.nan, -0.001, 100.0, 0.0])
def test_nonsense_in_time_increment_means_all_at_once(ros: Messages, value: float) -> None:
    """A sweep that would last minutes, or run backwards, is taken as instantaneous."""
    assert messages.laser_scan(ros.scan(time_increment=value), 0, Transform()).time_increment == 0.0


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"ranges": []}, "without beams"),
        ({"angle_min": math.nan}, "not a number"),
        ({"angle_increment": math.inf}, "not a number"),
        ({"angle_increment": 0.0}, "angle_increment of 0"),
        ({"angle_increment": -30.0}, "more than two turns"),
        ({"ranges": [math.nan, math.nan]}, "nothing but NaN"),
    ],
)
def test_an_unusable_scan_says_why(ros: Messages, changes: dict[str, Any], reason: str) -> None:
    """Each way to be unusable has its own words."""
    with pytest.raises(BadMessage, match=reason):
        messages.laser_scan(ros.scan(**changes), 0, Transform())


def test_an_imu_is_turned_into_base_axes(ros: Messages) -> None:
    """An IMU mounted upside down feels gravity on -z and turns about -z: in the base both are on +z."""
    message = ros.imu(rates=(0.1, 0.2, 0.3), forces=(1.0, 2.0, -9.8))
    imu = messages.imu(message, 7, UPSIDE_DOWN)
    np.testing.assert_allclose(imu.angular_velocity, [0.1, -0.2, -0.3], atol=1e-12)
    np.testing.assert_allclose(imu.linear_acceleration, [1.0, -2.0, 9.8], atol=1e-12)
    level = messages.imu(message, 7, LEVEL)
    np.testing.assert_array_equal(level.linear_acceleration, [1.0, 2.0, -9.8])


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"rates": (math.nan, 0.0, 0.0)}, "NaN"),
        ({"forces": (0.0, 0.0, math.inf)}, "NaN or infinite"),
        ({"absent": ("angular_velocity",)}, "absent"),
        ({"absent": ("linear_acceleration",)}, "absent"),
    ],
)
def test_an_unusable_imu_message_says_why(ros: Messages, changes: dict[str, Any], reason: str) -> None:
    """NaN and what the driver itself declares absent are refused."""
    with pytest.raises(BadMessage, match=reason):
        messages.imu(ros.imu(**changes), 0, LEVEL)


def test_an_orientation_is_that_of_the_base(ros: Messages) -> None:
    """The attitude of an IMU, less its mount, is the attitude of the base."""
    base = geometry.from_euler(0.2, -0.1, 1.0)
    w, x, y, z = geometry.multiply(base, UPSIDE_DOWN) * 3.0
    attitude = messages.imu_attitude(ros.imu(orientation=ros.quaternion(w, x, y, z)), 3, UPSIDE_DOWN)
    assert abs(attitude.rotation @ base) == pytest.approx(1.0)


def test_an_orientation_that_is_none_is_refused(ros: Messages) -> None:
    """Zero quaternions and a covariance that begins with -1 say that nobody estimates the orientation."""
    with pytest.raises(BadMessage, match="zero or NaN quaternion"):
        messages.imu_attitude(ros.imu(orientation=ros.quaternion(0.0)), 0, LEVEL)
    with pytest.raises(BadMessage, match="absent"):
        messages.imu_attitude(ros.imu(absent=("orientation",)), 0, LEVEL)


def test_odometry_is_the_twist(ros: Messages) -> None:
    """Forward, left and turn come from the twist; NaN is refused."""
    odometry = messages.odometry(ros.odometry(vx=0.5, vy=0.1, turn=0.2), 9)
    np.testing.assert_array_equal(odometry.velocity, [0.5, 0.1])
    assert odometry.yaw_rate == 0.2
    with pytest.raises(BadMessage):
        messages.odometry(ros.odometry(vx=math.nan), 9)


def test_pressure_falls_by_12_pascal_a_metre_at_sea_level(ros: Messages) -> None:
    """The barometric formula agrees with dp/dh = -rho g, within a percent."""
    low = messages.pressure_altitude(ros.pressure(0, 101325.0))
    high = messages.pressure_altitude(ros.pressure(0, 101325.0 - 1.225 * 9.80665 * 10.0))
    assert low == pytest.approx(0.0, abs=1e-9)
    assert high - low == pytest.approx(10.0, rel=0.01)
    with pytest.raises(BadMessage, match="positive"):
        messages.pressure_altitude(ros.pressure(0, 0.0))


def test_truth_comes_in_four_types(ros: Messages) -> None:
    """PoseStamped, PoseWithCovarianceStamped, Odometry and TransformStamped tell the same pose."""
    pose = ros.pose()
    covered = ros.make("geometry_msgs/msg/PoseWithCovariance", pose=pose, covariance=np.zeros(36))
    with_covariance = ros.make(
        "geometry_msgs/msg/PoseWithCovarianceStamped", header=ros.header(0, "map"), pose=covered
    )
    transform = ros.transform_stamped(0, "map", "base_link", (1.0, 2.0, 3.0))
    for message in (ros.pose_stamped(), with_covariance, ros.odometry(), transform):
        np.testing.assert_array_equal(messages.truth_pose(message, 1).T_map_base.translation, [1.0, 2.0, 3.0])
    with pytest.raises(BadMessage, match="quaternion"):
        messages.truth_pose(ros.pose_stamped(orientation=ros.quaternion(0.0)), 1)
    with pytest.raises(BadMessage, match=r"transform of more than 1e\+07 m"):
        messages.truth_pose(ros.transform_stamped(0, "map", "base_link", (1e200, 2.0, 3.0)), 1)


def test_a_stamp_of_zero_is_none(ros: Messages) -> None:
    """The time of receipt stands in for a stamp that nobody set."""
    assert messages.stamp_ns(ros.scan(7), 99) == START + 7
    assert messages.stamp_ns(ros.scan(None), 99) == 99


def test_frames_lose_the_slash_of_old_tf(ros: Messages) -> None:
    """/laser and laser are one frame."""
    assert messages.frame_id(ros.scan(frame="/laser")) == "laser"
