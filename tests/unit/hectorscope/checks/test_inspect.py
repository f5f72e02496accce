"""The description of a recording."""

import math
from pathlib import Path
from typing import Any

import pytest

from hectorscope.checks.inspect import inspect_bag
from hectorscope.cli.opening import demo_bag
from hectorscope.inputs import SourceError, SourceOptions
from hectorscope.simulation import SceneOptions, Simulation
from hectorscope.simulation.sensors import START_NS
from slam_core.measurements import Imu, LaserScan
from tests.ros_messages import SECOND, Messages, write_bag

TENTH = SECOND // 10


@pytest.fixture
def bag(tmp_path: Path) -> Path:
    """Scans at 10 Hz with one missing, one spoilt scan, a mount, and a topic of no use."""
    ros = Messages("ros1")
    text = ros.make("std_msgs/msg/String", data="hello")
    entries = [("/scan", ros.scan(i * TENTH), i * TENTH) for i in (0, 1, 2, 4, 5)]
    entries.append(("/scan", ros.scan(6 * TENTH, ranges=[]), 6 * TENTH))
    entries.append(("/chatter", text, 6 * TENTH))
    entries.append(("/tf_static", ros.tf(0, "base_link", "laser", (0.2, 0.0, 0.1)), 6 * TENTH))
    return write_bag(tmp_path / "run.bag", entries)


def test_topics_have_counts_rates_and_gaps(bag: Path) -> None:
    """A missing scan shows as the longest gap; a type of no use has no gap."""
    report = inspect_bag(bag, SourceOptions())
    chatter, scan, tf = report.topics
    assert (chatter.name, chatter.msgtype, chatter.messages) == ("/chatter", "std_msgs/msg/String", 1)
    assert math.isnan(chatter.longest_gap_s)
    assert (scan.messages, tf.messages) == (6, 1)
    assert scan.rate_hz == pytest.approx(5 / 0.6)
    assert scan.longest_gap_s == pytest.approx(0.2)
    assert report.duration_s == pytest.approx(0.6)


def test_parts_say_what_would_be_used(bag: Path) -> None:
    """Five of six scans are usable, the mount comes from tf, and the sixth is named with its reason."""
    report = inspect_bag(bag, SourceOptions())
    scan = report.parts[0]
    assert (scan.role, scan.topic, scan.measurements) == ("scan", "/scan", 5)
    assert "3 beams over 57°" in scan.detail
    assert "mount 0.200 0.000 0.100 m, 0.0 0.0 0.0°" in scan.detail
    assert "tf places laser on base_link" in report.source.notes
    assert report.source.skipped == {"/scan: scan without beams": 1}
    assert {part.role: part.topic for part in report.parts[1:]} == dict.fromkeys(
        ("imu", "attitude", "odometry", "height", "ground", "magnetic", "gps", "gps_velocity", "truth")
    )


def test_as_text_it_says_all_of_it(bag: Path) -> None:
    """The lines for the terminal carry topics, parts, notes and skipped messages."""
    text = str(inspect_bag(bag, SourceOptions()))
    assert text.startswith("run.bag: ROS 1 bag, 0.6 s from 2023-11-14 22:13:20 UTC")
    for words in ("8.3 Hz", "0.200 s", "std_msgs/msg/String", "notes", "skipped", "1 x /scan: scan without beams"):
        assert words in text


def test_names_cannot_give_a_terminal_orders(tmp_path: Path) -> None:
    """What a terminal would obey is replaced, a newline too; the lines of the report stay lines."""
    ros = Messages("ros1")
    entries = [("/sc\x1b[31man\n/false", ros.scan(i * TENTH), i * TENTH) for i in range(3)]
    text = str(inspect_bag(write_bag(tmp_path / "run.bag", entries), SourceOptions()))
    assert "/sc\N{REPLACEMENT CHARACTER}[31man\N{REPLACEMENT CHARACTER}/false" in text
    assert all(line.isprintable() for line in text.split("\n"))


def test_overrides_are_obeyed(bag: Path) -> None:
    """--laser-pose shows in the mount, an unknown topic is refused."""
    report = inspect_bag(bag, SourceOptions(laser_pose=(1.0, 0.0, 0.0, 0.0, 0.0, math.pi)))
    assert "mount 1.000 0.000 0.000 m, 0.0 0.0 180.0°" in report.parts[0].detail
    with pytest.raises(SourceError, match="there is no topic '/imu'"):
        inspect_bag(bag, SourceOptions(imu_topic="/imu"))


def test_the_noise_of_the_laser_is_reported() -> None:
    """The scanner of the arena has 1 cm at every range, that of the littoral twice as much and more far away."""
    near = inspect_bag(demo_bag("arena"), SourceOptions())
    assert all(0.007 < sigma < 0.013 for _, sigma in near.range_noise[1:])
    assert "noise of the ranges: " in str(near) and "smoothed" not in str(near)
    far = inspect_bag(demo_bag("littoral"), SourceOptions()).range_noise[-1]
    assert far[0] > 20.0 and 0.03 < far[1] < 0.07


def by_clocks_apart(path: Path, late_ns: int) -> Path:
    """Rooms by a laser whose clock is 1.5 s behind; every other scan takes so much longer to the recorder."""
    ros, entries = Messages("ros1"), list[tuple[str, Any, int]]()
    for item in Simulation("rooms", SceneOptions(scan_rate=10.0, beams=181, duration=30.0)).items():
        t = item.stamp_ns - START_NS
        if isinstance(item, LaserScan):
            fields = "angle_min", "angle_increment", "time_increment", "ranges"
            message = ros.scan(t - 15 * TENTH, **{name: getattr(item, name) for name in fields})
            entries.append(("/scan", message, item.end_ns - START_NS + late_ns * (t // TENTH % 2)))
        elif isinstance(item, Imu):
            message = ros.imu(t, rates=item.angular_velocity, forces=item.linear_acceleration)
            entries.append(("/imu", message, t))
    return write_bag(path, sorted(entries, key=lambda entry: entry[2]))


def test_turns_by_clocks_that_are_far_apart_are_compared_once_these_are_put_right(tmp_path: Path) -> None:
    """The difference and what is done about it are told."""
    report = inspect_bag(by_clocks_apart(tmp_path / "apart.bag", 0), SourceOptions())
    assert report.measures.turn is not None and report.measures.turn.correlation > 0.9
    (fault,) = (fault for fault in report.faults if "clock" in fault.fact)
    assert fault.fact == "the clock of /scan is 1.50 s behind that of /imu"
    assert fault.remedy == "it is put right by when messages came; keep both clocks by NTP or PTP"
    assert "the clock of /imu is 1.50 s ahead of that of the scans" in str(report)


def test_turns_by_clocks_that_may_be_far_apart_are_not_compared(tmp_path: Path) -> None:
    """They would show a laser that is mounted wrongly; with the delay that is stated they agree."""
    path = by_clocks_apart(tmp_path / "apart.bag", 9 * TENTH // 10)
    apart = inspect_bag(path, SourceOptions())
    assert apart.measures.turn is None and not apart.findings
    assert "--imu-delay 1.50" in " ".join(fault.remedy for fault in apart.faults)
    together = inspect_bag(path, SourceOptions(imu_delay=1.5))
    assert together.measures.turn is not None and together.measures.turn.correlation > 0.9
