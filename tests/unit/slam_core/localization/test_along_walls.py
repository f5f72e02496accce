"""How far along a passage a scan fits, by the number of its beams that do."""

import numpy as np
import pytest

from slam_core.config import MapConfig, SlamConfig
from slam_core.localization.along_walls import LEAST_SIGMA, NEAREST, best_along, measured
from slam_core.localization.few_beams import few_as_none
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.matcher import coarse_to_fine
from slam_core.measurements import Float32s
from slam_core.results import MatchResult, PlanarGaussian

CONFIG = MapConfig(size=1024)
NONE, LASER, POSE = np.empty((0, 2), np.float32), np.zeros(2), np.zeros(3)
AHEAD, AROUND = np.linspace(-2.35, 2.35, 1081), np.linspace(-np.pi, np.pi, 1440, endpoint=False)
REACH, DEPTH = 10.0, 0.12  # metres
BOXES = ((2.5, 3.4), (-3.0, -2.1))


def passage(x: float, seed: int = 0, boxes=BOXES, reach: float = REACH, bearings=AHEAD) -> Float32s:
    """Endpoints seen from x on walls at y = 1 and -1; on the right one shallow boxes, from where to where."""
    c, s = np.cos(bearings), np.sin(bearings)
    with np.errstate(divide="ignore", invalid="ignore"):
        ranges = np.minimum(1.0 / np.abs(s), 1e3)
        for begin, end in boxes:
            for face in (begin - x, end - x):
                to_face = face / c
                y = to_face * s
                ranges = np.where(
                    (to_face > 0) & (y <= DEPTH - 1) & (y >= -1), np.minimum(ranges, to_face), ranges
                )
            to_side = (DEPTH - 1) / s
            along = to_side * c
            hit = (to_side > 0) & (along >= begin - x) & (along <= end - x)
            ranges = np.where(hit, np.minimum(ranges, to_side), ranges)
    ranges = ranges + np.random.default_rng(seed).normal(scale=0.01, size=len(ranges))
    return (ranges[:, None] * np.column_stack([c, s]))[ranges < reach].astype(np.float32)


def mapped(boxes=BOXES, reach: float = REACH, bearings=AHEAD) -> Pyramid:
    """A map of it, seen from the origin."""
    pyramid = Pyramid(CONFIG)
    for seed in range(1, 7):
        pyramid.update(passage(0.0, seed, boxes, reach, bearings), NONE, LASER, POSE, CONFIG)
    return pyramid


def left_open(pyramid: Pyramid, points: Float32s) -> MatchResult:
    """A match of a scan from the origin, which leaves the way along the passage open."""
    config = few_as_none(SlamConfig()).matcher
    match = coarse_to_fine(pyramid, points, POSE, config, prior=predicted(0.5))
    assert abs(match.unobservable[0]) > 0.99
    return match


def predicted(sigma: float) -> PlanarGaussian:
    """At the origin, with a standard deviation along the passage, metres."""
    return PlanarGaussian(POSE, np.diag([sigma**2, 0.01**2, 1e-5]))


@pytest.mark.parametrize("x", [-0.1, 0.0, 0.25, 0.7])
def test_shallow_boxes_tell_the_way(x):
    """Wherever the robot is within reach, to a decimetre; their faces are less than a hundredth of the beams."""
    pyramid, points = mapped(), passage(x)
    along = best_along(pyramid, points, left_open(pyramid, points), predicted(0.5))
    assert along is not None and along.is_observed
    assert along.offset[0] == pytest.approx(x, abs=0.1)
    assert along.sigma >= LEAST_SIGMA


def test_bare_walls_tell_nothing():
    """Every place along them is as good."""
    pyramid, points = mapped(boxes=()), passage(0.3, boxes=())
    assert best_along(pyramid, points, left_open(pyramid, points), predicted(0.5)) is None


def test_what_the_map_does_not_hold_yet_draws_nothing_back():
    """Where the map ends beams end on unknown cells: these count for the place nearly as much as hits."""
    pyramid, points = mapped((), 4.0, AROUND), passage(0.5, 0, (), 4.0, AROUND)
    assert best_along(pyramid, points, left_open(pyramid, points), predicted(0.5)) is None


def test_somebody_before_the_robot_does_not_draw_it_out_of_the_map():
    """Beams that the map does not hold count less than misses: of a scan with a tenth of them nothing is told."""
    pyramid, points = mapped((), 3.0), passage(0.0, 0, (), 3.0)
    match = left_open(pyramid, points)
    bearings = np.arctan2(points[:, 1], points[:, 0])
    points[(bearings > np.radians(20)) & (bearings < np.radians(40))] *= 0.8
    assert best_along(pyramid, points, match, predicted(1.0)) is None


def test_among_many_that_miss_a_few_beams_are_chance():
    """A crowd stops a sixth of the beams: no place between bare walls is observed, next to none is better."""
    pyramid, told = mapped(boxes=()), []
    for seed in range(8):
        points, rng = passage(0.3, boxes=()), np.random.default_rng(seed)
        match = left_open(pyramid, points)
        for first in rng.integers(0, len(points) - 15, 12):
            points[first : first + 15] *= rng.uniform(0.3, 0.7)
        told.append(best_along(pyramid, points, match, predicted(0.5)))
    better = [each for each in told if each is not None]
    assert len(better) <= 1 and not any(each.is_observed for each in better)


def test_a_robot_that_backs_out_of_its_map_is_not_held():
    """A tenth of the beams end where it was never seen; fewer than at the start miss what is there."""
    pyramid, points = mapped(), passage(-0.4)
    along = best_along(pyramid, points, left_open(pyramid, points), predicted(0.5))
    assert along is None or along.offset[0] == pytest.approx(-0.4, abs=0.1)


def test_a_sure_prediction_is_not_left():
    """The true place, half a metre off, is 25 sigmas from it."""
    pyramid, points = mapped(), passage(0.5)
    along = best_along(pyramid, points, left_open(pyramid, points), predicted(0.02))
    assert along is None or abs(along.offset[0]) <= NEAREST


def test_a_match_takes_over_what_was_told():
    """Its open direction has the sigma of the best places then; without one the match stays as it is."""
    pyramid, points = mapped(), passage(0.25)
    match = left_open(pyramid, points)
    along = best_along(pyramid, points, match, predicted(0.5))
    assert along is not None
    told = measured(match, along)
    assert not told.leaves_direction
    assert np.linalg.eigvalsh(told.covariance).min() > 0
    direction = match.unobservable
    assert direction @ told.covariance[:2, :2] @ direction == pytest.approx(along.sigma**2, rel=0.01)
    assert measured(match, along._replace(sigma=np.inf)) is match
    closed = match._replace(unobservable=np.zeros(2))
    assert measured(closed, along) is closed
