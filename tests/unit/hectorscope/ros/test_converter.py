"""A stream of messages to a stream of measurements."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from hectorscope.inputs import Item, SourceError, SourceOptions
from hectorscope.ros.converter import Converter
from hectorscope.ros.roles import Roles
from slam_core import geometry
from slam_core.measurements import (
    Attitude,
    GpsPosition,
    GpsVelocity,
    GroundDistance,
    Height,
    Imu,
    LaserScan,
    MagneticField,
    TruthPose,
)
from tests.ros_messages import SECOND, START, Messages, feed

ROS = Messages("ros2")
TENTH = SECOND // 10
TF = ("/tf", "/tf_static")


def scans(items: Sequence[Item]) -> list[LaserScan]:
    return [item for item in items if isinstance(item, LaserScan)]


def test_without_tf_nothing_waits_and_the_assumption_is_told() -> None:
    """A bag with a laser alone: the laser is the base, at once, and the report says so."""
    converter = Converter(Roles(scan="/scan"), SourceOptions())
    items = feed(converter, [("/scan", ROS.scan(0), 0)])
    np.testing.assert_array_equal(scans(items)[0].T_base_laser.translation, np.zeros(3))
    assert converter.report.read == {"/scan": 1}
    assert converter.report.notes == ("no tf for laser: taken to be at the base (--laser-pose places a laser)",)


def test_topics_without_a_part_give_nothing() -> None:
    """They are neither converted nor counted."""
    converter = Converter(Roles(scan="/scan"), SourceOptions())
    assert not feed(converter, [("/camera", ROS.scan(0), 0), ("/scan", ROS.imu(0), 0)])
    assert not converter.report.read


def test_scans_wait_for_their_mount_and_keep_their_order() -> None:
    """Messages that come before tf are placed by it when it comes, in the order in which they came."""
    roles = Roles(scan="/scan", imu="/imu", transforms=TF)
    converter = Converter(roles, SourceOptions())
    early = [("/scan", ROS.scan(0), 0), ("/imu", ROS.imu(1, "base_link"), 1), ("/scan", ROS.scan(TENTH), TENTH)]
    assert not feed(converter, early)
    tf = ROS.tf(0, "base_link", "laser", (0.2, 0.0, 0.1))
    items = feed(converter, [("/tf_static", tf, TENTH + 1)])
    assert [type(item) for item in items] == [LaserScan, Imu, LaserScan]
    np.testing.assert_array_equal(scans(items)[0].T_base_laser.translation, [0.2, 0.0, 0.1])
    assert converter.mounts.base == "base_link"


def test_after_a_second_without_a_mount_the_run_goes_on() -> None:
    """A tf that never names the laser does not hold the scans for ever; the end of a recording ends it too."""
    converter = Converter(Roles(scan="/scan", transforms=TF), SourceOptions())
    entries = [("/scan", ROS.scan(i * TENTH), i * TENTH) for i in range(12)]
    entries.insert(1, ("/tf", ROS.tf(0, "odom", "base_link"), 1))
    assert len(scans(feed(converter, entries))) == 12
    converter = Converter(Roles(scan="/scan", transforms=TF), SourceOptions())
    assert not feed(converter, [("/scan", ROS.scan(0), 0)])
    assert len(converter.flush()) == 1


def test_a_laser_that_tf_does_not_know_sits_on_the_base() -> None:
    """A nameless frame beside a tree with base_link: the scans are used, and the tree keeps its base."""
    converter = Converter(Roles(scan="/scan", transforms=TF), SourceOptions())
    tf = ("/tf", ROS.tf(0, "odom", "base_link"), 0)
    items = [*feed(converter, [tf, ("/scan", ROS.scan(0, frame=""), 0)]), *converter.flush()]
    np.testing.assert_array_equal(scans(items)[0].T_base_laser.translation, np.zeros(3))
    assert converter.mounts.base == "base_link"
    assert any(note.startswith("no tf for a sensor without a frame") for note in converter.report.notes)


def test_a_base_by_another_name_is_the_top_of_what_is_fixed() -> None:
    """Without base_link the frame that carries the laser is the base, but never one that stands in the world."""
    converter = Converter(Roles(scan="/scan", transforms=TF), SourceOptions())
    entries = [
        ("/tf_static", ROS.tf(0, "odom", "chassis", (9.0, 0.0, 0.0)), 0),
        ("/tf_static", ROS.tf(0, "chassis", "mast", (0.1, 0.0, 0.0)), 0),
        ("/tf_static", ROS.tf(0, "mast", "laser", (0.0, 0.0, 0.5)), 0),
        ("/scan", ROS.scan(0), 0),
    ]
    items = [*feed(converter, entries), *converter.flush()]
    np.testing.assert_allclose(scans(items)[0].T_base_laser.translation, [0.1, 0.0, 0.5])
    assert converter.mounts.base == "chassis"


def test_the_base_and_the_laser_can_be_told() -> None:
    """--base-frame picks the frame, --laser-pose needs no tf at all; an unknown base lists the frames."""
    tf = [
        ("/tf_static", ROS.tf(0, "base_link", "mast", (0.1, 0.0, 0.0)), 0),
        ("/tf_static", ROS.tf(0, "mast", "laser", (0.0, 0.0, 0.5)), 0),
        ("/scan", ROS.scan(0), 0),
    ]
    roles = Roles(scan="/scan", transforms=TF)
    items = feed(Converter(roles, SourceOptions(base_frame="/mast")), tf)
    np.testing.assert_allclose(scans(items)[0].T_base_laser.translation, [0.0, 0.0, 0.5])
    items = feed(Converter(roles, SourceOptions(laser_pose=(1.0, 2.0, 3.0, 0.0, 0.0, math.pi / 2))), tf)
    mount = scans(items)[0].T_base_laser
    np.testing.assert_array_equal(mount.translation, [1.0, 2.0, 3.0])
    assert geometry.heading(mount.rotation) == pytest.approx(math.pi / 2)
    converter = Converter(roles, SourceOptions(base_frame="nowhere"))
    feed(converter, tf)
    with pytest.raises(SourceError, match="'nowhere' is not in tf: it knows base_link, laser, mast"):
        converter.flush()


def test_a_frame_of_the_world_is_no_base() -> None:
    """Where tf leads from the laser to a frame on the earth alone, its scans are left out, with the remedy."""
    tf = [("/tf_static", ROS.tf(0, "utm", "laser", (4.5e5, 4.4e6, 0.0)), 0), ("/scan", ROS.scan(0), 0)]
    converter = Converter(Roles(scan="/scan", transforms=TF), SourceOptions())
    assert scans([*feed(converter, tf), *converter.flush()]) == []
    ((reason, count),) = converter.report.skipped.items()
    assert count == 1
    assert "laser more than 1000 m from the base" in reason
    assert "--base-frame or --laser-pose" in reason


def test_a_moving_mount_is_taken_at_the_middle_of_the_sweep() -> None:
    """A tilting laser waits for the joint's next sample and is placed between the two."""
    converter = Converter(Roles(scan="/scan", transforms=TF), SourceOptions())

    def joint(ns: int, x: float) -> tuple[str, Any, int]:
        return "/tf", ROS.tf(ns, "base_link", "laser", (x, 0.0, 0.0)), ns

    scan = ROS.scan(150, time_increment=50e-9)  # three rays: the middle of the sweep is at 200
    items = feed(converter, [joint(0, 0.0), joint(100, 0.1), ("/scan", scan, 160)])
    assert not items
    items = feed(converter, [joint(300, 0.3)])
    np.testing.assert_allclose(scans(items)[0].T_base_laser.translation, [0.2, 0.0, 0.0])
    assert "tf places laser on base_link, moving" in converter.report.notes


