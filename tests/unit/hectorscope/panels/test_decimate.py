import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hectorscope.panels._decimate import decimate


@given(st.integers(1, 5000), st.integers(0, 10**6), st.sampled_from([20, 100, 300]))
def test_no_more_points_than_asked_and_no_peak_lost(n: int, first: int, limit: int) -> None:
    """Whatever the length: at most `limit` points, time ascending from first to last, extremes kept."""
    x = np.arange(n, dtype=float)
    y = np.random.default_rng(n).normal(size=n)
    thin_x, (thin_y,) = decimate(x, [y], limit, first)
    assert len(thin_x) == len(thin_y) <= max(limit, 1)
    assert np.all(np.diff(thin_x) >= 0)
    assert (thin_x[0], thin_x[-1]) == (x[0], x[-1])
    assert (thin_y.min(), thin_y.max()) == (y.min(), y.max())


def test_short_series_are_left_alone() -> None:
    """What fits is passed on as it is."""
    x = np.arange(10.0)
    assert decimate(x, [x], 10)[1][0] is x


def test_a_moving_window_does_not_shimmer() -> None:
    """Two windows a sample apart agree on all points but those at their edges."""
    y = np.random.default_rng(1).normal(size=4000)
    x = np.arange(4000.0)
    one = decimate(x[100:3100], [y[100:3100]], 300, 100)
    two = decimate(x[101:3101], [y[101:3101]], 300, 101)
    shared = set(zip(one[0], one[1][0], strict=True)) & set(zip(two[0], two[1][0], strict=True))
    assert len(shared) >= len(one[0]) - 4


def test_missing_values_are_passed_over() -> None:
    """A run with a gap shows what it has; a run without any value stays a gap."""
    y = np.sin(np.arange(1000.0))
    y[100:400] = np.nan
    y[500] = np.nan
    _, (thin,) = decimate(np.arange(1000.0), [y], 200)
    assert np.isnan(thin).sum() == pytest.approx(2 * 300 / 16, abs=4)
    assert np.nanmax(thin) == np.nanmax(y)


def test_curves_keep_rising_and_falling() -> None:
    """A line that rises is drawn rising, one that falls falling."""
    x = np.arange(1000.0)
    _, (up, down) = decimate(x, [x, -x], 100)
    assert np.all(np.diff(up) > 0)
    assert np.all(np.diff(down) < 0)
