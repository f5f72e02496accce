"""Options that put right what a device gives."""

import math
import re
from collections.abc import Sequence

import numpy as np
import pytest

from hectorscope.inputs import Item, SourceError, SourceOptions
from hectorscope.ros.converter import Converter
from hectorscope.ros.roles import MAGNETIC, SCAN, Roles, Topic, choose_roles
from slam_core import geometry
from slam_core.measurements import Attitude, Imu, LaserScan, MagneticField
from tests.ros_messages import SECOND, START, Messages

ROS = Messages("ros2")
ROLES = Roles(scan="/scan", imu="/imu", attitude="/imu")


def convert(options: SourceOptions, rates: Sequence[float], forces: Sequence[float]) -> list[Item]:
    """An IMU message and a scan, both stamped at one second."""
    converter = Converter(ROLES, options)
    imu = ROS.imu(SECOND, rates=rates, forces=forces)
    items = converter.convert("/imu", imu.__msgtype__, imu, START + SECOND)
    return [*items, *converter.convert("/scan", SCAN, ROS.scan(SECOND), START + SECOND), *converter.flush()]


def test_units_become_si() -> None:
    """Milli-g and degrees a second, g, and what the message defines."""
    imu = convert(
        SourceOptions(imu_accel_unit="mg", imu_gyro_unit="deg/s"), (0.0, 0.0, 180.0), (0.0, 0.0, 1000.0)
    )[0]
    assert isinstance(imu, Imu)
    np.testing.assert_allclose(imu.angular_velocity, [0.0, 0.0, math.pi])
    np.testing.assert_allclose(imu.linear_acceleration, [0.0, 0.0, 9.80665])
    imu = convert(SourceOptions(imu_accel_unit="g", imu_gyro_unit="rad/s"), (0.0, 0.0, 1.0), (0.0, 0.0, 1.0))[0]
    assert isinstance(imu, Imu)
    np.testing.assert_allclose(imu.linear_acceleration, [0.0, 0.0, 9.80665])
    np.testing.assert_allclose(imu.angular_velocity, [0.0, 0.0, 1.0])


def test_an_imu_upside_down_is_turned() -> None:
    """--imu-rotation turns rates, accelerations and the orientation that the device estimates."""
    imu, attitude, _ = convert(SourceOptions(imu_rotation=(math.pi, 0.0, 0.0)), (0.1, 0.2, 0.3), (0.0, 1.0, -9.8))
    assert isinstance(imu, Imu)
    assert isinstance(attitude, Attitude)
    np.testing.assert_allclose(imu.angular_velocity, [0.1, -0.2, -0.3])
    np.testing.assert_allclose(imu.linear_acceleration, [0.0, -1.0, 9.8], atol=1e-12)
    assert abs(geometry.to_euler(attitude.rotation)[0]) == pytest.approx(math.pi)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (
            {"laser_pose": (math.nan, 0.0, 0.0, 0.0, 0.0, 0.0)},
            "--laser-pose is nan 0 0 0 0 0: give metres",
        ),
        (
            {"laser_pose": (0.0, 1e9, 0.0, 0.0, 0.0, 0.0)},
            "--laser-pose is 0 1e+09 0 0 0 0: give metres",
        ),
        (
            {"laser_pose": (0.0, 0.0, 0.0, math.inf, 0.0, 0.0)},
            "--laser-pose turns by inf 0 0: give radians",
        ),
        ({"laser_pose": (0.0, 0.0, 0.0, 0.0, 0.0, 90.0)}, "--laser-pose turns by 0 0 90: give radians"),
        ({"imu_rotation": (0.0, math.nan, 0.0)}, "--imu-rotation turns by 0 nan 0: give radians"),
    ],
)
def test_places_that_cannot_be_meant_are_refused(options: dict[str, tuple[float, ...]], words: str) -> None:
    """A laser beyond all robots would have its ends in cells whose number cannot be told."""
    with pytest.raises(SourceError, match=re.escape(words)):
        Converter(ROLES, SourceOptions(**options))  # type: ignore[arg-type]


def test_the_magnetometer_of_an_imu_upside_down_is_turned_with_it() -> None:
    """Its y and z point the other way."""
    converter = Converter(Roles(magnetic="/mag"), SourceOptions(imu_rotation=(math.pi, 0.0, 0.0)))
    (item,) = converter.convert("/mag", MAGNETIC, ROS.magnetic(SECOND, (2e-5, 1e-5, 4e-5)), START + SECOND)
    assert isinstance(item, MagneticField)
    np.testing.assert_allclose(item.field, [2e-5, -1e-5, -4e-5], atol=1e-12)