def test_a_clock_that_is_set_back_does_not_hold_up_the_stream() -> None:
    """A scan that waits for the joint's next sample goes on with the last one, and so do the scans behind it."""
    converter = Converter(Roles(scan="/scan", transforms=TF), SourceOptions())
    now = 3600 * SECOND
    for x, stamp_ns in ((0.0, now), (0.1, now + TENTH)):
        feed(converter, [("/tf", ROS.tf(stamp_ns, "base_link", "laser", (x, 0.0, 0.0)), stamp_ns)])
    assert not feed(converter, [("/scan", ROS.scan(now + 2 * TENTH), now + 2 * TENTH)])
    behind = [("/scan", ROS.scan(i * TENTH), i * TENTH) for i in range(20)]
    found = scans(feed(converter, behind))
    assert found[0].stamp_ns == START + now + 2 * TENTH
    assert len(found) > 1


def test_an_imu_is_turned_by_its_mount() -> None:
    """An IMU that hangs upside down on the base gives +g on z."""
    converter = Converter(Roles(imu="/imu", transforms=TF), SourceOptions())
    upside_down = ROS.quaternion(0.0, 1.0, 0.0, 0.0)
    items = feed(
        converter,
        [
            ("/tf_static", ROS.tf(0, "base_link", "imu", orientation=upside_down), 0),
            ("/imu", ROS.imu(0, forces=(0.0, 0.0, -9.8)), 0),
        ],
    )
    assert isinstance(items[0], Imu)
    np.testing.assert_allclose(items[0].linear_acceleration, [0.0, 0.0, 9.8], atol=1e-12)


