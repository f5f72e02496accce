"""Each correction against finite differences of what it says that it measures, and its lasting error."""

import math

import numpy as np
import pytest

from slam_core import geometry
from slam_core.kernels.navigation import ERRORS, inject
from slam_core.navigation.aiding.sensors import (
    Gravity,
    GroundBeam,
    MagneticHeading,
    Place,
    Standstill,
    Tilt,
    Velocity,
    ZeroRate,
)
from slam_core.navigation.corrections import Correction

FIELD = np.array([1.5e-5, 0.8e-5, -4e-5])
UP = np.array([0.0, 0.0, 1.0])
DOWN = np.array([0.1, 0.0, -0.995])


def state(tilt: float) -> np.ndarray:
    """Somewhere, turned by a heading of 1 and tilted; moving; with biases."""
    x = np.random.default_rng(2).normal(size=19)
    x[:4] = geometry.from_euler(tilt, -tilt, 1.0)
    x[10:16] *= 0.01
    return x


def corrections(x: np.ndarray) -> list[Correction]:
    """One of each kind, near what the state predicts."""
    up = geometry.rotation_matrix(x[:4])[2]
    return [
        Place(x[4:7], np.eye(3), np.array([0.3, -0.2, 1.0]), 1.0, 0.0),
        Velocity(x[7:10], np.eye(3), 1.0, 0.0),
        MagneticHeading(FIELD, 0.4, 0.01, 1.0, 0.0),
        Tilt(up, 0.02, 1.0, 0.0),
        GroundBeam(1.3, np.array([0.1, 0.2, 0.3]), DOWN, -1.0, 0.05, 1.0, 0.0),
        Standstill(1e-4, 0.0),
        ZeroRate(np.array([0.01, 0.0, 0.02]), 1e-6, 0.0),
        Gravity(9.8 * up + x[13:16], 1e-2, 0.0),
    ]


@pytest.mark.parametrize("kind", range(8))
@pytest.mark.parametrize("tilt", [0.0, 0.3])
def test_it_is_linearised_rightly(kind: int, tilt: float) -> None:
    """The innovation falls as C says when the state's errors are put right, one after the other."""
    x = state(tilt)
    correction = corrections(x)[kind]
    _, C, R = correction.observe(x)

    def innovation(error: np.ndarray) -> np.ndarray:
        return correction.observe(inject(x, error))[0]

    step = 1e-6
    slopes = [(innovation(-step * e) - innovation(step * e)) / (2 * step) for e in np.eye(ERRORS)]
    np.testing.assert_allclose(np.array(slopes).T, C, atol=1e-5)
    assert R.shape == (len(C), len(C))
    assert correction.usable


@pytest.mark.parametrize("aid", [Tilt(UP, 1e-3, 1.0, 0.0), Gravity(9.8 * UP, 1e-4, 0.0)])
def test_a_direction_of_up_levels_the_belief(aid: Correction) -> None:
    """A belief that leans by 0.1 rad is put upright by an attitude or a force that says so, its heading kept."""
    x = np.zeros(19)
    x[:4] = geometry.multiply(
        geometry.from_rotation_vector(np.array([0.1, -0.05, 0.0])), geometry.yaw_quaternion(1)
    )
    certain = np.diag(np.repeat([1.0, 1e-9], [12, 3]))
    better = aid.update(x, certain).x
    np.testing.assert_allclose(geometry.rotation_matrix(better[:4])[2], UP, atol=1e-3)
    assert geometry.heading(better[:4]) == pytest.approx(1.0, abs=5e-3)


def test_north_ahead_turns_the_belief() -> None:
    """A field that points along the base's x, where north is y of the map, means a heading of 90 degrees."""
    x = np.zeros(19)
    x[:4] = geometry.yaw_quaternion(1.3)
    heading = MagneticHeading(np.array([2e-5, 0.0, 0.0]), math.pi / 2, 1e-6, 1.0, 0.0)
    better = heading.update(x, np.eye(ERRORS)).x
    assert geometry.heading(better[:4]) == pytest.approx(math.pi / 2, abs=1e-3)


def test_an_error_that_lasts_counts_by_its_share_and_is_gated_as_it_is() -> None:
    """A hundred fixes with a hundredth of news each weigh like one; 50 m off is rejected whatever the share."""
    x, P = np.zeros(19), np.eye(ERRORS)
    x[0] = 1.0
    off = np.array([1.0, 0.0, 0.0])
    once = Place(off, np.eye(3), np.zeros(3), 1.0, 5.0).update(x, P)
    y, Q = x, P
    for _ in range(100):
        update = Place(off, np.eye(3), np.zeros(3), 0.01, 5.0).update(y, Q)
        y, Q = update.x, update.P
    np.testing.assert_allclose(y, once.x, atol=1e-9)
    np.testing.assert_allclose(Q, once.P, atol=1e-9)
    jump = Place(50.0 * off, np.eye(3), np.zeros(3), 0.001, 5.0).update(x, P)
    assert not jump.accepted
    assert np.array_equal(jump.x, x)
    assert not Place(off, np.eye(3), np.zeros(3), 0.0, 5.0).usable
