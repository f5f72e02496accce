"""Somebody who comes towards a robot in a corridor, and its match."""

import numpy as np
import pytest

from slam_core import geometry
from slam_core.config import SlamConfig
from slam_core.localization.deskew_refinement import cost
from slam_core.localization.dynamic_beams import (
    foreground,
    is_better,
    is_clearly_better,
    match_background,
    match_without,
    mostly_objects,
    objects,
)
from slam_core.localization.motion_hypotheses import best_match
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.matcher import coarse_to_fine, residuals
from slam_core.measurements import LaserScan
from slam_core.navigation.planar_motion import PlanarMotion
from slam_core.results import Fit, MatchResult, PlanarGaussian
from slam_core.scan.stabilise import stabilise

CONFIG = SlamConfig()
ANGLES = np.linspace(-np.pi / 2, np.pi / 2, 361)
# Walls with a door on either side, rooms behind them, and the ends: x0, y0, x1, y1, metres.
WALLS = np.array(
    [(x0, side, x1, side) for side in (-1.025, 1.025) for x0, x1 in ((-3.0, 9.025), (10.025, 20.025))]
    + [(8.025, side, 11.025, side) for side in (-4.025, 4.025)]
    + [(x, -4.025, x, 4.025) for x in (-3.0, 20.025)]
)
GONE = (-2.0, 0.0)  # behind the robot
AHEAD = 1.2  # metres between robot and person
PRIOR_SIGMAS = np.array([0.09, 0.09, 0.2])


def points(pose: np.ndarray, *people: tuple[float, float]) -> np.ndarray:
    """(n, 2) endpoints from a pose (3,) with somebody at each of some places in the map."""
    c, s = np.cos(ANGLES + pose[2]), np.sin(ANGLES + pose[2])
    x0, y0, x1, y1 = (column[:, None] for column in WALLS.T)
    with np.errstate(divide="ignore", invalid="ignore"):
        det = c * (y1 - y0) - s * (x1 - x0)
        along = ((x0 - pose[0]) * (y1 - y0) - (y0 - pose[1]) * (x1 - x0)) / det
        across = ((x0 - pose[0]) * s - (y0 - pose[1]) * c) / det
    ranges = np.where((along > 0.0) & (across >= 0.0) & (across <= 1.0), along, np.inf).min(axis=0)
    for person in people:
        offset = np.array(person) - pose[:2]
        nearest = offset[0] * c + offset[1] * s
        inside = 0.25**2 - (offset @ offset - nearest**2)
        body = np.where((inside > 0.0) & (nearest > 0.0), nearest - np.sqrt(np.maximum(inside, 0.0)), np.inf)
        ranges = np.minimum(ranges, body)
    return (ranges[:, None] * np.column_stack([np.cos(ANGLES), np.sin(ANGLES)])).astype(np.float32)


def mapped(person: tuple[float, float]) -> Pyramid:
    """The corridor with somebody in it, drawn by a robot that stood at the origin."""
    pyramid, origin = Pyramid(CONFIG.map), np.zeros(3)
    for _ in range(5):
        pyramid.update(points(origin, person), np.empty((0, 2), np.float32), origin[:2], origin, CONFIG.map)
    return pyramid


def matches(
    pyramid: Pyramid, true: np.ndarray, predicted: np.ndarray, *people: tuple[float, float]
) -> tuple[MatchResult, MatchResult | None, np.ndarray]:
    """Of a scan: the match of all beams, the one without those on an object that moves, and its endpoints."""
    scan = points(true, *people)
    prior = PlanarGaussian(predicted, np.diag(PRIOR_SIGMAS**2))
    match = coarse_to_fine(pyramid, scan, prior.mean, CONFIG.matcher, prior=prior)
    return match, match_without(pyramid, scan, match, prior, CONFIG.matcher), scan


@pytest.mark.parametrize("step", [0.15, 0.2, 0.3])
def test_a_person_who_comes_nearer_does_not_drag_the_match_along(step: float) -> None:
    """The match of all beams meets the person; without those on the person it is where the robot is."""
    true = np.zeros(3)
    match, static, scan = matches(mapped((AHEAD, 0.3)), true, true, (AHEAD - step, 0.3))
    assert match.pose[0] > 0.5 * step
    assert static is not None
    np.testing.assert_allclose(static.pose, true, atol=0.02)
    assert len(static.residuals) == len(scan)
    np.testing.assert_array_equal(static.left_out, np.flatnonzero((scan != points(true)).any(axis=1)))


