"""The direction of the surface that each beam hit."""

import numpy as np
import pytest

from slam_core.kernels.coarse_to_fine import survey
from slam_core.kernels.structures import Beams
from slam_core.kernels.surfaces import between, tangents
from slam_core.measurements import Float32s


def directions(points: np.ndarray) -> tuple[Float32s, Float32s]:
    """X and y of the direction of the surface at each of points (n, 2)."""
    xs, ys = np.ascontiguousarray(points.T.astype(np.float32))
    x, y = np.empty_like(xs), np.empty_like(ys)
    tangents(xs, ys, x, y)
    return x, y


def test_points_on_a_line_point_along_it():
    """Every endpoint of a straight wall has its direction, up to sign, at full length."""
    t = np.linspace(0, 3, 60)
    points = np.column_stack([1 + t * np.cos(0.6), 2 + t * np.sin(0.6)]).astype(np.float32)
    x, y = directions(points)
    along = x * np.cos(0.6) + y * np.sin(0.6)
    np.testing.assert_allclose(np.abs(along), 1.0, atol=1e-3)


def test_every_direction_is_found():
    """The closed form is right in all quadrants, along the axes too."""
    for angle in np.linspace(-np.pi / 2, np.pi / 2, 37):
        t = np.linspace(-1, 1, 40)
        points = np.column_stack([t * np.cos(angle), t * np.sin(angle)]).astype(np.float32)
        x, y = directions(points)
        np.testing.assert_allclose(np.abs(x * np.cos(angle) + y * np.sin(angle)), 1, atol=1e-3)


def test_lone_points_and_blobs_have_no_surface():
    """Endpoints far from their neighbours, and round scatters."""
    rng = np.random.default_rng(0)
    lone = rng.uniform(-20, 20, (50, 2)).astype(np.float32)
    assert np.hypot(*directions(lone)).max() < 0.5
    blob = (0.05 * rng.standard_normal((200, 2))).astype(np.float32)
    assert np.median(np.hypot(*directions(blob))) < 0.5


def test_a_gap_separates_two_walls():
    """A beam next to a depth jump takes its direction from its own wall only."""
    x = np.linspace(0, 1, 20)
    near = np.column_stack([x, np.full(20, 1.0)])
    far = np.column_stack([np.full(20, 3.0), np.linspace(2, 4, 20)])
    x, y = directions(np.vstack([near, far]))
    np.testing.assert_allclose(np.abs(x[:20]), 1.0, atol=1e-3)
    np.testing.assert_allclose(np.abs(y[20:]), 1.0, atol=1e-3)


def test_any_number_of_points():
    """No points, or a few, break nothing."""
    for n in range(6):
        assert len(directions(np.zeros((n, 2)))[0]) == n


def corridor(far: float, noise: float = 0.01, seed: int = 0) -> np.ndarray:
    """A scan along x between walls at y = 1.2 and -1.2, with an end at x = `far`; range 30 m, 270 degrees."""
    angles = np.linspace(-0.75 * np.pi, 0.75 * np.pi, 1081)
    c, s = np.cos(angles), np.sin(angles)
    with np.errstate(divide="ignore"):
        ranges = np.minimum(1.2 / np.abs(s), np.where(c > 0, far / c, np.inf))
    ranges += noise * np.random.default_rng(seed).standard_normal(len(ranges))
    seen = ranges < 30.0
    return (ranges[seen, None] * np.column_stack([c, s])[seen]).astype(np.float32)


@pytest.mark.parametrize("seed", range(5))
def test_a_bare_corridor_is_open_along_and_an_end_closes_it(seed: int):
    """Noise turns no wall into a landmark, nor grazing beams far ahead; an end is one."""
    xs, ys = corridor(np.inf, seed=seed).T.copy()
    x, _, share = survey(Beams(xs, ys), 0.0)
    assert share < 0.004
    assert abs(x) > 0.9999
    xs, ys = corridor(15.0, seed=seed).T.copy()
    assert survey(Beams(xs, ys), 0.0)[2] > 0.01


@pytest.mark.parametrize("missing", [0.3, 0.7])
@pytest.mark.parametrize("seed", range(5))
def test_a_corridor_stays_open_where_beams_have_no_echo(missing: float, seed: int):
    """The gaps that they leave are of all lengths: an endpoint between two of them is still one of its wall."""
    points = corridor(np.inf, seed=seed)
    seen = np.random.default_rng([seed, 1]).random(len(points)) >= missing
    xs, ys = points[seen].T.copy()
    x, _, share = survey(Beams(xs, ys), 0.0)
    assert share < 0.004
    assert abs(x) > 0.9999


