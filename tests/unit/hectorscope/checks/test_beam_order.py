"""Which beam of a scan is measured first, by how well the scans fit."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from hectorscope.checks.beam_order import BeamOrder
from hectorscope.checks.findings import findings
from hectorscope.checks.sensor_check import CheckedSource
from hectorscope.checks.sensor_statistics import SensorStatistics
from hectorscope.inputs import Item, SourceOptions
from hectorscope.ros.repairs import Repairs
from hectorscope.simulation import SceneOptions, Simulation
from slam_core.measurements import LaserScan
from tests.sources import MemoryRecording

SWEEP_S = 0.075


@cache
def drive(rate: float = 10.0) -> Sequence[Item]:
    """Half a minute, with the times of the beams and inertial data."""
    return tuple(Simulation("rooms", SceneOptions(duration=30.0, scan_rate=rate, beams=271)).items())


def scans(rate: float = 10.0) -> Sequence[LaserScan]:
    """Those of the drive, without other sensors."""
    return [item for item in drive(rate) if isinstance(item, LaserScan)]


def turned(scan: LaserScan) -> LaserScan:
    """As of a driver that turns the ranges of a laser round that spins clockwise, and leaves its times."""
    n = len(scan.ranges)
    last = scan.angle_min + (n - 1) * scan.angle_increment
    return replace(scan, ranges=scan.ranges[::-1].copy(), angle_min=last, angle_increment=-scan.angle_increment)


def measured(items: Iterable[Item]) -> BeamOrder | None:
    statistics = SensorStatistics()
    for item in items:
        statistics.take(item)
    return statistics.measures().order


def test_scans_in_the_order_of_their_times_are_left_alone() -> None:
    """Of a drive with turns it is sure that the first beam is the first."""
    order = measured(scans())
    assert order is not None
    assert order.is_sure
    assert not order.is_reversed


@pytest.mark.parametrize("given", [scans, drive])
def test_scans_whose_last_beam_is_the_first_are_found(given: Callable[[], Sequence[Item]]) -> None:
    """The flag is the negative duration of the sweep, and mends it. So it is beside a gyroscope."""

    def opened(options: SourceOptions) -> MemoryRecording:
        repair = Repairs(options).scan
        return MemoryRecording([repair(turned(each)) if isinstance(each, LaserScan) else each for each in given()])

    checked = CheckedSource(opened, SourceOptions())
    assert list(checked.items())
    (found,) = checked.report.findings
    assert found.options == {"scan_sweep": pytest.approx(-SWEEP_S, abs=0.001)}
    assert not found.grave
    assert "run again with --repair, or with --scan-sweep -0.07" in checked.report.warnings[0]
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


def test_a_robot_at_rest_shows_no_order() -> None:
    """Noise alone makes neither order fit better."""
    noise = np.random.default_rng(1)
    first = scans()[0]
    still = [
        replace(
            first,
            stamp_ns=first.stamp_ns + k * 100_000_000,
            ranges=first.ranges + noise.normal(0.0, 0.01, len(first.ranges)).astype(np.float32),
        )
        for k in range(300)
    ]
    order = measured(still)
    assert order is not None
    assert not order.is_sure


def test_short_sweeps_and_scans_without_times_are_not_compared() -> None:
    """They are matched in neither order where nothing else measures a turn."""
    assert measured(scans(40.0)) is None
    assert measured([replace(scan, time_increment=0.0) for scan in scans()]) is None


def test_few_scans_show_nothing() -> None:
    """Of seven seconds no order is told."""
    assert measured(scans()[:70]) is None