@pytest.mark.parametrize(("side", "step"), [(0.0, -0.12), (0.2, -0.12), (0.2, 0.1), (0.3, 0.1)])
def test_a_person_who_moves_by_less_than_their_size_drags_no_match_along(side: float, step: float) -> None:
    """Half of the beams on the person meet where it was before; all of them are left out."""
    true, near = np.zeros(3), 0.7
    match, static, _ = matches(mapped((near, side)), true, true, (near - step, side))
    assert abs(match.pose[0]) > 0.07
    assert static is not None
    np.testing.assert_allclose(static.pose, true, atol=0.01)


def test_the_one_who_drags_the_match_along_may_be_hidden_behind_another() -> None:
    """Somebody who has just come is hit by most beams; the smaller object is left out as well."""
    true, far = np.zeros(3), 2.0
    match, static, _ = matches(mapped((far, -0.3)), true, true, (1.0, 0.6), (far - 0.2, -0.3))
    assert match.pose[0] > 0.1
    assert static is not None
    np.testing.assert_allclose(static.pose, true, atol=0.02)


def test_people_in_the_foreground_hold_no_match_back() -> None:
    """They have gone as far as the robot; the match of all beams stays behind, that of the background does not."""
    true, person = np.array([0.12, 0.0, 0.0]), (0.8, 0.3)
    pyramid, scan = mapped(person), points(true, (person[0] + true[0], person[1]))
    prior = PlanarGaussian(np.array([0.06, 0.0, 0.0]), np.diag(PRIOR_SIGMAS**2))
    match = coarse_to_fine(pyramid, scan, prior.mean, CONFIG.matcher, prior=prior)
    background = match_background(pyramid, scan, match, prior, CONFIG.matcher)
    assert match.pose[0] < 0.05
    assert background is not None
    np.testing.assert_allclose(background.pose, true, atol=0.02)
    assert len(background.residuals) == len(scan)
    np.testing.assert_array_equal(background.left_out, np.flatnonzero(foreground(scan)))


def predicted_match(person: tuple[float, float], moved: float) -> tuple[MatchResult, MatchResult | None]:
    """Of all beams and of the background: the robot stands, its prediction is 1 cm off, a mapped person moves."""
    true = np.zeros(3)
    pyramid, scan = mapped(person), points(true, (person[0] + moved, person[1]))
    prior = PlanarGaussian(np.array([0.01, 0.0, 0.0]), np.diag([0.03, 0.03, 0.02]) ** 2)
    match = coarse_to_fine(pyramid, scan, prior.mean, CONFIG.matcher, prior=prior)
    return match, match_background(pyramid, scan, match, prior, CONFIG.matcher, measured=True)


def test_by_inertial_data_a_match_leaves_out_somebody_right_before_the_laser() -> None:
    """The person drags the match of all beams along; the background and the prediction know better."""
    match, background = predicted_match((0.6, 0.1), 0.15)
    assert match.pose[0] < -0.05
    assert background is not None
    np.testing.assert_allclose(background.pose, np.zeros(3), atol=0.02)
    assert len(background.left_out)
    assert len(background.residuals) == len(ANGLES)


def test_by_inertial_data_background_and_prediction_decide_together() -> None:
    """A match that explains both as well is kept; one far from the prediction is not, however well it fits."""
    person, true = (0.6, 0.1), np.zeros(3)
    pyramid, scan = mapped(person), points(true, person)
    prior = PlanarGaussian(np.array([0.01, 0.0, 0.0]), np.diag([0.03, 0.03, 0.02]) ** 2)
    match = coarse_to_fine(pyramid, scan[~foreground(scan)], prior.mean, CONFIG.matcher, prior=prior)
    same = match._replace(residuals=residuals(pyramid.levels[0], scan, match.pose))
    assert match_background(pyramid, scan, same, prior, CONFIG.matcher, measured=True) is None
    far = match._replace(pose=np.array([2.0, 0.0, 0.0]), residuals=np.zeros(len(scan), np.float32))
    found = match_background(pyramid, scan, far, prior, CONFIG.matcher, measured=True)
    assert found is not None
    np.testing.assert_allclose(found.pose, match.pose)