@pytest.mark.parametrize("seed", range(20))
def test_what_lies_between_the_beams_on_both_sides_of_a_blind_sector_is_no_wall(seed: int):
    """The view ahead is blocked: noise turns short steps before the gap towards its other side now and then."""
    points = corridor(np.inf, seed=seed)
    bearings = np.arctan2(points[:, 1], points[:, 0])
    xs, ys = points[np.abs(bearings) > np.radians(60)][::2].T.copy()
    x, _, share = survey(Beams(xs, ys), 0.0)
    assert share < 0.004
    assert abs(x) > 0.9999


def test_an_endpoint_off_the_line_of_its_neighbours_has_no_surface():
    """A post before a wall, hit by one beam, as far from what it is seen between as these are from each other."""
    wall = np.column_stack([np.full(8, 4.0), np.arange(-4.0, 4.0)])
    post = np.array([[3.0, 0.5]])
    x, y = directions(np.vstack([wall[:5], post, wall[5:]]))
    assert np.hypot(x[5], y[5]) < 0.1


def test_the_open_direction_turns_with_the_robot():
    """In the axes of the map."""
    xs, ys = corridor(np.inf).T.copy()
    x, y, _ = survey(Beams(xs, ys), 0.5)
    assert abs(x * np.cos(0.5) + y * np.sin(0.5)) > 0.9999


def test_a_square_room_fixes_both_directions_alike():
    """Half of the beams lie on walls across either."""
    angles = np.linspace(-np.pi, np.pi, 721)[:-1]
    ranges = 3.0 / np.maximum(np.abs(np.cos(angles)), np.abs(np.sin(angles)))
    xs, ys = (ranges * np.array([np.cos(angles), np.sin(angles)])).astype(np.float32)
    assert survey(Beams(xs, ys), 0.3)[2] == pytest.approx(0.5, abs=0.05)


def test_a_round_room_leaves_the_turn_open_and_no_place():
    """Its walls fix the position from all sides."""
    angles = np.linspace(-np.pi, np.pi, 721)[:-1]
    xs, ys = (3.0 * np.array([np.cos(angles), np.sin(angles)])).astype(np.float32)
    assert survey(Beams(xs, ys), 0.0)[2] == pytest.approx(0.5, abs=0.05)


def test_no_beams_fix_nothing():
    """A scan without endpoints is open, and breaks nothing."""
    assert survey(Beams(np.empty(0, np.float32), np.empty(0, np.float32)), 0.0)[2] == 0.0


def grazing(n=12, aside=1.0, step=0.0087, first=0.05):
    """(n, 2) endpoints of beams that meet a straight wall ever more at a slant, far ones last."""
    angles = first + step * np.arange(n)[::-1]
    return np.column_stack([aside / np.tan(angles), np.full(n, aside)]).astype(np.float32)


def test_the_wall_between_endpoints_of_beams_that_graze_it_is_filled():
    """Points on the wall, no two neighbours of it further apart than a step; the gaps at its ends stay."""
    points = grazing()
    assert np.diff(points[:, 0]).max() < 3.0
    filled = between(points, 0.05, 3.0)
    np.testing.assert_allclose(filled[:, 1], 1.0, atol=1e-6)
    along = np.sort(np.concatenate([points[1:-1, 0], filled[:, 0]]))
    assert np.diff(along).max() < 0.0501
    assert filled[:, 0].min() > points[1, 0]
    assert filled[:, 0].max() < points[-2, 0]


def test_no_wall_is_made_up():
    """Gaps that are too long, at a corner, into a room behind a door, or beside too few endpoints stay open."""
    points = grazing()
    assert len(between(points, 0.05, 0.0)) == 0
    assert between(points, 0.05, 0.5)[:, 0].max() < points[-2, 0] - 0.5
    assert len(between(points[:3], 0.05, 3.0)) == 0
    corner = np.array([[0, 0], [0.5, 0], [1, 0], [1, 0.5], [1, 1]], np.float32)
    assert len(between(corner, 0.05, 3.0)) == 0
    door = np.array([[0, 1], [0.5, 1], [1, 1], [3, 3], [2, 1], [2.5, 1], [3, 1]], np.float32)
    assert not [x for x, _ in between(door, 0.05, 3.0) if 1.0 < x < 2.0]
