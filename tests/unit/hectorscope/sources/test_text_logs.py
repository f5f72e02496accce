"""Logs of text: CARMEN's and tinySLAM's."""

import gzip
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from hectorscope.checks.inspect import inspect_bag
from hectorscope.inputs import Item, Source, SourceError, SourceOptions
from hectorscope.sources import _text_log, open_source
from slam_core import geometry
from slam_core.measurements import LaserScan, Odometry, TruthPose

SECOND = 1_000_000_000
T0 = 1_100_000_000.0


def flaser(
    time: float, ranges: Sequence[float], wheels: Sequence[float] = (0, 0, 0), pose: Sequence[float] = (0, 0, 0)
) -> str:
    """A FLASER line."""
    numbers = " ".join(f"{value:.2f}" for value in ranges)
    poses = " ".join(map(str, (*pose, *wheels)))
    return f"FLASER {len(ranges)} {numbers} {poses} {T0 + time:.6f} robot {time:.6f}\n"


RANGES = tuple(1.0 + 0.01 * i for i in range(181))
OTHERS = tuple(2.0 + 0.01 * i for i in range(181))


def write(path: Path, lines: Sequence[str]) -> str:
    """The lines as a file, packed if its name says so; its path as an address."""
    data = "".join(lines).encode()
    path.write_bytes(gzip.compress(data) if path.suffix == ".gz" else data)
    return str(path)


def read(uri: str, **options: object) -> tuple[Source, list[Item]]:
    source = open_source(uri, SourceOptions(**options))  # type: ignore[arg-type]
    return source, list(source.items())


@pytest.mark.parametrize("name", ["run.clf", "run.log", "run.log.gz", "run.clf.gz"])
def test_a_carmen_log_gives_scans_and_the_velocity_of_its_wheels(tmp_path: Path, name: str) -> None:
    """Half a turn of beams; a quarter of a circle driven in a second is a velocity along its chord, and a turn."""
    quarter = (1.0, 1.0, math.pi / 2)
    lines = ["# a comment\n", "ODOM 0 0 0 0 0 0 0 robot 0\n", flaser(0.0, RANGES), flaser(1.0, OTHERS, quarter)]
    source, items = read(write(tmp_path / name, lines))
    first, wheels, second = items
    assert isinstance(first, LaserScan)
    assert isinstance(second, LaserScan)
    assert isinstance(wheels, Odometry)
    assert (first.stamp_ns, second.stamp_ns) == (round(T0) * SECOND, round(T0 + 1) * SECOND)
    assert first.angle_min == pytest.approx(-math.pi / 2)
    assert first.angle_increment == pytest.approx(math.radians(1.0))
    np.testing.assert_allclose(first.ranges, RANGES, atol=1e-6)
    assert wheels.stamp_ns == first.stamp_ns  # from there on it holds
    np.testing.assert_allclose(wheels.velocity, [math.sqrt(2.0), 0.0], atol=1e-9)
    assert wheels.yaw_rate == pytest.approx(math.pi / 2)
    assert source.report.read == {"scan": 2}
    assert source.span_ns == (first.stamp_ns, second.stamp_ns)
    assert list(source.items())[2] is not None  # it can be read again


def test_beams_without_return_and_the_place_of_the_laser(tmp_path: Path) -> None:
    """81.91 m is no return, the log's own offset is the mount, and --laser-pose overrides it."""
    lines = ["PARAM robot_frontlaser_offset 0.3 0 robot 0\n", flaser(0.0, (81.91, *RANGES[1:]))]
    uri = write(tmp_path / "run.log", lines)
    (scan,) = read(uri)[1]
    assert isinstance(scan, LaserScan)
    assert np.isinf(scan.ranges[0])
    np.testing.assert_array_equal(scan.T_base_laser.translation, [0.3, 0.0, 0.0])
    (scan,) = read(uri, laser_pose=(0.1, 0.0, 0.0, 0.0, 0.0, 0.0))[1]
    assert isinstance(scan, LaserScan)
    np.testing.assert_array_equal(scan.T_base_laser.translation, [0.1, 0.0, 0.0])


def test_a_laser_far_from_its_robot_is_left_out(tmp_path: Path) -> None:
    """An offset that no robot has is counted, and the laser stays where it was."""
    uri = write(tmp_path / "run.log", ["PARAM robot_frontlaser_offset 1e300\n", flaser(0.0, RANGES)])
    source, (scan,) = read(uri)
    assert isinstance(scan, LaserScan)
    np.testing.assert_array_equal(scan.T_base_laser.translation, np.zeros(3))
    assert list(source.report.skipped) == ["laser more than 1000 m from the base"]


