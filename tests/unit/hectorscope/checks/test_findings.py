"""Devices that lie, and what is said about them: a drive through the rooms with each lie put into it."""

import math
import re
from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from hectorscope.checks.findings import findings, remedy, repairing_options
from hectorscope.checks.sensor_check import CheckedSource, SensorError
from hectorscope.checks.sensor_statistics import Measures, SensorStatistics
from hectorscope.inputs import Item, SourceOptions
from hectorscope.ros.repairs import Repairs
from hectorscope.simulation.options import SceneOptions
from hectorscope.simulation.simulation import Simulation
from slam_core.measurements import Imu, LaserScan, Odometry
from tests.sources import MemoryRecording, MemoryStream

Lie = Callable[[Item], Item]
SECOND = 1_000_000_000


@cache
def honest(duration: float = 15.0) -> tuple[Item, ...]:
    """Fifteen seconds with turns, or more."""
    options = SceneOptions(duration=duration, beams=181, scan_rate=10.0, beam_timing=False)
    return tuple(Simulation("rooms", options).items())


def inertial(gyro: Iterable[float] = (1.0, 1.0, 1.0), accel: Iterable[float] = (1.0, 1.0, 1.0)) -> Lie:
    """Factors on the three rates and on the three accelerations."""
    rates, forces = np.array(gyro), np.array(accel)

    def tell(item: Item) -> Item:
        if not isinstance(item, Imu):
            return item
        return Imu(item.stamp_ns, rates * item.angular_velocity, forces * item.linear_acceleration)

    return tell


def mirrored(item: Item) -> Item:
    """Beams that run the wrong way round."""
    if not isinstance(item, LaserScan):
        return item
    return replace(item, angle_min=-item.angle_min, angle_increment=-item.angle_increment)


def late(kind: type[Item], seconds: float) -> Lie:
    """Stamps of one kind of measurement that come from the end of a pipe."""
    return lambda item: (
        replace(item, stamp_ns=item.stamp_ns + round(seconds * SECOND)) if isinstance(item, kind) else item
    )


def measures(items: Iterable[Item]) -> Measures:
    statistics = SensorStatistics()
    for item in items:
        statistics.take(item)
    return statistics.measures()


def repaired(items: Iterable[Item], options: SourceOptions) -> list[Item]:
    """What the sources would yield with these options."""
    repairs = Repairs(options)

    def repair(item: Item) -> Item:
        if isinstance(item, Imu):
            return replace(repairs.imu(item), stamp_ns=item.stamp_ns - repairs.imu_delay_ns)
        if isinstance(item, LaserScan):
            return replace(repairs.scan(item), stamp_ns=item.stamp_ns - repairs.scan_delay_ns)
        return item

    return [repair(item) for item in items]


@pytest.mark.slow
def test_a_clock_that_is_set_after_the_start_costs_neither_memory_nor_the_rest() -> None:
    """The first samples of an IMU whose board knew no time yet are years off: they are not looked at."""
    items = list(honest())
    first = next(item for item in items if isinstance(item, Imu))
    astray = [replace(first, stamp_ns=first.stamp_ns - k * 365 * 86_400_000_000_000) for k in (1, 40)]
    assert findings(measures([items[0], *astray, *items[1:]]), SourceOptions()) == []


LIES: dict[str, tuple[Lie, str, SourceOptions]] = {
    "milli-g": (
        inertial(accel=[1000.0 / 9.80665] * 3),
        "--imu-accel-unit mg",
        SourceOptions(imu_accel_unit="mg"),
    ),
    "g": (inertial(accel=[1.0 / 9.80665] * 3), "--imu-accel-unit g", SourceOptions(imu_accel_unit="g")),
    "degrees": (
        inertial(gyro=[math.degrees(1.0)] * 3),
        "--imu-gyro-unit deg/s",
        SourceOptions(imu_gyro_unit="deg/s"),
    ),
    "upside down": (
        inertial((1.0, -1.0, -1.0), (1.0, -1.0, -1.0)),
        "--imu-rotation 3.1416 0 0",
        SourceOptions(imu_rotation=(3.1416, 0.0, 0.0)),
    ),
    "mirrored scan": (mirrored, "--scan-mirrored true", SourceOptions(scan_mirrored=True)),
    "gravity for force": (
        inertial(accel=[-1.0] * 3),
        "--imu-inverted accel",
        SourceOptions(imu_inverted="accel"),
    ),
    "late scans": (late(LaserScan, 0.2), "--scan-delay 0.2", SourceOptions(scan_delay=0.2)),
    "late imu": (late(Imu, 0.1), "--imu-delay 0.1", SourceOptions(imu_delay=0.1)),
}


def test_honest_devices_are_left_alone() -> None:
    """Nothing is found, and what was measured is right: 9.8 m/s² upwards, the gyroscope turns as the scans do."""
    seen = measures(honest())
    assert findings(seen, SourceOptions()) == []
    assert seen.gravity is not None
    assert seen.gravity.norm == pytest.approx(9.81, abs=0.2)
    assert seen.gravity.up[2] > 0.99
    assert seen.turn is not None
    assert seen.turn.correlation > 0.98
    assert seen.turn.ratio == pytest.approx(1.0, abs=0.05)
    assert abs(seen.turn.lag) <= 0.02


