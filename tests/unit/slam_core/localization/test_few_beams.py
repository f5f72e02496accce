"""When the direction that few beams fix is left to inertial data."""

from dataclasses import replace

import numpy as np
import pytest

from slam_core.config import MapConfig, MatcherConfig
from slam_core.kernels.coarse_to_fine import survey
from slam_core.kernels.structures import Beams
from slam_core.localization.few_beams import CONTRADICTS, confirmed, few_mislead
from slam_core.mapping.pyramid import Pyramid
from slam_core.measurements import Float32s
from slam_core.results import FEW, MatchResult, PlanarGaussian

CONFIG, MATCHER = MapConfig(size=512), MatcherConfig()
NONE, LASER, POSE = np.empty((0, 2), np.float32), np.zeros(2), np.zeros(3)
PRIOR = PlanarGaussian(POSE, np.diag([0.02**2, 0.005**2, 1e-5]))


def passage(niche: bool, seed: int = 0) -> Float32s:
    """Endpoints on walls at y = 1 and -1, nothing ahead and behind; a niche on the left is 0.3 m deep."""
    bearings = np.concatenate([np.linspace(-np.pi / 2, -np.pi / 12, 450), np.linspace(np.pi / 12, np.pi / 2, 450)])
    c, s = np.cos(bearings), np.sin(bearings)
    ranges = 1.0 / np.abs(s)
    if niche:  # from x = 1 to x = 3
        deep, side = 1.3 / np.abs(s), 3.0 / c
        into = (s > 0) & (ranges * c > 1.0) & (ranges * c < 3.0)
        ranges = np.where(into, np.minimum(deep, side), ranges)
    ranges = ranges + np.random.default_rng(seed).normal(scale=0.005, size=len(ranges))
    return (ranges[:, None] * np.column_stack([c, s])).astype(np.float32)


def mapped(niche: bool) -> Pyramid:
    """A map of it."""
    pyramid = Pyramid(CONFIG)
    for seed in range(1, 7):
        pyramid.update(passage(niche, seed), NONE, LASER, POSE, CONFIG)
    return pyramid


def matched(x: float, share: float) -> MatchResult:
    """A match so far along x, which is its weakest direction."""
    covariance = np.diag([0.004**2, 0.001**2, 1e-6])
    pose, nothing = np.array([x, 0.0, 0.0]), np.zeros((0, 4))
    return MatchResult(pose, covariance, np.eye(3), np.zeros(1), (1,), True, nothing, np.zeros(2), share)


def shape_share(points: Float32s) -> float:
    """What the shape of a scan alone makes of the direction that it fixes worst."""
    xs, ys = points[::5].T.copy()
    return float(survey(Beams(xs, ys), 0.0)[2])


def test_a_niche_fixes_the_way_along_a_passage_once_the_map_holds_it():
    """Its side does in the scan in any case; in the map about as well then, and before not at all."""
    points = passage(niche=True)
    share = shape_share(points)
    assert share > 0.01
    assert confirmed(mapped(niche=True), points, POSE) > 0.5 * share
    assert confirmed(mapped(niche=False), points, POSE) < 0.1 * share
    assert shape_share(passage(niche=False)) < 0.004


def test_ends_that_lie_on_a_wall_along_the_direction_fix_nothing():
    """Three lone posts at the height of the wall: they hit the map, which has a straight wall there."""
    points = passage(niche=False)
    posts = np.array([[2.5, 1.0], [3.2, -1.0], [4.1, 1.0]], np.float32)
    lone = np.concatenate([points[:450], posts[1:2], posts[::2], points[450:]])
    pyramid = mapped(niche=False)
    wall = np.column_stack([np.linspace(2, 5, 400), np.repeat([-1.0, 1.0], 200)]).astype(np.float32)
    for _ in range(5):
        pyramid.update(wall, NONE, LASER, POSE, CONFIG)
    assert confirmed(pyramid, lone, POSE) < 0.5 / len(lone)


def test_few_beams_that_the_map_confirms_are_believed_where_inertial_data_agree():
    """And not where they put the robot more than three sigmas off; many beams are believed in any case."""
    points, pyramid = passage(niche=True), mapped(niche=True)
    sigma = np.hypot(0.02, 0.004)
    for off, share, expected in (
        (0.0, 0.02, False),
        (0.9 * CONTRADICTS * sigma, 0.02, False),
        (1.1 * CONTRADICTS * sigma, 0.02, True),
        (1.1 * CONTRADICTS * sigma, 1.1 * FEW, False),
    ):
        prior = PRIOR._replace(mean=np.array([off, 0.0, 0.0]))
        assert few_mislead(pyramid, points, matched(0.0, share), prior, MATCHER) == expected


@pytest.mark.parametrize("threshold", [0.0, MATCHER.degeneracy_threshold])
def test_what_the_map_does_not_hold_is_not_believed(threshold: float):
    """Unless the paper's method is asked for."""
    config = replace(MATCHER, degeneracy_threshold=threshold)
    points, pyramid = passage(niche=True), mapped(niche=False)
    assert few_mislead(pyramid, points, matched(0.0, 0.02), PRIOR, config) == (threshold > 0.0)


def test_a_direction_that_is_unobservable_already_stays_so():
    """There is nothing to match again."""
    points, pyramid = passage(niche=True), mapped(niche=False)
    held = matched(0.0, 0.001)._replace(unobservable=np.array([1.0, 0.0]))
    assert not few_mislead(pyramid, points, held, PRIOR, MATCHER)