def test_bad_lines_are_counted_named_and_left_out(tmp_path: Path) -> None:
    """Cut short, no number, an impossible count, time that stands still: the other scans are used."""
    lines = [
        flaser(0.0, RANGES),
        flaser(1.0, RANGES)[:300] + "\n",
        flaser(2.0, RANGES).replace("1.50", "nan"),
        "FLASER 1 1.0 0 0 0 0 0 0 3 robot 3\n",
        "FLASER many\n",
        flaser(0.0, OTHERS),
        "\x00\xff binary\n",
        flaser(4.0, OTHERS),
    ]
    source, items = read(write(tmp_path / "run.log", lines))
    assert [type(item) for item in items] == [LaserScan, LaserScan]  # four seconds apart: no velocity
    assert source.report.skipped == {
        "line cut off or without numbers": 3,
        "FLASER with no scan": 1,
        "scan that is not later than the one before": 1,
    }


def test_a_line_of_the_future_is_left_out_alone(tmp_path: Path) -> None:
    """One time far ahead is counted and named, and the scans behind it are used."""
    times = (0.0, 0.2, 1e9, 0.6, 0.8)
    source, items = read(write(tmp_path / "run.log", [flaser(t, RANGES) for t in times]))
    found = [item.stamp_ns for item in items if isinstance(item, LaserScan)]
    assert found == [round((T0 + t) * 1e9) for t in (0.0, 0.2, 0.6, 0.8)]
    assert source.report.skipped == {"time leaps ahead: stamped far beyond the message ahead of it": 1}


def test_a_log_by_a_clock_that_was_set_back(tmp_path: Path) -> None:
    """It is followed at the third scan, from which no velocity leads back; the span holds all that is used."""
    times = (0.0, 0.2, -60.0, -59.8, -59.6, -59.4)
    lines = [flaser(t, RANGES, (i, 0.0, 0.0)) for i, t in enumerate(times)]
    source, items = read(write(tmp_path / "run.log", lines))
    assert [type(item) for item in items] == [LaserScan, Odometry, LaserScan, LaserScan, Odometry, LaserScan]
    assert source.report.skipped == {"scan that is not later than the one before": 2}
    assert source.span_ns == (round((T0 - 59.6) * 1e9), round((T0 + 0.2) * 1e9))


def test_a_corrected_log_is_known_by_its_stamps(tmp_path: Path) -> None:
    """Its scans have one time, so hardly any is of use: they are counted, and a note says what it is for."""
    source, _ = read(write(tmp_path / "run.log", [flaser(0.0, RANGES) for _ in range(3)]))
    assert source.report.unusable == 2
    assert "a corrected log, to be given as --truth" in source.report.notes[-1]


def test_a_packed_log_that_is_cut_is_read_as_far_as_it_goes(tmp_path: Path) -> None:
    """What could be unpacked is used, and a note says so."""
    noise = np.random.default_rng(5)
    lines = [flaser(0.2 * i, noise.uniform(1.0, 9.0, 181)) for i in range(100)]
    path = tmp_path / "run.log.gz"
    write(path, lines)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    source, items = read(str(path))
    assert 20 < sum(isinstance(item, LaserScan) for item in items) < 80
    assert "cut off or damaged" in source.report.notes[0]


@pytest.mark.parametrize("name", ["run.log", "run.log.gz"])
def test_a_log_without_end_is_read_to_its_limit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    """A line that is none comes in pieces and is counted; a note says that the rest was left out."""
    monkeypatch.setattr(_text_log, "LONGEST_LINE", 5_000)
    monkeypatch.setattr(_text_log, "LONGEST_LOG", 100_000)
    scans = [flaser(0.1 * i, RANGES) for i in range(1, 4)]
    source, items = read(write(tmp_path / name, [*scans, "FLASER " + "x" * 300_000 + "\n", *scans]))
    assert sum(isinstance(item, LaserScan) for item in items) == 3
    assert source.report.notes == (f"{name} holds more than 100000 bytes: the rest is left out",)