@pytest.mark.parametrize("name", LIES)
def test_a_lie_is_found_and_its_repair_named(name: str) -> None:
    """One contradiction, one flag; and with that option nothing is left to find, however much it is doubted."""
    lie, flag, options = LIES[name]
    items = [lie(item) for item in honest()]
    (found,) = findings(measures(items), SourceOptions())
    assert found.repair.startswith(flag)
    assert found.grave == ("late" not in name)
    assert findings(measures(repaired(items, options)), SourceOptions()) == []


def test_swaying_feigns_no_lie() -> None:
    """Fifteen degrees of roll and pitch, scans that nothing puts level: no unit, no sign, no delay is made up."""
    options = SceneOptions(duration=20.0, beams=181, scan_rate=10.0, sway=15.0, sway_frequency=1.2)
    seen = measures(Simulation("rooms", options).items())
    assert seen.turn is not None
    assert findings(seen, SourceOptions()) == []


def test_several_lies_are_told_together() -> None:
    """Milli-g, degrees and a mirrored scan at once: three facts, and one line of flags."""
    lies = [LIES[name][0] for name in ("milli-g", "degrees", "mirrored scan")]
    items = list(honest())
    for lie in lies:
        items = [lie(item) for item in items]
    flags = "--imu-accel-unit mg --imu-gyro-unit deg/s --scan-mirrored true"
    assert remedy(findings(measures(items), SourceOptions())) == flags


@pytest.mark.parametrize("name", ["milli-g", "degrees", "upside down", "mirrored scan"])
def test_what_a_person_states_is_not_doubted(name: str) -> None:
    """Stating the very thing that the data contradicts is the way to go on all the same."""
    stated = SourceOptions(
        imu_accel_unit="m/s2", imu_gyro_unit="rad/s", imu_rotation=(0.0, 0.0, 0.0), scan_mirrored=False
    )
    items = [LIES[name][0](item) for item in honest()]
    assert findings(measures(items), stated) == []


@pytest.mark.parametrize("factor", [0.0, 1.0])
def test_gravity_removed_is_no_unit(factor: float) -> None:
    """Accelerations without gravity, or none at all, cannot be used: the IMU is to be left out."""
    items = [
        replace(item, linear_acceleration=factor * (item.linear_acceleration - [0.0, 0.0, 9.8]))
        if isinstance(item, Imu)
        else item
        for item in honest()
    ]
    found = findings(measures(items), SourceOptions())
    assert found[0].repair == "--imu-topic none"
    assert "which no unit explains" in found[0].fact


def test_a_robot_that_stands_still_tells_nothing_of_its_gyroscope() -> None:
    """The first scan over and over, with a gyroscope in degrees: nothing is said, gravity is still known."""
    scan = next(item for item in honest() if isinstance(item, LaserScan))
    noise = np.random.default_rng(4)
    items: list[Item] = []
    for tick in range(1500):
        stamp_ns = scan.stamp_ns + tick * SECOND // 100
        items.append(Imu(stamp_ns, noise.normal(0.0, 0.5, 3), noise.normal([0.0, 0.0, 9.8], 0.05)))
        if tick % 10 == 0:
            ranges = scan.ranges + noise.normal(0.0, 0.01, len(scan.ranges)).astype(np.float32)
            items.append(replace(scan, stamp_ns=stamp_ns, ranges=ranges))
    seen = measures(items)
    assert seen.turn is None
    assert seen.gravity is not None
    assert findings(seen, SourceOptions()) == []


@pytest.mark.parametrize(("sign", "flag"), [(1.0, None), (-1.0, "--scan-mirrored true")])
def test_wheels_are_held_against_the_scans(sign: float, flag: str | None) -> None:
    """Without an IMU the odometry's turn tells of a mirrored scan."""
    items: list[Item] = [
        Odometry(item.stamp_ns, np.zeros(2), sign * float(item.angular_velocity[2]))
        if isinstance(item, Imu)
        else item
        for item in honest()
    ]
    assert [finding.repair for finding in findings(measures(items), SourceOptions())] == ([flag] if flag else [])


def checked(items: Iterable[Item], *, repairs: bool = False) -> CheckedSource:
    """A recording that is opened with options as a file is."""
    items = list(items)
    return CheckedSource(
        lambda options: MemoryRecording(repaired(items, options)), SourceOptions(), repairs=repairs
    )


def test_a_recording_is_refused_by_its_beginning() -> None:
    """The name, the fact, --repair, the flags and the way without the IMU; an honest one is taken."""
    refused = checked(map(LIES["degrees"][0], honest()))
    words = r"memory: the gyroscope turns 5\d times .* with --repair, or with --imu-gyro-unit deg/s, or .*none"
    with pytest.raises(SensorError, match=words):
        next(refused.items())
    assert [finding.repair for finding in refused.report.findings] == ["--imu-gyro-unit deg/s"]
    taken = checked(honest())
    assert len(list(taken.items())) == len(honest())
    assert not taken.report.findings