def test_by_inertial_data_a_match_of_all_beams_is_kept_where_nobody_stands_before_the_laser() -> None:
    """There is nothing to leave out."""
    assert predicted_match(GONE, 0.0)[1] is None


def test_no_other_motion_is_taken_that_follows_somebody() -> None:
    """By half a metre in less than half a second: all beams together fit better so, the background does not."""
    period_ns, person = 213_000_000, (1.0, 0.3)
    pyramid, motion = mapped(person), PlanarMotion()
    for k in range(4):
        motion.prior(k * period_ns, CONFIG.motion)
        motion.fuse(PlanarGaussian(np.zeros(3), np.diag([0.005, 0.005, 0.002]) ** 2), CONFIG.fusion)
    ranges = np.hypot(*points(np.zeros(3), (person[0] - 0.5, person[1])).T)
    scan = LaserScan(5 * period_ns, ranges, float(ANGLES[0]), float(ANGLES[1] - ANGLES[0]))
    prior = motion.prior(scan.mid_ns, CONFIG.motion)
    placed = stabilise(scan, motion.poses, CONFIG.scan)
    match = coarse_to_fine(pyramid, placed.points, prior.mean, CONFIG.matcher, prior=prior)
    follows = coarse_to_fine(pyramid, placed.points, np.array([0.5, 0.0, 0.0]), CONFIG.matcher, prior=prior)
    np.testing.assert_allclose(match.pose, np.zeros(3), atol=0.01)
    assert cost(follows) < 0.8 * cost(match)
    assert best_match(scan, (placed, match), prior, pyramid, motion, CONFIG) is None


def test_who_stands_still_is_matched_with_the_rest() -> None:
    """Without them the scan fits no better."""
    person = (0.8, 0.3)
    pyramid, scan = mapped(person), points(np.zeros(3), person)
    prior = PlanarGaussian(np.array([0.06, 0.0, 0.0]), np.diag(PRIOR_SIGMAS**2))
    match = coarse_to_fine(pyramid, scan, prior.mean, CONFIG.matcher, prior=prior)
    np.testing.assert_allclose(match.pose, np.zeros(3), atol=0.02)
    assert foreground(scan).any()
    assert match_background(pyramid, scan, match, prior, CONFIG.matcher) is None


def test_the_foreground_is_what_stands_before_the_rest() -> None:
    """Everybody who does, whole; not what is seen between them, no single beam, and nothing of nothing."""
    alone, both = points(np.zeros(3)), points(np.zeros(3), (1.2, 0.3), (1.2, -0.3))
    np.testing.assert_array_equal(foreground(both), (alone != both).any(axis=1))
    alone[len(alone) // 2] *= 0.5
    assert not foreground(alone).any()
    assert len(foreground(np.empty((0, 2), np.float32))) == 0


@pytest.mark.parametrize(
    ("before", "after", "stands"), [(5.0, 5.0, True), (5.0, 1.0, False), (1.0, 5.0, False), (1.0, 1.0, False)]
)
def test_what_has_something_nearer_beside_it_is_no_foreground(before: float, after: float, stands: bool) -> None:
    """It may be a piece of a wall that the nearer one hides. At an end of the scan one neighbour tells."""
    angles, ranges = ANGLES[:60], np.repeat([before, 2.0, after], 20)
    ends = (ranges[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])).astype(np.float32)
    np.testing.assert_array_equal(foreground(ends), np.repeat([before < 2.0, stands, after < 2.0], 20))


@pytest.mark.parametrize(("ranges", "stands"), [((1.4, 4.0), True), ((1.6, 4.0), False), ((1.4, 1.6), False)])
def test_at_an_end_of_the_scan_only_somebody_close_by_is_in_the_foreground(
    ranges: tuple[float, float], stands: bool
) -> None:
    """Further off a wall may begin or end there."""
    for mirrored in (False, True):
        reach = np.repeat(ranges[::-1] if mirrored else ranges, 20)
        ends = (reach[:, None] * np.column_stack([np.cos(ANGLES[:40]), np.sin(ANGLES[:40])])).astype(np.float32)
        np.testing.assert_array_equal(foreground(ends), (reach == ranges[0]) & stands)


