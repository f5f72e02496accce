"""The corners of a line through a path."""

from itertools import pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from hectorscope.views._corners import Corners

SPACING, TOLERANCE = 0.03, 0.005


def walk(seed: int, count: int = 300) -> np.ndarray:
    """Straight on, in curves, back again, at rest, up and down."""
    rng = np.random.default_rng(seed)
    turns = np.repeat(rng.choice([0.0, 0.0, 0.05, -0.2, np.pi], count // 10 + 1), 10)[:count]
    steps = np.repeat(rng.choice([0.0, 0.01, 0.05], count // 20 + 1), 20)[:count]
    heading = np.cumsum(np.where(np.arange(count) % 10, 0.1, 1.0) * turns)
    rises = np.repeat(rng.choice([0.0, 0.0, 0.02], count // 30 + 1), 30)[:count]
    return np.cumsum(np.column_stack([steps * np.cos(heading), steps * np.sin(heading), rises]), axis=0)


def apart(points: np.ndarray, begin: np.ndarray, finish: np.ndarray) -> np.ndarray:
    """Distances of points (n, 3) to a piece of a line."""
    along = finish - begin
    share = np.clip((points - begin) @ along / max(float(along @ along), 1e-12), 0.0, 1.0)
    return np.linalg.norm(points - begin - share[:, None] * along, axis=1)


@given(st.integers(0, 10**6), st.lists(st.integers(1, 60), max_size=8))
def test_the_line_passes_the_path_closely(seed: int, parts: list[int]):
    """However the rows arrive: within the tolerance, from the first to the last row."""
    path, corners, count = walk(seed), Corners(SPACING, TOLERANCE), 0
    for part in (*parts, len(path)):
        corners.follow(path[: count + part], count)
        count = min(count + part, len(path))
    points = corners.points
    assert points[0] == 0
    assert np.abs(path[points[-1]] - path[-1]).max() < SPACING
    for begin, finish in pairwise(points):
        between = path[begin : finish + 1]
        counts = [0]
        for k in range(1, len(between)):
            if np.abs(between[k] - between[counts[-1]]).max() >= SPACING:
                counts.append(k)
        assert apart(between[counts], path[begin], path[finish]).max() <= 2 * TOLERANCE + 1e-9


def test_what_is_straight_has_two_ends():
    """A straight drive of a thousand rows is one piece; a turn on the spot adds nothing."""
    corners, path = Corners(SPACING, TOLERANCE), np.outer(np.arange(1000), [0.02, 0.01, 0.001])
    corners.follow(path, 0)
    corners.follow(np.vstack([path, np.repeat(path[-1:], 50, axis=0)]), len(path))
    assert corners.points[0] == 0
    assert len(corners.points) == 2


def test_the_way_back_is_a_line_of_its_own():
    """Where the robot turns round there is a corner: the far end is not lost."""
    corners = Corners(SPACING, TOLERANCE)
    there = np.outer(np.arange(100), [0.05, 0.0, 0.0])
    corners.follow(np.vstack([there, there[-2:50:-1]]), 0)
    assert 99 in corners.rows


@given(st.integers(0, 10**6), st.integers(0, 299), st.integers(1, 300))
def test_after_a_jump_back_the_path_is_followed_as_before(seed: int, back: int, other: int):
    """Rows that differ from one on replace what was behind it."""
    path, corners = walk(seed), Corners(SPACING, TOLERANCE)
    new = np.vstack([path[:back], walk(seed + 1)[:other] + 3.0])
    corners.follow(path, 0)
    corners.follow(new, back)
    points = corners.points
    assert points[0] == 0
    assert points == sorted(set(points))
    assert np.abs(new[points[-1]] - new[-1]).max() < SPACING