def test_a_refusal_says_what_inspect_says() -> None:
    """Of a recording whose delay changes on the way: both look at the same part, and give the same flags."""
    late_at = honest()[0].stamp_ns + 10 * SECOND
    lie = LIES["degrees"][0]
    items = [lie(late(LaserScan, 0.3 if item.stamp_ns < late_at else 0.1)(item)) for item in honest(30.0)]
    flags = remedy(findings(measures(items), SourceOptions()))
    assert "--scan-delay" in flags
    with pytest.raises(SensorError, match=f"or with {re.escape(flags)}, or"):
        next(checked(items).items())


def test_a_repair_looks_as_far_as_inspect_does() -> None:
    """A delay that grows hardly shows in the beginning: it is repaired by the options that `inspect` names."""
    begin_ns = honest()[0].stamp_ns
    items = [late(LaserScan, 0.02 * (item.stamp_ns - begin_ns) / SECOND)(item) for item in honest(30.0)]
    named = repairing_options(findings(measures(items), SourceOptions()))
    assert set(named) == {"scan_delay"}
    source = checked(items, repairs=True)
    assert list(source.items())
    assert source.report.sensors == named


def test_a_delay_alone_refuses_nothing() -> None:
    """A run with late scans is worse, not wrong: it is warned of, and can be repaired."""
    source = checked(map(LIES["late scans"][0], honest()))
    assert list(source.items())
    assert "--scan-delay 0.2" in source.report.warnings[0]
    assert source.repair()
    assert source.report.sensors["scan_delay"] == pytest.approx(0.2, abs=0.03)


@pytest.mark.parametrize("repairs", [True, False])
def test_what_is_found_is_repaired(repairs: bool) -> None:
    """From the start or on request: the items are those of the flags, and the report tells what was repaired."""
    items = list(honest())
    for name in ("milli-g", "degrees", "mirrored scan", "late scans"):
        items = [LIES[name][0](item) for item in items]
    source = checked(items, repairs=repairs)
    if not repairs:
        with pytest.raises(SensorError):
            next(source.items())
        assert source.repair()
    came = list(source.items())
    report = source.report
    found = {"imu_accel_unit": "mg", "imu_gyro_unit": "deg/s", "scan_mirrored": True}
    assert report.sensors == found | {"scan_delay": pytest.approx(0.2, abs=0.03)}
    facts = " ".join(note for note in report.notes if note.startswith("Repaired: "))
    assert all(word in facts for word in ("milli-g", "degrees a second", "wrong way round"))
    assert next(item.linear_acceleration[2] for item in came if isinstance(item, Imu)) == pytest.approx(9.8, abs=1)


def test_a_stream_ends_when_its_devices_contradict_each_other() -> None:
    """What came until then is handed on; the reason ends it."""
    stream = MemoryStream()
    stream.send([LIES["milli-g"][0](item) for item in honest()])
    watched = CheckedSource(lambda _: stream, SourceOptions())
    came = []
    with pytest.raises(SensorError, match="milli-g"):
        came.extend(watched.items())
    assert 0 < len(came) < len(honest())
    watched.close()
    assert came[-1].stamp_ns - came[0].stamp_ns < 2 * SECOND
    honest_stream = MemoryStream()
    honest_stream.send(honest())
    honest_stream.close()
    assert len(list(CheckedSource(lambda _: honest_stream, SourceOptions()).items())) == len(honest())


def test_a_stream_whose_imu_hangs_upside_down_is_warned_of_at_rest_and_ended_by_a_turn() -> None:
    """Within two seconds the report says which way is up; once the scans turn too it is sure."""
    stream = MemoryStream()
    stream.send([LIES["upside down"][0](item) for item in honest()])
    watched = CheckedSource(lambda _: stream, SourceOptions())
    warned = next(item.stamp_ns for item in watched.items() if watched.report.warnings)
    assert warned - honest()[0].stamp_ns < 2 * SECOND
    assert (
        "mounted upside down: run again with --repair, or with --imu-rotation 3.1416 0 0"
        in watched.report.warnings[0]
    )
    with pytest.raises(SensorError, match="upside down"):
        list(watched.items())
    watched.close()


@pytest.mark.parametrize("value", [math.nan, math.inf, 1e200])
def test_damaged_samples_say_nothing_of_the_device(value: float) -> None:
    """One in fifty holds no plausible number, in a rate or a force: gravity and turns are what they were."""
    samples, damaged = 0, []
    for item in honest():
        samples += isinstance(item, Imu)
        rate, force = (value if samples % 100 == each else 1.0 for each in (0, 50))
        damaged.append(inertial([rate] * 3, [force] * 3)(item))
    found, whole = measures(damaged), measures(honest())
    assert samples > 1000
    assert found.gravity is not None
    assert whole.gravity is not None
    assert found.gravity.norm == pytest.approx(whole.gravity.norm, rel=0.01)
    assert found.gravity.steadiness == pytest.approx(whole.gravity.steadiness, rel=0.01)
    assert found.turn is not None
    assert found.turn.correlation > 0.99
