"""People who walk and panes of glass: where beams end, at their own time."""

import numpy as np
import pytest

from hectorscope.simulation import SceneOptions, Simulation
from hectorscope.simulation.beams import first_returns
from hectorscope.simulation.people import Gait, Person, distances, stroll
from hectorscope.simulation.scene_people import CLEAR
from slam_core.measurements import LaserScan

AHEAD = np.array([[1.0, 0.0, 0.0]])


def test_a_beam_meets_a_walker_where_he_is_at_that_moment() -> None:
    """Each beam has its own second; a tilted one is longer; who stands behind or aside is not met."""
    person = Person(lambda t: np.column_stack((2.0 + t, np.zeros(len(t)))), 0.25)
    t = np.array([0.0, 1.0, 1.0, 1.0])
    tilted = np.array([np.cos(0.3), 0.0, np.sin(0.3)])
    beams = np.vstack([AHEAD, AHEAD, tilted, -AHEAD])
    met = distances([person], np.zeros((4, 3)), beams, t)
    np.testing.assert_allclose(met, [1.75, 2.75, 2.75 / np.cos(0.3), np.inf])
    assert np.isinf(distances([person], np.array([[0.0, 0.26, 0.0]]), AHEAD, t[:1]))


def test_walkers_keep_to_their_lane_and_pace() -> None:
    """Never faster than the gait allows, never off the lane; with stops, they stand as long as they should."""
    lane, gait = np.array([(0.0, 0.0), (6.0, 0.0), (6.0, 4.0)]), Gait(stops=1.0)
    person = stroll(lane, 120.0, gait, np.random.default_rng(3))
    t = np.arange(0.0, 120.0, 0.1)
    x, y = person.way(t).T
    assert ((np.abs(y) < 1e-9) | (np.abs(x - 6.0) < 1e-9)).all()
    steps = np.hypot(np.diff(x), np.diff(y)) / 0.1
    assert gait.speed[0] < steps.max() <= gait.speed[1]
    assert 0.1 * np.count_nonzero(steps < 1e-9) > 20.0


def test_the_hall_has_walkers_and_a_companion() -> None:
    """All keep clear of the robot, one stays beside it, another seed walks otherwise, and they can be left out."""
    scene = Simulation("people", SceneOptions(seed=2)).scene
    t = np.arange(0.0, scene.motion.duration, 0.1)
    away = [np.linalg.norm(p.way(t) - scene.motion.at(t)[:, :2], axis=1) for p in scene.people]
    assert min(a.min() for a in away) > CLEAR - 0.05
    assert away[-1].max() < 1.0
    other = Simulation("people", SceneOptions(seed=3)).scene
    assert not np.allclose(other.people[0].way(t), scene.people[0].way(t))
    assert not Simulation("people", SceneOptions(people=False)).scene.people


def test_people_are_seen() -> None:
    """With them some beams are shorter and none is longer."""
    crowd, empty = (
        next(
            item
            for item in Simulation("people", SceneOptions(people=p, noise=0.0)).items()
            if isinstance(item, LaserScan)
        )
        for p in (True, False)
    )
    shorter = crowd.ranges < empty.ranges - 0.05
    assert 10 < shorter.sum() < 500
    np.testing.assert_array_equal(crowd.ranges[~shorter], empty.ranges[~shorter])


@pytest.mark.parametrize(("degrees", "low", "high"), [(0.0, 0.98, 1.0), (12.0, 0.35, 0.45), (30.0, 0.0, 0.06)])
def test_glass_returns_what_meets_it_head_on(degrees: float, low: float, high: float) -> None:
    """The share that comes back from the pane 7 m to the left falls with the angle; the rest ends behind it."""
    scene = Simulation("glass").scene
    angles = np.full(2000, np.pi / 2 - np.radians(degrees))
    ranges, _ = first_returns(scene, np.zeros(2000), angles, 30.0, np.random.default_rng(1))
    pane = 7.0 / np.cos(np.radians(degrees))
    returned = np.abs(ranges - pane) < 1e-6
    assert low <= returned.mean() <= high
    assert (ranges[~returned] > pane + 1.0).all()
