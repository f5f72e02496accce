"""When the beams of a sweep are measured, by how well the scans of a robot that turns fit."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from hectorscope.checks.beam_times import BeamTimes
from hectorscope.checks.findings import findings
from hectorscope.checks.sensor_check import CheckedSource
from hectorscope.checks.sensor_statistics import SensorStatistics
from hectorscope.inputs import Item, SourceOptions
from hectorscope.ros.repairs import Repairs, with_sweep
from hectorscope.simulation import SceneOptions, Simulation
from slam_core.measurements import LaserScan
from tests.sources import MemoryRecording

SWEEP_S = 0.075  # three quarters of a circle, in the time of three quarters of a period


@cache
def drive(scene: str = "rooms", rate: float = 10.0, *, timed: bool = True) -> Sequence[Item]:
    """Half a minute, with inertial data. timed: each beam leaves at its own time, in place of all at once."""
    options = SceneOptions(duration=30.0, scan_rate=rate, beams=271, beam_timing=timed)
    return tuple(Simulation(scene, options).items())


def scans(scene: str = "rooms", rate: float = 10.0) -> list[LaserScan]:
    """Those of the drive, without other sensors."""
    return [item for item in drive(scene, rate) if isinstance(item, LaserScan)]


def turned(scan: LaserScan) -> LaserScan:
    """As of a driver that turns the ranges of a laser round that spins clockwise, and leaves its times."""
    return replace(with_sweep(scan, -1.0), time_increment=scan.time_increment)


def untimed(scan: LaserScan) -> LaserScan:
    """As of a driver that leaves time_increment out."""
    return replace(scan, time_increment=0.0)


def measured(items: Iterable[Item]) -> BeamTimes | None:
    statistics = SensorStatistics()
    for item in items:
        statistics.take(item)
    return statistics.measures().times


@pytest.mark.parametrize("scene", ["rooms", "arena", "handheld"])
def test_scans_in_the_order_of_their_times_are_left_alone(scene: str) -> None:
    """Of a drive with turns it is sure that the first beam is the first."""
    times = measured(scans(scene))
    assert times is not None
    assert times.is_sure
    assert not times.are_wrong


@pytest.mark.parametrize("scene", ["rooms", "arena", "handheld"])
@pytest.mark.parametrize(
    ("changed", "sweep_s"),
    [
        (turned, -SWEEP_S),
        (untimed, SWEEP_S),
        (lambda scan: untimed(turned(scan)), -SWEEP_S),
    ],
    ids=["turned round", "without times", "both"],
)
def test_scans_that_are_timed_wrongly_are_found(
    scene: str, changed: Callable[[LaserScan], LaserScan], sweep_s: float
) -> None:
    """Also of a base that sways, and nearly to the duration of the sweep."""
    times = measured(map(changed, scans(scene)))
    assert times is not None
    assert times.are_wrong
    assert times.sweep_s == pytest.approx(sweep_s, abs=0.02)


@pytest.mark.parametrize("scene", ["rooms", "arena", "handheld", "people", "glass", "offices"])
def test_a_laser_that_measures_all_at_once_is_not_given_a_sweep(scene: str) -> None:
    """As of a depth camera, or a simulator."""
    times = measured(item for item in drive(scene, timed=False) if isinstance(item, LaserScan))
    assert times is None or not times.are_wrong


@pytest.mark.parametrize("with_imu", [False, True])
@pytest.mark.parametrize("changed", [turned, untimed])
def test_what_is_found_mends_the_scans(changed: Callable[[LaserScan], LaserScan], *, with_imu: bool) -> None:
    """The flag is the duration of the sweep; of one beside a gyroscope no delay is found."""
    items = drive() if with_imu else scans()

    def opened(options: SourceOptions) -> MemoryRecording:
        repair = Repairs(options).scan
        return MemoryRecording([repair(changed(each)) if isinstance(each, LaserScan) else each for each in items])

    checked = CheckedSource(opened, SourceOptions())
    assert list(checked.items())
    (found,) = checked.report.findings
    sweep_s = -SWEEP_S if changed is turned else SWEEP_S
    assert found.options == {"scan_sweep": pytest.approx(sweep_s, abs=0.001)}
    assert not found.grave
    assert f"run again with --repair, or with --scan-sweep {sweep_s:.2g}"[:-1] in checked.report.warnings[0]
    assert "imu" not in checked.report.warnings[0]
    assert checked.repair()
    came = [item for item in checked.items() if isinstance(item, LaserScan)]
    assert not checked.report.findings
    np.testing.assert_array_equal(came[5].ranges, scans()[5].ranges)


def test_a_stated_sweep_is_not_doubted() -> None:
    """What a person says of the times of the beams is believed."""
    statistics = SensorStatistics()
    for scan in scans():
        statistics.take(turned(scan))
    measures = statistics.measures()
    assert len(findings(measures, SourceOptions())) == 1
    assert findings(measures, SourceOptions(scan_sweep=SWEEP_S)) == []


@pytest.mark.parametrize("changed", [turned, untimed])
def test_a_robot_at_rest_shows_no_times(changed: Callable[[LaserScan], LaserScan]) -> None:
    """Noise alone makes no duration fit better."""
    noise = np.random.default_rng(1)
    first = changed(scans()[0])
    still = [
        replace(
            first,
            stamp_ns=first.stamp_ns + k * 100_000_000,
            ranges=first.ranges + noise.normal(0.0, 0.01, len(first.ranges)).astype(np.float32),
        )
        for k in range(300)
    ]
    assert measured(still) is None


@pytest.mark.parametrize("changed", [lambda scan: scan, untimed], ids=["timed", "untimed"])
def test_short_sweeps_are_not_compared(changed: Callable[[LaserScan], LaserScan]) -> None:
    """At 40 Hz the bend is less than that by motions which a laser alone does not observe."""
    assert measured(map(changed, scans(rate=40.0))) is None


def test_few_scans_show_nothing() -> None:
    """Of seven seconds, with few turns, no times are told."""
    assert measured(scans()[:70]) is None


def test_what_was_found_is_the_same_if_it_was_asked_for_before() -> None:
    """A check asks every few seconds, `inspect` once."""
    given = [untimed(scan) for scan in scans()]
    statistics = SensorStatistics()
    for number, scan in enumerate(given):
        statistics.take(scan)
        if number % 40 == 39:
            statistics.measures()
    assert statistics.measures().times == measured(given)
