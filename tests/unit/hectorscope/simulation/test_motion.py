"""The true motion and what an ideal inertial unit feels of it."""

import numpy as np
import pytest

from hectorscope.simulation import ScenarioName, SceneOptions, Simulation
from hectorscope.simulation.motion import GRAVITY, Motion, rotations
from slam_core.geometry import from_rotation_vector, multiply, rotation_matrix

SCENARIOS: tuple[ScenarioName, ...] = ("arena", "littoral", "handheld", "rooms", "corridor")


def wavy() -> Motion:
    """Every channel moves, at frequencies of its own."""
    rates = np.array([0.9, 1.3, 2.1, 3.0, 2.2, 0.7])
    return Motion.through(lambda t: np.sin(np.outer(t, rates) + rates), 4.0)


@pytest.mark.parametrize("derivative", [1, 2])
def test_derivatives(derivative: int) -> None:
    """Each derivative is the slope of the one below, everywhere, across the joints of the spline too."""
    motion, t, h = wavy(), np.linspace(0.01, 3.99, 1000), 1e-5
    slope = (motion.at(t + h, derivative - 1) - motion.at(t - h, derivative - 1)) / (2 * h)
    np.testing.assert_allclose(motion.at(t, derivative), slope, atol=1e-6)


def test_straight_lines_are_kept() -> None:
    """A uniform motion goes through the spline unchanged."""
    line = np.array([1.0, -2.0, 0.5, 0.1, 0.0, 3.0])
    motion = Motion.through(lambda t: np.outer(t - 1.0, line), 2.0)
    t = np.linspace(0.0, 2.0, 101)
    np.testing.assert_allclose(motion.at(t), np.outer(t - 1.0, line), atol=1e-12)


def test_body_rates_turn_the_attitude() -> None:
    """R(t + h) = R(t) exp(omega h), with omega taken in the middle of the step."""
    motion, t, h = wavy(), np.linspace(0.1, 3.8, 50), 1e-4
    before, after = motion.poses(t)[1], motion.poses(t + h)[1]
    omega = motion.body_rates(t + h / 2)
    turned = [R @ rotation_matrix(from_rotation_vector(w * h)) for R, w in zip(before, omega, strict=True)]
    np.testing.assert_allclose(after, turned, atol=1e-10)


def test_specific_force_at_rest_is_gravity_upwards() -> None:
    """A tilted unit at rest feels g along the vertical of the map, seen in its own axes."""
    motion = Motion.through(lambda t: np.tile([1.0, 2.0, 3.0, 0.2, -0.1, 1.0], (len(t), 1)), 1.0)
    R = rotations(np.array([[0.2, -0.1, 1.0]]))[0]
    np.testing.assert_allclose(motion.specific_force(np.array([0.5]))[0], R.T @ [0, 0, GRAVITY], atol=1e-9)


@pytest.mark.parametrize("scenario", SCENARIOS)
def test_strapdown_integration_of_ideal_sensors_gives_truth_back(scenario: ScenarioName) -> None:
    """Rates and specific force, integrated in steps of 1 ms without noise, end where the truth is."""
    motion = Simulation(scenario, SceneOptions(duration=15.0)).scene.motion
    dt = 1e-3
    middles = (np.arange(round(motion.duration / dt)) + 0.5) * dt
    start = motion.transform(0.0)
    q, p, v = start.rotation, start.translation, motion.at(np.zeros(1), 1)[0, :3]
    for omega, force in zip(motion.body_rates(middles), motion.specific_force(middles), strict=True):
        half = multiply(q, from_rotation_vector(omega * dt / 2))
        a = rotation_matrix(half) @ force - np.array([0.0, 0.0, GRAVITY])
        p, v = p + v * dt + 0.5 * a * dt * dt, v + a * dt
        q = multiply(q, from_rotation_vector(omega * dt))
    end = motion.transform(motion.duration)
    np.testing.assert_allclose(p, end.translation, atol=2e-3)
    np.testing.assert_allclose(rotation_matrix(q), rotation_matrix(end.rotation), atol=1e-5)
