"""Equations (4)-(6) against the paper's own form and finite differences."""

import numpy as np

from slam_core.kernels.bilinear import UNKNOWN_PARTS, WHOLE
from slam_core.mapping.interpolate import interpolate
from tests.worlds import smooth_level


def paper_value(grid, u, v):
    """Eq. (4) written out as printed, in double precision."""
    x0, y0 = int(np.floor(u)), int(np.floor(v))
    fx, fy = u - x0, v - y0
    p00, p10, p01, p11 = grid[y0, x0], grid[y0, x0 + 1], grid[y0 + 1, x0], grid[y0 + 1, x0 + 1]
    # The paper indexes P_(x y): its P01 lies at (x0, y1).
    return fy * (fx * p11 + (1 - fx) * p01) + (1 - fy) * (fx * p10 + (1 - fx) * p00)


def test_equation_4_value():
    """The value at any point is the bilinear mean of the four cells around it."""
    level = smooth_level(1)
    rng = np.random.default_rng(2)
    us, vs = rng.uniform(0, 62, (2, 300))
    expected = [paper_value(level.probability.astype(float), u, v) for u, v in zip(us, vs, strict=True)]
    np.testing.assert_allclose(interpolate(level.cells, us, vs)[:, 0], expected, atol=2e-6)


def test_equations_5_and_6_are_the_derivatives_of_4():
    """The gradient equals finite differences of the value inside a cell."""
    level = smooth_level(3)
    grid = level.probability.astype(float)
    rng = np.random.default_rng(4)
    us, vs = np.floor(rng.uniform(0, 60, (2, 300))) + rng.uniform(0.05, 0.95, (2, 300))
    h = 1e-4
    du = [
        (paper_value(grid, u + h, v) - paper_value(grid, u - h, v)) / (2 * h) for u, v in zip(us, vs, strict=True)
    ]
    dv = [
        (paper_value(grid, u, v + h) - paper_value(grid, u, v - h)) / (2 * h) for u, v in zip(us, vs, strict=True)
    ]
    got = interpolate(level.cells, us, vs)
    np.testing.assert_allclose(got[:, 1], du, atol=1e-5)
    np.testing.assert_allclose(got[:, 2], dv, atol=1e-5)


def test_samples_are_met_exactly():
    """At a cell's own coordinate the value is the cell's, whatever its neighbours say."""
    level = smooth_level(5)
    grid = level.probability
    got = interpolate(level.cells, np.array([7.0, 20.0]), np.array([9.0, 31.0]))[:, 0]
    np.testing.assert_allclose(got, [grid[9, 7], grid[31, 20]], rtol=1e-6)


def test_gradient_weights_are_not_swapped():
    """A field that changes along x only has a gradient along x only, whose size varies with y alone."""
    parts = np.arange(8, dtype=np.int16)
    value, du, dv = WHOLE * interpolate(parts * parts[:, None], np.array([2.25]), np.array([3.5]))[0]
    assert (value - UNKNOWN_PARTS, du, dv) == (2.25 * 3.5, 3.5, 2.25)
