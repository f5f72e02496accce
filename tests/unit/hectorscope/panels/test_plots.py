"""What the charts send to the browser."""

from dataclasses import replace

import numpy as np

from hectorscope.page.scene import Scene
from hectorscope.panels._curves import PAGES
from hectorscope.panels.plots import PlotsPanel, curves
from hectorscope.run.series import SERIES_DTYPE
from tests.page import room_snapshot


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


def test_a_page_without_a_curve_says_so(scene: Scene) -> None:
    """As of biases where there is no filter; the note goes with the first curve."""
    panel, full = PlotsPanel(scene), room_snapshot()
    panel._page.value = "Biases"
    panel.draw(full)
    assert not panel._nothing.visible
    series = full.series.copy()
    for name in series.dtype.names or ():
        if "bias" in name:
            series[name] = np.nan
    panel.draw(replace(full, sequence=full.sequence + 1, series=series))
    assert panel._nothing.visible
