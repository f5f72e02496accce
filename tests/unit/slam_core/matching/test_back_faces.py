"""Walls seen from behind: where a robot first sees the other side of a wall, that side is not mapped yet."""

import numpy as np
import pytest

from slam_core.config import MapConfig, MatcherConfig
from slam_core.kernels.back_faces import count_behind
from slam_core.kernels.gauss_newton import TOGETHER
from slam_core.kernels.structures import Beams, Level
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.matcher import beams_of, coarse_to_fine
from slam_core.results import PlanarGaussian

CONFIG = MapConfig(size=512)
NONE, LASER = np.empty((0, 2), np.float32), np.zeros(2)
THICK = 0.13
# Two rooms and a door in the wall between them, whose sides are at x = 2 and x = 2 + THICK: (x, y) to (x, y).
WALLS = np.array(
    [
        [[-3.0, -3.0], [-3.0, 3.0]],
        [[7.0, -3.0], [7.0, 3.0]],
        [[-3.0, -3.0], [7.0, -3.0]],
        [[-3.0, 3.0], [7.0, 3.0]],
        *([[x, side * 0.5], [x, side * 3.0]] for x in (2.0, 2.0 + THICK) for side in (-1, 1)),
        *([[2.0, side * 0.5], [2.0 + THICK, side * 0.5]] for side in (-1, 1)),
    ]
)
BEHIND = np.array([3.0, 0.3, 3.0])


def scan(pose, beams=720, noise=0.005):
    """Endpoints on the walls, seen from a pose over 200 degrees."""
    angles = np.linspace(-1.75, 1.75, beams)
    way = np.column_stack([np.cos(angles + pose[2]), np.sin(angles + pose[2])])
    a, along = WALLS[:, 0] - pose[:2], WALLS[:, 1] - WALLS[:, 0]
    cross = way[:, :1] * along[:, 1] - way[:, 1:] * along[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (a[:, 0] * along[:, 1] - a[:, 1] * along[:, 0]) / cross
        u = (a[:, 0] * way[:, 1:] - a[:, 1] * way[:, :1]) / cross
    t[~((t > 0) & (u >= 0) & (u <= 1))] = np.inf
    ranges = t.min(axis=1) + np.random.default_rng(beams).normal(scale=noise, size=beams)
    return (ranges[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])).astype(np.float32)


@pytest.fixture(scope="module")
def first_room():
    """A map of the room on the left, with what is seen of the other one through the door."""
    pyramid = Pyramid(CONFIG)
    for x, y, psi in ((0, 0, 0), (-1, 1, 0.5), (1, -1, 1), (0.5, 0.5, 2), (-1.5, -1, 3), (1.2, 0.3, -1)):
        pose = np.array([x, y, psi], float)
        pyramid.update(scan(pose), NONE, LASER, pose, CONFIG)
    return pyramid


def walls_of(pyramid):
    """The surfels as the kernels take them."""
    level = pyramid.levels[0]
    return Level(level.surfels, level.corner, 1.0 / level.resolution)


def behind(pyramid, points, pose):
    """Which of the endpoints are seen from behind."""
    found = np.zeros(len(points), np.bool_)
    assert count_behind(walls_of(pyramid), beams_of(points), pose, found) == found.sum()
    return found


def test_a_wall_is_seen_from_behind_from_its_other_side(first_room):
    """Ends on its mapped side are, ends on its own side, next to it and on unknown cells are not."""
    aside = np.linspace(1.0, 2.0, 50)
    ahead = np.full_like(aside, 1.5)
    on_mapped_side = np.column_stack([-ahead, aside]).astype(np.float32)  # of a base at x = 3.5 that looks along x
    for pose, expected in (((3.5, 0, 0), True), ((3.9, 0, 0), False), ((-6.0, 0, 0), False)):
        assert (behind(first_room, on_mapped_side, np.array(pose, float)) == expected).all()
    from_inside = np.column_stack([ahead, aside]).astype(np.float32)
    assert not behind(first_room, from_inside, np.array([0.5, 0.0, 0.0])).any()


def test_a_scan_of_the_mapped_room_sees_nothing_from_behind(first_room):
    """However many its beams are."""
    pose = np.array([0.3, -0.4, 1.2])
    assert behind(first_room, scan(pose, TOGETHER + 500), pose).mean() < 0.01


def test_a_thin_wall_does_not_draw_the_scan(first_room):
    """From the second room most ends lie on the unmapped side: eq. (7) alone takes it for the mapped one."""
    start = BEHIND - np.array([0.04, 0.0, 0.0])
    points, prior = scan(BEHIND), PlanarGaussian(start, np.diag([0.03, 0.03, 0.02]) ** 2)
    drawn, held = (
        coarse_to_fine(first_room, points, start, MatcherConfig(back_face_share=share), prior=prior)
        for share in (1.0, MatcherConfig().back_face_share)
    )
    assert drawn.pose[0] - BEHIND[0] == pytest.approx(-THICK, abs=0.03)
    np.testing.assert_allclose(held.pose[:2], BEHIND[:2], atol=0.015)


@pytest.mark.parametrize("off", [-0.12, -0.06, 0.06, 0.12])
@pytest.mark.parametrize("sigma", [0.01, 0.02])
def test_a_match_from_a_sure_prediction_is_not_drawn_either(first_room, off, sigma):
    """The match that starts at a sure prediction wins only where ends seen from behind count as unknown, too."""
    start = BEHIND + np.array([off, 0.0, 0.0])
    prior = PlanarGaussian(start, np.diag([sigma, sigma, 0.02]) ** 2)
    points, apart = scan(BEHIND), [0.0, MatcherConfig().prior_restart_sigmas]
    alone, restarted = (
        coarse_to_fine(first_room, points, start, MatcherConfig(prior_restart_sigmas=sigmas), prior=prior).pose
        for sigmas in apart
    )
    assert abs(restarted[0] - BEHIND[0]) < abs(alone[0] - BEHIND[0]) + 0.04


def test_ends_on_walls_seen_from_behind_count_as_unknown(first_room):
    """In the residuals, where no other pose fits better."""
    points, pose = scan(BEHIND), BEHIND - np.array([THICK, 0.0, 0.0])
    sure = PlanarGaussian(pose, np.diag([1e-4, 1e-4, 1e-4]) ** 2)
    match = coarse_to_fine(first_room, points, pose, MatcherConfig(), prior=sure)
    found = behind(first_room, points, match.pose)
    assert found.mean() > 0.2
    assert (match.residuals[found] >= 0.5).all()


def test_no_beam_is_none_behind(first_room):
    """Of no beams none is."""
    none = Beams(np.empty(0, np.float32), np.empty(0, np.float32))
    assert count_behind(walls_of(first_room), none, BEHIND, np.zeros(0, np.bool_)) == 0
