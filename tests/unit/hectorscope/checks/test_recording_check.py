"""Recordings that are broken on purpose: each fault is found, with its time, and a whole one has none."""

from pathlib import Path

import numpy as np
import pytest

from benchmarks.broken import GAP_FROM_S, GAP_S, SLIP, make
from hectorscope.checks.inspect import BagReport, inspect_bag
from hectorscope.checks.recording_check import RecordingCheck
from hectorscope.inputs import Finding, SourceOptions, Stamped

MS = 1_000_000
USED = {"scan": "/scan", "imu": "/imu"}


def stream(
    topic: str, period_ms: float = 25.0, count: int = 400, late_ms: float = 2.0, **changes
) -> list[Stamped]:
    """Messages in a steady rhythm, recorded some milliseconds after their stamps."""
    stamps = [round(i * period_ms * MS) for i in range(count)]
    return [Stamped(topic, stamp + round(late_ms * MS), stamp, topic[1:], **changes) for stamp in stamps]


def examined(*messages: Stamped, unplaced: tuple[str, ...] = ()) -> list[Finding]:
    return RecordingCheck().take(sorted(messages, key=lambda each: each.log_ns)).findings(USED, unplaced)


def facts(*messages: Stamped, **options) -> str:
    return "; ".join(finding.fact for finding in examined(*messages, **options))


def test_a_whole_recording_has_no_findings() -> None:
    """Two sensors in their rhythms, each some milliseconds late."""
    assert not examined(*stream("/scan"), *stream("/imu", 10.0, 1000))


def test_a_gap_is_found_with_its_time_and_what_is_missing() -> None:
    """Where neither stamps nor recorder go on; a single message that is lost is none."""
    scans = stream("/scan")
    (found,) = examined(*scans[:100], *scans[101:200], *scans[240:])
    assert found.fact == "/scan has a gap of 1.03 s: about 40 messages are missing"
    assert found.time_ns == scans[199].log_ns
    assert found.remedy


def test_a_network_that_stalls_is_no_gap() -> None:
    """The stamps go on: all messages are there, and come late together."""
    scans = stream("/scan")
    scans[200:240] = [each._replace(log_ns=scans[240].log_ns) for each in scans[200:240]]
    assert "gap" not in facts(*scans)


def test_messages_that_come_together_are_not_missing() -> None:
    """Stamped on arrival, they look like a gap; of those that are missing as well, it is one."""
    scans, end_ns = stream("/scan"), 0
    for k in range(200, 240):
        end_ns = scans[240].log_ns + (k - 240) * MS // 10
        scans[k] = scans[k]._replace(log_ns=end_ns, stamp_ns=end_ns - 2 * MS)
    assert "/scan stops for 1.02 s, and 41 messages come together then" in facts(*scans)
    assert "gap" not in facts(*scans)
    assert facts(*scans[:200], *scans[235:]) == "/scan has a gap of 1.02 s: about 35 messages are missing"


def test_jitter_order_and_repeats() -> None:
    """Stamps of arrival jitter; those before an earlier one are counted, with the time of the first."""
    rng = np.random.default_rng(2)
    shaken = [
        each._replace(stamp_ns=each.stamp_ns + int(rng.normal(0.0, 8 * MS))) for each in stream("/scan", 100.0)
    ]
    assert "jitter by" in facts(*shaken)
    scans = stream("/scan")
    scans[50] = scans[50]._replace(stamp_ns=scans[40].stamp_ns)
    (found,) = examined(*scans)
    assert found.fact == "1 messages of /scan are stamped before an earlier one"
    assert found.time_ns == scans[50].log_ns


@pytest.mark.parametrize(("share", "word"), [(0.002, "slow"), (-0.002, "fast")])
def test_a_clock_that_drifts(share: float, word: str) -> None:
    """Against the recorder's, by the share of the time; a few parts in a million are those of quartz."""
    drifting = [
        each._replace(stamp_ns=round(each.stamp_ns * (1.0 - share))) for each in stream("/scan", 25.0, 1200)
    ]
    assert f"the clock of /scan runs 0.2 % too {word}" in facts(*drifting)
    quartz = [each._replace(stamp_ns=round(each.stamp_ns * (1.0 - 5e-5))) for each in stream("/scan", 25.0, 1200)]
    assert not facts(*quartz)


def test_a_recorder_that_drifts_is_no_fault_of_the_sensors() -> None:
    """All topics against it alike, where there are enough to tell."""
    topics = [stream(topic, 25.0, 1200) for topic in ("/scan", "/imu", "/odom")]
    all_of_them = [each._replace(stamp_ns=round(each.stamp_ns * 1.002)) for some in topics for each in some]
    used = {**USED, "odometry": "/odom"}
    found = RecordingCheck().take(sorted(all_of_them, key=lambda each: each.log_ns)).findings(used, ())
    assert not [one for one in found if "runs" in one.fact]


def test_a_clock_that_is_set_while_it_runs() -> None:
    """The time at which it is, and by how much."""
    scans = [
        each._replace(stamp_ns=each.stamp_ns - 300 * MS * (i >= 200)) for i, each in enumerate(stream("/scan"))
    ]
    found = next(one for one in examined(*scans) if "is set" in one.fact)
    assert found.fact == "the clock of /scan is set back by 0.3 s while it runs"
    assert found.time_ns == pytest.approx(scans[200].log_ns, abs=300 * MS)