def test_time_that_runs_backwards_is_skipped_and_counted() -> None:
    """Stamps before that of the message ahead of the same topic are left out; other topics do not matter."""
    converter = Converter(Roles(scan="/scan", imu="/imu"), SourceOptions())
    entries = [("/scan", ROS.scan(ns), i) for i, ns in enumerate((100, 200, 150, 200, 300))]
    entries.append(("/imu", ROS.imu(50), 9))
    assert [item.stamp_ns - START for item in feed(converter, entries)] == [100, 200, 200, 300, 50]
    assert converter.report.skipped == {"/scan: time runs backwards: stamped before the message ahead of it": 1}


def test_a_stamp_in_the_future_is_skipped_and_named() -> None:
    """One that leaps ahead costs itself alone, of a sensor or of tf, and a truth from tf goes on as well."""
    roles = Roles(imu="/imu", truth="tf:map>base_link", transforms=TF)
    converter = Converter(roles, SourceOptions())
    stamps = (0, TENTH, 10**9 * SECOND, 3 * TENTH, 4 * TENTH)
    entries: list[tuple[str, Any, int]] = []
    for i, ns in enumerate(stamps):
        entries.append(("/tf", ROS.tf(ns, "map", "base_link", (float(i), 0.0, 0.0)), i * TENTH))
        entries.append(("/imu", ROS.imu(ns, "base_link"), i * TENTH))
    items = feed(converter, entries)
    for kind in (Imu, TruthPose):
        found = [item.stamp_ns - START for item in items if isinstance(item, kind)]
        assert found == [0, TENTH, 3 * TENTH, 4 * TENTH]
    leap = "time leaps ahead: stamped far beyond the message ahead of it"
    assert converter.report.skipped == {f"/tf: {leap}": 1, f"/imu: {leap}": 1}


def test_a_truth_from_tf_follows_a_clock_that_was_set_back() -> None:
    """After two transforms that are left out, as with any message."""
    converter = Converter(Roles(truth="tf:map>base_link", transforms=TF), SourceOptions())
    stamps = (9, 10, -3600, -3599, -3598, -3597)
    entries = [("/tf", ROS.tf(s * SECOND, "map", "base_link", (s, 0.0, 0.0)), i) for i, s in enumerate(stamps)]
    poses = [item for item in feed(converter, entries) if isinstance(item, TruthPose)]
    assert [pose.stamp_ns - START for pose in poses] == [s * SECOND for s in (9, 10, -3598, -3597)]
    assert [pose.T_map_base.translation[0] for pose in poses] == [9.0, 10.0, -3598.0, -3597.0]