def test_the_truth_is_a_corrected_log_of_the_same_scans(tmp_path: Path) -> None:
    """Whatever its times and its notation: a pose belongs to the scan with the same ranges."""
    uri = write(tmp_path / "run.log", [flaser(0.0, RANGES), flaser(0.2, OTHERS)])
    there = flaser(0.0, OTHERS, pose=(1.0, 2.0, 0.5)).replace("2.00 ", "2 ").replace(f"{T0:.6f}", "1.1e+09")
    corrected = write(tmp_path / "corrected.log.gz", [there, "NEFF 1\n", flaser(9.0, RANGES[::-1])])
    items = read(uri, truth_topic=corrected)[1]
    (pose,) = (item for item in items if isinstance(item, TruthPose))
    assert pose.stamp_ns == items[2].stamp_ns == round((T0 + 0.2) * SECOND)
    np.testing.assert_allclose(geometry.planar(pose.T_map_base), [1.0, 2.0, 0.5])
    foreign = write(tmp_path / "foreign.log", [flaser(0.0, RANGES[::-1])])
    with pytest.raises(SourceError, match=r"foreign.log has no pose for a scan of run.log"):
        read(uri, truth_topic=foreign)
    with pytest.raises(SourceError, match=r"none.log does not exist"):
        read(uri, truth_topic=str(tmp_path / "none.log"))


def test_options_hold_for_logs_as_for_bags(tmp_path: Path) -> None:
    """Wheels left out, a scan mirrored and late, and a topic that is not there."""
    uri = write(tmp_path / "run.log", [flaser(0.0, RANGES), flaser(0.2, OTHERS)])
    items = read(uri, odometry_topic="none", scan_mirrored=True, scan_delay=0.5)[1]
    assert [type(item) for item in items] == [LaserScan, LaserScan]
    assert isinstance(items[0], LaserScan)
    assert items[0].angle_increment < 0.0
    assert items[0].stamp_ns == round((T0 - 0.5) * SECOND)
    with pytest.raises(SourceError, match="there is no topic '/imu'"):
        read(uri, imu_topic="/imu")


@pytest.mark.parametrize("name", ["run.log", "run.dat", "run.log.gz"])
def test_what_is_no_log_is_refused(tmp_path: Path, name: str) -> None:
    """Text of something else, nothing at all, no file, a name that none can have: the path and the fact."""
    with pytest.raises(SourceError, match="holds no scan of a"):
        read(write(tmp_path / name, ["hello\n", "world 1 2 3\n"]))
    with pytest.raises(SourceError, match="holds no scan of a"):
        read(write(tmp_path / name, []))
    with pytest.raises(SourceError, match="does not exist"):
        read(str(tmp_path / f"missing_{name}"))
    with pytest.raises(SourceError, match="File name too long"):
        read(str(tmp_path / ("x" * 300 + name)))
    (tmp_path / "picture.png").touch()
    with pytest.raises(SourceError, match="neither a recording nor an address"):
        read(str(tmp_path / "picture.png"))


def test_a_tinyslam_log_gives_scans_and_wheels(tmp_path: Path) -> None:
    """Both wheels one turn further in a second: straight on by their circumference."""
    ranges = " ".join(["0", *["1500"] * 681])
    lines = [f"{i * 1_000_000 + 7} 0 {2000 * i} {2000 * i} {'0 ' * 20}{ranges}\n" for i in range(2)]
    first, wheels, _ = read(write(tmp_path / "run.dat", lines))[1]
    assert isinstance(first, LaserScan)
    assert isinstance(wheels, Odometry)
    assert first.stamp_ns == 7000
    assert np.isinf(first.ranges[0])
    assert first.ranges[1] == pytest.approx(1.5)
    assert first.angle_min == pytest.approx(-math.radians(120.0))
    np.testing.assert_allclose(wheels.velocity, [math.tau * 0.077, 0.0])
    assert wheels.yaw_rate == 0.0


def test_logs_can_be_inspected(tmp_path: Path) -> None:
    """Their parts and rates, as of any recording."""
    path = tmp_path / "run.log"
    write(path, [flaser(0.2 * i, RANGES, (0.1 * i, 0.0, 0.0)) for i in range(6)])
    report = inspect_bag(path, SourceOptions())
    assert report.container == "CARMEN log"
    assert [(line.name, round(line.rate_hz, 3)) for line in report.topics] == [("scan", 5.0), ("wheels", 5.0)]
    used = {part.role: (part.topic, part.measurements) for part in report.parts if part.topic}
    assert used == {"scan": ("scan", 6), "odometry": ("wheels", 5)}
    assert "181 beams over 180°" in str(report)
