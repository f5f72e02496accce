"""Eqs. (4)-(6) at one place."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from hectorscope.run.xray.lens import lens
from slam_core.geometry import transform_points
from tests.xray import problem


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.integers(0, 2), st.integers(0, 360), st.floats(-0.2, 0.2), st.floats(-0.2, 0.2))
def test_value_and_gradient_are_those_of_the_corners(level: int, beam: int, dx: float, dy: float):
    """M by the formula on the card; the gradient by finite differences; near the walls of the scan."""
    found = problem()
    ends = transform_points(found.matched, found.points)
    x, y = ends[beam % len(ends)] + [dx, dy]
    seen = lens(found, level, float(x), float(y))
    p00, p10, p01, p11 = seen.corners
    u, v = seen.share
    by_hand = v * (u * p11 + (1 - u) * p01) + (1 - v) * (u * p10 + (1 - u) * p00)
    np.testing.assert_allclose(seen.M, by_hand, atol=1e-9)
    np.testing.assert_allclose(seen.differences, seen.gradient, atol=1e-6)


def test_the_cells_are_those_of_the_map():
    """The corners are the probabilities that the matcher reads; the place lies between their centres."""
    found = problem()
    x, y = transform_points(found.matched, found.points)[0]
    seen, level = lens(found, 0, float(x), float(y)), found.pyramid.levels[0]
    column, row = seen.cell[0] - level.corner[0], seen.cell[1] - level.corner[1]
    four = level.probability[row : row + 2, column : column + 2]
    np.testing.assert_allclose(seen.corners, four.ravel(), atol=1e-5)
    centre = (np.array(seen.cell) + 0.5) * seen.resolution
    assert (np.abs(np.array(seen.place) - centre - seen.resolution / 2) <= seen.resolution / 2 + 1e-9).all()


def test_off_the_map_all_is_unknown():
    """Corners and M of 0.5, no gradient."""
    seen = lens(problem(), 1, 900.0, -900.0)
    assert seen.corners == (0.5,) * 4
    assert seen.M == 0.5
    assert not seen.gradient.any()