def test_one_bad_message_is_named_and_the_next_is_used() -> None:
    """Every reason has its counter, with the topic's name."""
    converter = Converter(Roles(scan="/scan", imu="/imu"), SourceOptions())
    entries = [
        ("/scan", ROS.scan(0, ranges=[]), 0),
        ("/scan", ROS.scan(1, angle_min=math.nan), 1),
        ("/scan", ROS.scan(2, ranges=[math.nan]), 2),
        ("/scan", ROS.scan(3, ranges=[math.nan]), 3),
        ("/imu", ROS.imu(3, rates=(math.nan, 0.0, 0.0)), 3),
        ("/scan", ROS.scan(4), 4),
        ("/imu", ROS.imu(4), 4),
    ]
    assert [type(item) for item in feed(converter, entries)] == [LaserScan, Imu]
    assert converter.report.skipped == {
        "/scan: scan without beams": 1,
        "/scan: scan whose angle_min or angle_increment is not a number": 1,
        "/scan: scan with nothing but NaN ranges": 2,
        "/imu: IMU message with NaN or infinite values": 1,
    }
    assert converter.report.read == {"/scan": 5, "/imu": 2}


def test_a_number_of_beams_that_varies_is_welcome_and_noted() -> None:
    """1079 readings in place of 1080 break nothing."""
    converter = Converter(Roles(scan="/scan"), SourceOptions())
    entries = [("/scan", ROS.scan(i, ranges=[1.0] * n), i) for i, n in enumerate((4, 3, 4))]
    assert [len(scan.ranges) for scan in scans(feed(converter, entries))] == [4, 3, 4]
    assert "/scan: the number of beams varies" in converter.report.notes


def test_a_stamp_of_zero_is_replaced_by_the_time_of_receipt() -> None:
    """Drivers without a clock are usable."""
    converter = Converter(Roles(scan="/scan"), SourceOptions())
    assert feed(converter, [("/scan", ROS.scan(None), 77)])[0].stamp_ns == START + 77


def test_heights_count_from_the_first() -> None:
    """The first height is 0, whatever the sensor's own zero is."""
    converter = Converter(Roles(height="/pressure"), SourceOptions())
    entries = [("/pressure", ROS.pressure(i, p), i) for i, p in enumerate((98000.0, 97988.0))]
    heights = [item.height for item in feed(converter, entries) if isinstance(item, Height)]
    assert heights[0] == 0.0
    assert heights[1] == pytest.approx(1.0, abs=0.1)
    converter = Converter(Roles(height="/altitude"), SourceOptions())
    items = feed(converter, [("/altitude", ROS.point(i, 300.0 + i), i) for i in range(2)])
    assert [item.height for item in items if isinstance(item, Height)] == [0.0, 1.0]


def test_a_distance_sensor_without_tf_is_taken_to_look_down() -> None:
    """A person who names a distance sensor as that to the ground means it so."""
    converter = Converter(Roles(ground="/sonar"), SourceOptions())
    (item,) = feed(converter, [("/sonar", ROS.range(0, 1.5), 0)])
    assert isinstance(item, GroundDistance)
    np.testing.assert_allclose(item.distance * item.direction, [0.0, 0.0, -1.5], atol=1e-9)


def test_fixes_count_from_the_first_that_is_one() -> None:
    """The first position is the origin, which is noted; one without satellites before it is counted."""
    converter = Converter(Roles(gps="/fix", gps_velocity="/vel", magnetic="/mag"), SourceOptions())
    entries = [
        ("/fix", ROS.fix(0, 0.0, 0.0, 0.0, status=-1), 0),
        ("/fix", ROS.fix(1, 47.0, 8.0, 400.0), 1),
        ("/fix", ROS.fix(2, 47.0001, 8.0, 401.0), 2),
        ("/vel", ROS.gps_velocity(2, (1.0, 0.0, 0.0)), 2),
        ("/mag", ROS.magnetic(2, (2e-5, 0.0, 4e-5)), 2),
    ]
    first, second, velocity, field = feed(converter, entries)
    assert isinstance(first, GpsPosition) and isinstance(second, GpsPosition)
    np.testing.assert_allclose(first.position, 0.0, atol=1e-6)
    np.testing.assert_allclose(second.position, [0.0, 11.1, 1.0], atol=0.1)
    assert isinstance(velocity, GpsVelocity) and isinstance(field, MagneticField)
    assert "/fix: east and north count from 47.000000°, 8.000000°" in converter.report.notes
    assert converter.report.skipped == {"/fix: satellite fix without a position": 1}


