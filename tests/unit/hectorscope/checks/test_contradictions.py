"""Accounts of one motion, compared."""

import math

import numpy as np
import pytest

from hectorscope.checks.contradictions import compare_tilts, compare_turns, gravity, yaw_rates
from slam_core import geometry
from slam_core.measurements import Float64s

IMU_TIMES = np.arange(0.0, 20.0, 0.01)
SCAN_TIMES = np.arange(0.03, 20.0, 0.1)


def heading(times: Float64s) -> Float64s:
    """A robot that turns to and fro."""
    return 0.8 * np.sin(1.1 * times) + 0.3 * np.sin(2.9 * times)


def turning(times: Float64s) -> Float64s:
    """The derivative of the heading."""
    return 0.88 * np.cos(1.1 * times) + 0.87 * np.cos(2.9 * times)


@pytest.mark.parametrize(("factor", "lag"), [(1.0, 0.0), (57.3, 0.2), (-1.0, -0.13), (-0.5, 0.4)])
def test_factor_sign_and_lag_of_a_turn_are_found(factor: float, lag: float) -> None:
    """With noise and a bias of the gyroscope: the ratio within 5 %, the lag within a step."""
    noise = np.random.default_rng(1)
    rates = factor * (turning(IMU_TIMES) + noise.normal(0.02, 0.05, len(IMU_TIMES)))
    yaw = heading(SCAN_TIMES - lag) + noise.normal(0.0, 0.003, len(SCAN_TIMES))
    found = compare_turns(SCAN_TIMES, yaw, IMU_TIMES, rates)
    assert found is not None
    assert found.correlation * math.copysign(1.0, factor) > 0.97
    assert found.ratio == pytest.approx(abs(factor), rel=0.05)
    assert found.lag == pytest.approx(lag, abs=0.011)
    assert 30 <= found.spans <= 40


def test_headings_that_are_not_known_are_left_out() -> None:
    """Where the pose was lost there is NaN: it takes part in no span."""
    yaw = heading(SCAN_TIMES)
    yaw[50:80] = np.nan
    found = compare_turns(SCAN_TIMES, yaw, IMU_TIMES, turning(IMU_TIMES))
    assert found is not None
    assert found.correlation > 0.99
    assert compare_turns(SCAN_TIMES, np.full(len(yaw), np.nan), IMU_TIMES, turning(IMU_TIMES)) is None


def test_a_match_that_jumps_hides_no_device() -> None:
    """With jumps of half a radian in a few places the ratio and the lag are found as well as without."""
    yaw = heading(SCAN_TIMES - 0.1)
    for k, jump in ((60, 0.5), (90, -0.6), (130, 0.5)):
        yaw[k:] += jump
    found = compare_turns(SCAN_TIMES, yaw, IMU_TIMES, 57.3 * turning(IMU_TIMES))
    assert found is not None
    assert found.correlation > 0.97
    assert found.ratio == pytest.approx(57.3, rel=0.05)
    assert found.lag == pytest.approx(0.1, abs=0.011)


def test_independent_turns_do_not_agree() -> None:
    """Noise against noise stays far from a correlation that anybody would believe."""
    noise = np.random.default_rng(2)
    rates, yaw = noise.normal(size=len(IMU_TIMES)), noise.normal(size=len(SCAN_TIMES))
    found = compare_turns(SCAN_TIMES, yaw, IMU_TIMES, rates)
    assert found is not None
    assert abs(found.correlation) < 0.5


def test_gravity_has_a_norm_a_direction_and_a_steadiness() -> None:
    """The norm of the median in whatever unit; a device turned over half the time is not steady."""
    forces = np.random.default_rng(3).normal([0.0, 0.0, -1000.0], 50.0, (200, 3))
    measured = gravity(forces)
    assert measured.norm == pytest.approx(1000.0, rel=0.02)
    assert measured.up[2] < -0.99
    assert measured.steadiness > 0.99
    forces[::2] *= -1.0
    turned = gravity(forces)
    assert turned.steadiness < 0.2
    nothing = gravity(np.zeros((5, 3)))
    assert nothing.norm == nothing.steadiness == 0.0


@pytest.mark.parametrize("roll", [0.0, math.pi, math.pi / 2])
def test_the_turn_about_gravity_does_not_depend_on_the_mounting(roll: float) -> None:
    """However the device sits on the robot, its turn about up is the robot's."""
    mounted = geometry.conjugate(geometry.from_euler(roll, 0.0, 0.0))
    rates = np.column_stack([np.zeros((len(IMU_TIMES), 2)), turning(IMU_TIMES)])
    forces = np.tile([0.0, 0.0, 9.81], (len(IMU_TIMES), 1))
    measured = yaw_rates(IMU_TIMES, geometry.rotate(mounted, rates), geometry.rotate(mounted, forces))
    np.testing.assert_allclose(measured, turning(IMU_TIMES), atol=1e-9)


@pytest.mark.parametrize("factor", [1.0, 57.3, -1.0])
def test_gravity_moves_against_the_turn_of_the_device(factor: float) -> None:
    """A device that rolls to and fro: the ratio and the sign of its gyroscope show without any scan."""
    roll, rate = 0.5 * np.sin(2.0 * IMU_TIMES), np.cos(2.0 * IMU_TIMES)
    forces = 9.81 * np.column_stack([np.zeros(len(roll)), np.sin(roll), np.cos(roll)])
    rates = factor * np.column_stack([rate, np.zeros((len(rate), 2))])
    found = compare_tilts(IMU_TIMES, rates, forces)
    assert found is not None
    assert found.correlation * math.copysign(1.0, factor) > 0.99
    assert found.ratio == pytest.approx(abs(factor), rel=0.05)
