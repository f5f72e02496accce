"""Measurements without a usable value are counted and left out before they reach an estimate."""

import math
from dataclasses import replace

import numpy as np
import pytest

from slam_core import HectorSlam, StepResult
from slam_core.measurements import (
    Aid,
    Attitude,
    GpsPosition,
    GpsVelocity,
    GroundDistance,
    Height,
    LaserScan,
    MagneticField,
    Odometry,
)
from slam_core.navigation.aiding.plausibility import SOURCES, is_plausible

DOWN = np.array([0.0, 0.0, -1.0])
LEVEL = np.array([1.0, 0.0, 0.0, 0.0])
ZEROS = np.zeros(3)
GOOD: tuple[Aid, ...] = (
    Attitude(1, LEVEL),
    Odometry(1, np.array([1.0, 0.0]), 0.1),
    Height(1, 2.0),
    GroundDistance(1, 0.5, ZEROS, DOWN),
    MagneticField(1, np.array([2e-5, 0.0, -4e-5])),
    GpsPosition(1, ZEROS, None, ZEROS),
    GpsPosition(1, ZEROS, np.eye(3), ZEROS),
    GpsVelocity(1, ZEROS),
)
BAD: tuple[Aid, ...] = (
    Attitude(1, np.zeros(4)),
    Odometry(1, np.array([1.0, 1e200]), 0.1),
    Odometry(1, np.array([1.0, 0.0]), math.nan),
    Height(1, math.inf),
    GroundDistance(1, -1.0, ZEROS, DOWN),
    GroundDistance(1, 1.0, ZEROS, ZEROS),
    MagneticField(1, ZEROS),
    GpsPosition(1, np.array([0.0, math.inf, 0.0]), None, ZEROS),
    GpsPosition(1, ZEROS, np.zeros((3, 3)), ZEROS),
    GpsPosition(1, ZEROS, np.diag([1.0, -1.0, 1.0]), ZEROS),
    GpsVelocity(1, np.array([math.nan, 0.0, 0.0])),
)


@pytest.mark.parametrize("aid", GOOD, ids=lambda aid: type(aid).__name__)
def test_usual_values_are_plausible(aid: Aid) -> None:
    """What each sensor measures as a rule is used."""
    assert is_plausible(aid)


@pytest.mark.parametrize("aid", BAD, ids=lambda aid: type(aid).__name__)
def test_a_value_that_cannot_be_is_counted_and_changes_nothing(aid: Aid) -> None:
    """It is not plausible, counts for its source, and the poses of the run are the same without it."""
    assert not is_plausible(aid)
    ranges = np.full(90, 2.0, np.float32)
    runs = []
    for aids in ((), (aid,)):
        slam, results = HectorSlam(), list[StepResult]()
        for stamp_ns in (0, 100_000_000, 200_000_000):
            results += slam.add(LaserScan(stamp_ns, ranges, -math.pi, math.pi / 45))
            for each in aids:
                results += slam.add(replace(each, stamp_ns=stamp_ns + 50_000_000))
        results += slam.finish()
        runs.append((slam.trajectory.positions.tobytes(), results[-1].aiding))
    assert runs[0][0] == runs[1][0]
    assert [status.source for status in runs[1][1] if status.dropped] == [SOURCES[type(aid)]]
