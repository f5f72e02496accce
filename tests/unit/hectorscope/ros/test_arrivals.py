"""Messages stamped by several clocks, as the converter hands them out."""

from typing import Any

import numpy as np
import pytest

from hectorscope.inputs import Item, SourceOptions
from hectorscope.ros.converter import Converter
from hectorscope.ros.roles import Roles
from slam_core.measurements import Imu, LaserScan
from tests.ros_messages import SECOND, START, Messages, feed

ROS = Messages("ros2")
TF = ("/tf", "/tf_static")


def test_messages_wait_for_the_first_scan_and_come_in_order() -> None:
    """It may be by another clock than they are."""
    converter = Converter(Roles(scan="/scan", imu="/imu", transforms=TF), SourceOptions())
    mounts = [("/tf_static", ROS.tf(0, "base_link", frame, (0.0, 0.0, 0.1)), 0) for frame in ("laser", "imu")]
    assert not feed(
        converter, [*mounts, ("/imu", ROS.imu(1, frame="imu"), 1), ("/imu", ROS.imu(2, frame="imu"), 2)]
    )
    items = feed(converter, [("/scan", ROS.scan(3), 3), ("/imu", ROS.imu(4, frame="imu"), 4)])
    assert [item.stamp_ns - START for item in items] == [1, 2, 3, 4]


def by_clocks(scan_s: float, imu_s: float, tf_s: float, **options: Any) -> tuple[Converter, list[Item]]:
    """A laser on a mast that rises by 0.1 m/s, and an IMU: their clocks are so far behind the recorder."""
    converter = Converter(Roles(scan="/scan", imu="/imu", transforms=TF), SourceOptions(**options))
    entries = []
    for k in range(400):
        ns = k * SECOND // 100
        scan, imu, tf = (ns - round(seconds * SECOND) for seconds in (scan_s, imu_s, tf_s))
        entries.append(("/tf", ROS.tf(tf, "base_link", "laser", (0.0, 0.0, 1e-3 * k)), ns))
        entries.append(("/imu", ROS.imu(imu, frame="base_link"), ns))
        if k % 10 == 0:
            entries.append(("/scan", ROS.scan(scan), ns))
    return converter, [*feed(converter, entries), *converter.flush()]


@pytest.mark.parametrize("apart", [(0.0, 30.0, 0.0), (-30.0, 0.0, 0.0), (0.0, 0.0, 1e5), (1.6999e9, 1.0, 1e3)])
def test_stamps_are_by_the_clock_of_the_scans(apart: tuple[float, float, float]) -> None:
    """Those of an IMU, and of the transforms that place the laser."""
    converter, items = by_clocks(*apart)
    begin_ns = START - round(apart[0] * SECOND)
    imus = [item for item in items if isinstance(item, Imu)]
    assert len(imus) == 400
    np.testing.assert_allclose([imu.stamp_ns - begin_ns for imu in imus], np.arange(400) * 1e7, atol=5e6)
    heights = [scan.T_base_laser.translation[2] for scan in items if isinstance(scan, LaserScan)]
    np.testing.assert_allclose(heights[1:], 0.01 * np.arange(1, 40), atol=1e-3)
    assert all("that of the scans: stamps are put right" in warning for warning in converter.report.warnings)


def test_clocks_that_are_apart_are_named_together() -> None:
    """One sentence for those that agree, in seconds or days."""
    converter, _ = by_clocks(30.0, 0.0, 0.0)
    (warning,) = converter.report.warnings
    assert warning.startswith("the clock of /tf laser, /imu is 30.00 s ahead of that of the scans:")
    assert converter.put_right == ("/tf laser", "/imu")
    converter, _ = by_clocks(0.0, 864e5, 6.0)
    assert [warning.split(":")[0] for warning in converter.report.warnings] == [
        "the clock of /tf laser is 6.00 s behind that of the scans",
        "the clock of /imu is 1000 days behind that of the scans",
    ]


def test_transforms_may_be_stamped_ahead() -> None:
    """By as long as their publisher lets them hold."""
    assert not by_clocks(0.0, 0.0, -2.0)[0].report.warnings


def test_a_delay_that_is_stated_is_not_put_right_twice() -> None:
    """Neither where it is right, nor where the rest is less than clocks are apart."""
    for stated in (30.0, 30.3):
        converter, items = by_clocks(0.0, -30.0, 0.0, imu_delay=stated)
        first = next(item for item in items if isinstance(item, Imu))
        assert first.stamp_ns - START == pytest.approx((30.0 - stated) * SECOND, abs=1e3)
        assert not converter.report.warnings
    assert not by_clocks(-30.0, 0.0, 0.0, scan_delay=30.0)[0].report.warnings