@pytest.mark.parametrize(("which", "signs"), [("accel", (1.0, -1.0)), ("gyro", (-1.0, 1.0))])
def test_one_vector_can_be_inverted(which: str, signs: tuple[float, float]) -> None:
    """--imu-inverted changes the sign of that vector alone."""
    imu = convert(SourceOptions(imu_inverted=which), (0.1, 0.2, 0.3), (0.0, 0.0, 9.8))[0]  # type: ignore[arg-type]
    assert isinstance(imu, Imu)
    np.testing.assert_allclose(imu.angular_velocity, signs[0] * np.array([0.1, 0.2, 0.3]))
    np.testing.assert_allclose(imu.linear_acceleration, [0.0, 0.0, signs[1] * 9.8])


def test_a_mirrored_scan_runs_the_other_way() -> None:
    """The angles change sign, the beams keep their order and their times."""
    scan = convert(SourceOptions(scan_mirrored=True), (0, 0, 0), (0, 0, 1))[-1]
    assert isinstance(scan, LaserScan)
    assert (scan.angle_min, scan.angle_increment, scan.time_increment) == (0.5, -0.5, 0.001)
    np.testing.assert_array_equal(scan.ranges, np.array([1.0, 2.0, 3.0], np.float32))


def test_delays_are_taken_off_the_stamps() -> None:
    """A stamp that is 0.2 s late becomes 0.2 s earlier, of the scans or of the IMU."""
    imu, attitude, scan = convert(SourceOptions(imu_delay=-0.05, scan_delay=0.2), (0, 0, 0), (0, 0, 1))
    assert imu.stamp_ns == attitude.stamp_ns == START + SECOND + SECOND // 20
    assert scan.stamp_ns == START + SECOND - SECOND // 5


@pytest.mark.parametrize("seconds", [5e9, math.nan, -math.inf])
def test_an_impossible_delay_is_refused(seconds: float) -> None:
    """The flag, its value and the range."""
    with pytest.raises(SourceError, match=r"--scan-delay is .* s: give -4e\+09 to 4e\+09"):
        Converter(ROLES, SourceOptions(scan_delay=seconds))


def test_a_sweep_in_another_unit_is_refused() -> None:
    """The flag, its value and the range."""
    with pytest.raises(SourceError, match=r"--scan-sweep is 75 s: give -10 to 10"):
        Converter(ROLES, SourceOptions(scan_sweep=75.0))


def test_a_clock_that_counts_from_its_start_is_put_beside_the_others() -> None:
    """By the difference that `inspect` states."""
    _, _, scan = convert(SourceOptions(scan_delay=START * 1e-9), (0, 0, 0), (0, 0, 1))
    assert abs(scan.stamp_ns - SECOND) < 1000


def test_a_part_can_be_left_out() -> None:
    """--imu-topic none: nothing plays the part, although there is an IMU."""
    topics = [Topic("/imu", "sensor_msgs/msg/Imu"), Topic("/scan", "sensor_msgs/msg/LaserScan")]
    assert choose_roles(topics, SourceOptions()).imu == "/imu"
    assert choose_roles(topics, SourceOptions(imu_topic="none")).imu is None


@pytest.mark.parametrize("seconds", [0.1, -0.1])
def test_a_stated_sweep_gives_each_beam_its_time(seconds: float) -> None:
    """It takes the place of time_increment, from the stamp on; a negative one begins with the last beam."""
    plain = convert(SourceOptions(), (0, 0, 0), (0, 0, 1))[-1]
    scan = convert(SourceOptions(scan_sweep=seconds), (0, 0, 0), (0, 0, 1))[-1]
    assert isinstance(plain, LaserScan)
    assert isinstance(scan, LaserScan)
    assert (scan.stamp_ns, scan.end_ns) == (plain.stamp_ns, plain.stamp_ns + SECOND // 10)
    angles = [each.angle_min + each.angle_increment * np.arange(len(each.ranges)) for each in (plain, scan)]
    order = slice(None, None, 1 if seconds > 0.0 else -1)
    np.testing.assert_allclose(angles[1][order], angles[0])
    np.testing.assert_array_equal(scan.ranges[order], plain.ranges)


def test_an_impossible_sweep_is_refused() -> None:
    """The flag, its value and the range."""
    with pytest.raises(SourceError, match=r"--scan-sweep is 100 s: give -10 to 10"):
        Converter(ROLES, SourceOptions(scan_sweep=100.0))
