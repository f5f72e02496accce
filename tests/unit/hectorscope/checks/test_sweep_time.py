"""The duration of a sweep, estimated by how well the scans fit."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import pytest

from hectorscope.checks.sweep_time import estimate
from hectorscope.simulation import SceneOptions, Simulation
from slam_core.measurements import LaserScan

PERIOD_S = 0.1


@cache
def scans(begin: float) -> Sequence[LaserScan]:
    """Twenty seconds of a drive, with the times of their beams."""
    items = Simulation(
        "rooms", SceneOptions(begin=begin, duration=begin + 20.0, scan_rate=10.0, beams=541)
    ).items()
    return [item for item in items if isinstance(item, LaserScan)]


def untimed(known: Sequence[LaserScan]) -> list[LaserScan]:
    """As of a driver that leaves time_increment out."""
    return [replace(scan, time_increment=0.0) for scan in known]


def test_the_sweep_of_a_robot_that_turns_is_found() -> None:
    """Three quarters of a circle take three quarters of the period."""
    known = scans(5.0)
    found = estimate(untimed(known), PERIOD_S)
    assert found is not None
    assert found.is_clear
    assert found.seconds == pytest.approx((known[0].end_ns - known[0].stamp_ns) * 1e-9, abs=0.02)


def test_a_laser_that_turns_the_other_way_is_found() -> None:
    """A driver that turns the order of the beams round shows as a negative duration."""
    back = [
        replace(
            scan,
            ranges=scan.ranges[::-1].copy(),
            angle_min=scan.angle_min + (len(scan.ranges) - 1) * scan.angle_increment,
            angle_increment=-scan.angle_increment,
        )
        for scan in untimed(scans(5.0))
    ]
    found = estimate(back, PERIOD_S)
    assert found is not None
    assert found.is_clear
    assert found.seconds == pytest.approx(-0.075, abs=0.02)


def test_scans_that_are_taken_at_once_give_no_duration() -> None:
    """Of a robot at rest no duration fits better."""
    found = estimate(untimed(scans(5.0)[:1]) * 60, PERIOD_S)
    assert found is not None
    assert not found.is_clear


def test_scans_with_times_are_not_estimated() -> None:
    """What the messages state is believed; few scans show nothing."""
    assert estimate(scans(5.0), PERIOD_S) is None
    assert estimate(untimed(scans(5.0))[:20], PERIOD_S) is None