def test_stamps_ahead_and_apart() -> None:
    """Ahead of the recorder; a sweep that ends after it was recorded; two sensors by different clocks."""
    assert "0.05 s ahead of the recorder" in facts(*stream("/scan", late_ms=-50.0))
    (early,) = examined(*stream("/scan", late_ms=1.0, lasts_ns=80 * MS))
    assert "before its last beam" in early.fact
    assert "give --scan-delay 0.08;" in early.remedy
    (found,) = examined(*stream("/scan", late_ms=302.0), *stream("/imu", 10.0, 1000))
    assert found.fact == "/scan takes 0.30 s longer from its stamp to the recorder than /imu"
    assert "--imu-delay 0.30" in found.remedy
    (found,) = examined(*stream("/scan", late_ms=30_002.0), *stream("/imu", 10.0, 1000))
    assert found.fact == "the clock of /scan is 30.00 s behind that of /imu"
    assert "give --imu-delay 30.00" in found.remedy


def test_frames_that_tf_does_not_place_or_that_share_a_topic() -> None:
    """Each with the flag that helps."""
    (found,) = examined(*stream("/scan"), unplaced=("scan",))
    assert "tf does not place scan, the frame of /scan" in found.fact
    assert found.remedy == "record /tf_static too, or give --laser-pose X Y Z ROLL PITCH YAW"
    (tilted,) = examined(*stream("/imu", 10.0, 1000), unplaced=("imu",))
    assert tilted.remedy == "record /tf_static too, or give --imu-rotation ROLL PITCH YAW"
    two = [each._replace(frame=f"laser{i % 2}") for i, each in enumerate(stream("/scan"))]
    assert "2 frames (laser0, laser1)" in facts(*two)


def test_beams_that_are_out_of_range_in_millimetres_or_do_not_return() -> None:
    """By shares; a stretch of a covered laser has its time."""
    good, far = np.full(100, 5.0, np.float32), np.full(100, 5.0, np.float32)
    far[:10] = 45.0
    limits = (0.1, 30.0)
    assert not facts(*stream("/scan", ranges=good, limits=limits))
    assert "10 % of the beams of /scan have ranges out of the limits" in facts(
        *stream("/scan", ranges=far, limits=limits)
    )
    assert "in millimetres" in facts(*stream("/scan", ranges=1000.0 * good, limits=limits))
    blind = np.full(100, np.inf, np.float32)
    assert "100 % of the beams of /scan return nothing" in facts(*stream("/scan", ranges=blind, limits=limits))
    scans = [
        each._replace(ranges=blind) if 100 <= i < 140 else each
        for i, each in enumerate(stream("/scan", ranges=good, limits=limits))
    ]
    (found,) = examined(*scans)
    assert found.fact == "next to no beam of /scan returns for 1.0 s"
    assert found.time_ns == scans[100].log_ns


@pytest.fixture(scope="module")
def arena(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The demo, which is broken below."""
    return Path(__file__).parents[4] / "demo_bags" / "arena.bag"


def broken(arena: Path, folder: Path, how: str) -> BagReport:
    return inspect_bag(make(arena, folder / f"{how}.bag", how), SourceOptions())


def test_the_whole_demo_has_no_findings(arena: Path) -> None:
    """Neither of its sensors nor of itself."""
    report = inspect_bag(arena, SourceOptions())
    assert not report.faults
    assert not report.findings


def test_the_demo_with_a_gap(arena: Path, tmp_path: Path) -> None:
    """Scans and inertial data have it at the same time."""
    report = broken(arena, tmp_path, "gap")
    assert [fault.fact.split(" of ")[0] for fault in report.faults] == [
        "/scan has a gap",
        "/imu/data_raw has a gap",
    ]
    for fault in report.faults:
        assert f"{GAP_S:.1f}" in fault.fact
        assert fault.time_ns is not None
        assert (fault.time_ns - report.start_ns) * 1e-9 == pytest.approx(GAP_FROM_S, abs=0.1)
    assert f"(at {GAP_FROM_S - 0.02:.1f}" in str(report) or f"(at {GAP_FROM_S:.1f}" in str(report)


def test_the_demo_in_a_wrong_unit(arena: Path, tmp_path: Path) -> None:
    """Gravity shows it, and --repair puts it right."""
    report = broken(arena, tmp_path, "unit")
    assert [finding.repair for finding in report.findings] == ["--imu-accel-unit g"]
    assert not report.faults


def test_the_demo_with_a_slipping_clock(arena: Path, tmp_path: Path) -> None:
    """That of the scans alone, by how much, and over what time."""
    report = broken(arena, tmp_path, "clock")
    slow = [fault.fact for fault in report.faults if "runs" in fault.fact]
    assert slow == [f"the clock of /scan runs {100 * SLIP:.2g} % too slow: by 0.24 s in 60 s"]
    line = next(line for line in report.topics if line.name == "/scan")
    assert line.drift == pytest.approx(SLIP, rel=0.02)