@pytest.mark.parametrize(("reach", "stands"), [(1.4, True), (1.6, False)])
def test_a_lone_object_close_by_is_in_the_foreground(reach: float, stands: bool) -> None:
    """Though nothing else is seen; further off it may be the only wall within reach."""
    angles = ANGLES[:20]
    ends = reach * np.column_stack([np.cos(angles), np.sin(angles)]).astype(np.float32)
    assert (foreground(ends, sees_past=True) == stands).all()
    assert not foreground(ends).any()


@pytest.mark.parametrize(("reach", "stands"), [(2.5, True), (3.8, False)])
@pytest.mark.parametrize("mirrored", [False, True])
def test_an_object_stands_before_what_is_out_of_reach(reach: float, stands: bool, mirrored: bool) -> None:
    """Beside it nothing returns, then comes somebody nearer. Where the reach of a laser ends, a wall does, too."""
    bearings = np.concatenate([ANGLES[:40], ANGLES[40:60], ANGLES[140:180], ANGLES[300:320]])
    ranges = np.repeat([4.0, reach, 0.9, 4.0], [40, 20, 40, 20])
    ends = ranges[:, None] * np.column_stack([np.cos(bearings), np.sin(bearings)])
    seen = (ends[::-1] if mirrored else ends).astype(np.float32)
    for sees_past in (False, True):
        found = foreground(seen, sees_past=sees_past)
        expected = np.repeat([False, stands and sees_past, True, False], [40, 20, 40, 20])
        np.testing.assert_array_equal(found[::-1] if mirrored else found, expected)


def test_a_scan_of_objects_alone_tells_nothing() -> None:
    """Their share is named. As few walls are many for another laser, and somebody alone does not hide them."""
    crowd = points(np.zeros(3), (0.4, 0.0), (0.3, 0.45), (0.3, -0.45))
    walls = np.count_nonzero(~foreground(crowd, sees_past=True))
    around = mostly_objects(crowd, 11 * walls)
    assert around
    assert around.code == "objects"
    assert around.value > around.limit
    assert mostly_objects(crowd, 9 * walls) is None
    assert mostly_objects(points(np.zeros(3), (1.2, 0.3)), 100_000) is None


def test_who_fills_half_of_the_view_leaves_no_background_to_match() -> None:
    """The few beams that are left would fit anywhere."""
    person = (0.4, 0.0)
    pyramid, scan = mapped((AHEAD, 0.3)), points(np.zeros(3), person, (0.3, 0.45), (0.3, -0.45))
    assert foreground(scan).mean() > 0.5
    prior = PlanarGaussian(np.array([0.06, 0.0, 0.0]), np.diag(PRIOR_SIGMAS**2))
    match = coarse_to_fine(pyramid, scan, prior.mean, CONFIG.matcher, prior=prior)
    wrong = match._replace(residuals=np.ones_like(match.residuals))
    assert match_background(pyramid, scan, wrong, prior, CONFIG.matcher) is None


def judged(x: float, residual: float, known: float) -> MatchResult:
    """A match of ten beams, x metres from a prediction at the origin."""
    matched, eye = np.array([x, 0.0, 0.0]), np.eye(3)
    return MatchResult(
        matched, eye, eye, np.full(10, residual, np.float32), (), True, np.empty((0, 4)), fit=Fit(known, 1.0)
    )


@pytest.mark.parametrize(
    ("x", "residual", "known", "better"),
    [(0.0, 0.2, 1.0, True), (0.15, 0.2, 1.0, False), (0.0, 0.298, 1.0, False), (0.0, 0.2, 0.85, False)],
    ids=["as it should be", "not nearer", "fits no better", "off the known map"],
)
def test_what_is_asked_of_the_better_match(x: float, residual: float, known: float, better: bool) -> None:
    """To be much nearer to the prediction, to fit better by a twentieth, and to lie on known cells as before."""
    match, prior = judged(0.2, 0.3, 1.0), PlanarGaussian(np.zeros(3), np.eye(3))
    assert is_better(judged(x, residual, known), match, match.residuals, prior) is better


