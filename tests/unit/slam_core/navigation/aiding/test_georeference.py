"""Where the map lies in the plane of the satellites."""

import math

import numpy as np
import pytest

from slam_core import geometry
from slam_core.navigation.aiding.georeference import Georeference

TURN, SHIFT = 2.1, np.array([30.0, -7.0, 4.0])


def to_plane(in_map: np.ndarray) -> np.ndarray:
    """The relation that is to be found."""
    return geometry.rotate(geometry.yaw_quaternion(TURN), in_map) + SHIFT


def test_exact_pairs_give_the_relation() -> None:
    """From three places without noise any place, vector and the map's own pose come out right."""
    found = Georeference()
    for place in np.array([[0.0, 0.0, 0.0], [5.0, 1.0, 0.5], [3.0, 8.0, 0.2]]):
        found.add_place(place, to_plane(place), 1e4)
    assert found.turn == pytest.approx(TURN)
    wanted = np.array([-4.0, 2.0, 1.0])
    np.testing.assert_allclose(found.place(to_plane(wanted))[0], wanted, atol=1e-9)
    turned = geometry.rotate(geometry.yaw_quaternion(TURN), wanted)
    np.testing.assert_allclose(found.vector(turned)[0], wanted, atol=1e-9)
    np.testing.assert_allclose(found.pose().mean, [*SHIFT[:2], TURN], atol=1e-9)


def test_nothing_is_known_while_the_robot_stands() -> None:
    """Fixes in one place tell no direction; a compass, a velocity or a way does."""
    found = Georeference()
    assert not found.turn_known
    for _ in range(50):
        found.add_place(np.zeros(3), SHIFT, 1.0)
    assert not found.known
    found.set_compass(TURN, 0.1)
    assert found.known
    assert found.turn == pytest.approx(TURN)
    moving = Georeference()
    moving.add_vector(np.array([2.0, 0.0, 0.0]), 2.0 * np.array([math.cos(TURN), math.sin(TURN), 0.0]), 100.0)
    assert moving.turn_known
    assert not moving.known
    assert moving.turn == pytest.approx(TURN)


def test_a_compass_that_is_asked_often_has_one_vote() -> None:
    """Its error lasts: a hundred readings that are 0.2 rad off do not outweigh the velocities."""
    found = Georeference()
    for _ in range(100):
        found.set_compass(TURN + 0.2, 0.1)
    for _ in range(40):
        found.add_vector(np.array([1.0, 0.0, 0.0]), np.array([math.cos(TURN), math.sin(TURN), 0.0]), 25.0)
    assert found.turn == pytest.approx(TURN, abs=0.03)


def test_the_claim_contains_the_error() -> None:
    """Over 300 noisy drives turn, place and origin err by as much as they claim, within a tenth."""
    rng, sigma, turns, places, origins = np.random.default_rng(5), 1.5, [], [], []
    way = np.column_stack([np.linspace(0, 30, 20), 5 * np.sin(np.linspace(0, 3, 20)), np.zeros(20)])
    wanted = np.array([20.0, -10.0, 0.0])
    for _ in range(300):
        found = Georeference()
        for place in way:
            found.add_place(place, to_plane(place) + sigma * rng.normal(size=3), sigma**-2)
        place, spread = found.place(to_plane(wanted))
        error = place - wanted
        turns.append(geometry.wrap(found.turn - TURN) ** 2 / found.turn_variance)
        places.append(error @ np.linalg.solve(spread, error) / 3)
        pose = found.pose()
        error = pose.mean - np.array([*SHIFT[:2], TURN])
        origins.append(error @ np.linalg.solve(pose.covariance, error) / 3)
    for ratios in (turns, places, origins):
        assert np.mean(ratios) == pytest.approx(1.0, abs=0.15)
