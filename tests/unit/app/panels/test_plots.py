"""What the charts send to the browser."""

import numpy as np

from app.panels._curves import PAGES
from app.panels.plots import curves
from app.snapshot import SERIES_DTYPE


def test_a_chart_begins_with_its_first_value():
    """The first scan has no match: with a gap in front, the browser would find no range for the axis."""
    (chart,) = [chart for page in PAGES.values() for chart in page if chart.title == "Mean residual"]
    series = np.zeros(50, SERIES_DTYPE)
    series["time_s"], series["residual"] = np.arange(50), np.linspace(0.1, 0.2, 50)
    series["residual"][:3] = np.nan
    time, *values = curves(chart, series, 0)
    assert time[0] == 3.0
    assert len(time) == 47
    assert all(np.isfinite(value).all() for value in values)