@pytest.mark.parametrize(
    ("residuals", "known", "better"),
    [
        ([0.2] * 10, 1.0, True),
        ([0.29] * 10, 1.0, False),
        ([0.0] * 2 + [0.3] * 8, 1.0, False),
        ([0.2] * 10, 0.85, False),
    ],
    ids=["as it should be", "fits little better", "two beams fit better", "off the known map"],
)
def test_what_is_asked_of_the_match_of_the_background(residuals: list[float], known: float, better: bool) -> None:
    """To fit better by a tenth, more than by chance, and to lie on known cells as before."""
    match = judged(0.2, 0.3, 1.0)
    other = judged(0.0, 0.0, known)._replace(residuals=np.array(residuals, np.float32))
    assert is_clearly_better(other, match, match.residuals) is better


def test_a_robot_that_moves_on_suddenly_is_where_its_match_is() -> None:
    """What stands ahead of it lies in free space at the prediction, too, but the rest fits better at the match."""
    true, predicted = np.zeros(3), np.array([-0.2, 0.0, 0.0])
    match, static, _ = matches(mapped((AHEAD, 0.3)), true, predicted, (AHEAD, 0.3))
    assert abs(match.pose[0]) < 0.05
    assert static is None


def test_a_scan_without_beams_in_free_space_has_one_match() -> None:
    """There is nothing to leave out."""
    true = np.array([0.2, 0.0, 0.0])
    assert matches(mapped(GONE), true, true, GONE)[1] is None


def test_where_most_beams_end_in_free_space_the_prediction_is_wrong() -> None:
    """No beams are left out: a robot that turned has one match."""
    true, predicted = np.array([0.0, 0.0, 0.3]), np.array([0.2, 0.0, 0.0])
    assert matches(mapped(GONE), true, predicted, GONE)[1] is None


def test_in_a_closet_all_beams_are_on_one_object() -> None:
    """None would be left: the match stays."""
    pyramid, ends = mapped(GONE), 0.3 * np.column_stack([np.cos(ANGLES), np.sin(ANGLES)]).astype(np.float32)
    prior = PlanarGaussian(np.zeros(3), np.diag(PRIOR_SIGMAS**2))
    match = coarse_to_fine(pyramid, ends, np.array([0.2, 0.0, 0.0]), CONFIG.matcher)
    assert len(objects(ends, np.ones(len(ends), np.bool_))[0]) == len(ends)
    assert match_without(pyramid, ends, match, prior, CONFIG.matcher) is None


def test_an_object_is_compact_and_in_free_space() -> None:
    """Beams that follow each other within 0.3 m; a wall is none; the largest comes first, whatever is between."""
    near, far = np.linspace(0.0, 0.2, 3), np.linspace(2.0, 2.4, 9)
    wall = np.linspace(5.0, 7.0, 21)
    ends = np.column_stack([np.ones(36), np.concatenate([near, far, [3.0, 3.1, 4.0], wall])]).astype(np.float32)
    free = np.ones(36, np.bool_)
    free[12:14] = False
    assert [group.tolist() for group in objects(ends, free)] == [list(range(3, 12)), [0, 1, 2], [14]]
    assert objects(ends, np.zeros(36, np.bool_)) == []


def test_all_beams_of_an_object_that_is_partly_in_free_space_belong_to_it() -> None:
    """The one with most beams there comes first; on a long wall only those in free space are an object."""
    large, small, wall = np.linspace(0.0, 0.4, 9), np.linspace(1.0, 1.2, 3), np.linspace(3.0, 6.0, 31)
    ends = np.column_stack([np.ones(43), np.concatenate([large, small, wall])]).astype(np.float32)
    free = np.zeros(43, np.bool_)
    free[[2, 9, 10, 20, 21, 22]] = True
    assert [each.tolist() for each in objects(ends, free)] == [[20, 21, 22], [9, 10, 11], list(range(9))]


def test_residuals_are_those_of_the_match() -> None:
    """At its pose, of every endpoint."""
    pyramid, scan = mapped(GONE), points(np.zeros(3), GONE)
    match = coarse_to_fine(pyramid, scan, np.array([0.03, 0.01, 0.01]), CONFIG.matcher)
    again = residuals(pyramid.levels[0], scan, match.pose)
    np.testing.assert_allclose(again, match.residuals, atol=1e-3)
    assert geometry.wrap(match.pose[2]) == pytest.approx(0.0, abs=0.01)