def lean(ns: int, roll: float) -> tuple[str, Any, int]:
    w, x, y, z = geometry.from_euler(roll, 0.0, 0.3)
    return "/tf", ROS.tf(ns, "odom", "base_link", orientation=ROS.quaternion(w, x, y, z)), ns


def test_without_an_imu_a_leaning_tf_gives_the_attitude() -> None:
    """From the first lean on every transform of the base is an attitude; a level tf gives none."""
    converter = Converter(Roles(scan="/scan", transforms=TF), SourceOptions())
    items = feed(converter, [lean(0, 0.0), lean(1, 0.0), lean(2, 0.1), lean(3, 0.0), lean(3, 0.2)])
    items += converter.flush()
    assert [type(item) for item in items] == [Attitude, Attitude]
    assert [item.stamp_ns - START for item in items] == [2, 3]
    assert "attitude from tf:odom>base_link" in converter.report.notes
    assert not feed(Converter(Roles(imu="/imu", transforms=TF), SourceOptions()), [lean(2, 0.1)])


def test_truth_can_come_from_tf() -> None:
    """tf:PARENT>CHILD gives a pose at every transform that carries the child."""
    converter = Converter(Roles(truth="tf:map>base_link", transforms=TF), SourceOptions())
    entries = [
        ("/tf", ROS.tf(0, "map", "odom", (1.0, 0.0, 0.0)), 0),
        ("/tf", ROS.tf(1, "odom", "base_link", (0.0, 2.0, 0.0)), 1),
        ("/tf", ROS.tf(2, "map", "odom", (1.0, 0.0, 0.0)), 2),
    ]
    poses = [item for item in feed(converter, entries) if isinstance(item, TruthPose)]
    assert [pose.stamp_ns - START for pose in poses] == [1]
    np.testing.assert_allclose(poses[0].T_map_base.translation, [1.0, 2.0, 0.0])
    lost = Converter(Roles(truth="tf:map>nowhere", transforms=TF), SourceOptions())
    assert not feed(lost, entries)
    assert any("tf:map>nowhere: tf does not join these frames" in note for note in lost.report.notes)


def test_a_spoilt_transform_is_counted_and_the_others_hold() -> None:
    """A zero quaternion in tf does not reach the tree."""
    converter = Converter(Roles(scan="/scan", transforms=TF), SourceOptions())
    message = ROS.tf(0, "base_link", "laser", (0.2, 0.0, 0.0))
    bad = ROS.transform_stamped(0, "base_link", "laser", orientation=ROS.quaternion(0.0))
    message.transforms.append(bad)
    items = feed(converter, [("/tf_static", message, 0), ("/scan", ROS.scan(0), 0)])
    assert scans(items)[0].T_base_laser.translation[0] == 0.2
    assert converter.report.skipped == {"/tf_static: transform with a zero or NaN quaternion": 1}


def test_one_topic_may_play_two_parts() -> None:
    """An IMU whose orientation is asked for as well gives both, and each fails alone."""
    converter = Converter(Roles(imu="/imu", attitude="/imu"), SourceOptions())
    absent = ROS.imu(1, absent=("orientation",))
    items = feed(converter, [("/imu", ROS.imu(0), 0), ("/imu", absent, 1)])
    assert [type(item) for item in items] == [Imu, Attitude, Imu]
    assert converter.report.skipped == {"/imu: IMU message that declares its orientation absent": 1}
