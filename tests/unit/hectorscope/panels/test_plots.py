"""What the charts send to the browser."""

from dataclasses import replace

import numpy as np

from hectorscope.page.scene import Scene
from hectorscope.panels._curves import AGAINST_TRUTH, PAGES
from hectorscope.panels._truth_error import truth_error
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


def test_a_heading_goes_on_beyond_half_a_turn():
    """From 179 to 181 degrees the curve rises by two, and where it stands does not depend on the window."""
    (chart,) = [chart for page in PAGES.values() for chart in page if chart.title == "Yaw, °"]
    series = np.zeros(30, SERIES_DTYPE)
    series["time_s"] = np.arange(30)
    series["yaw"] = np.angle(np.exp(1j * np.radians(150.0 + 5.0 * np.arange(30))))
    for first in (0, 20):
        _, yaw = curves(chart, series, first)
        np.testing.assert_allclose(yaw, 150.0 + 5.0 * np.arange(30)[first:], rtol=1e-5)


def test_the_error_against_the_truth_is_a_curve(scene: Scene) -> None:
    """In the plane, in heading and in height, where the truth covers the run; a run without a truth says so."""
    snapshot = room_snapshot()
    half = np.radians(1.0)
    truth = snapshot.truth.copy()
    truth[10:, 1] += 0.03
    truth[10:, 2] += 0.04
    truth[:, 4], truth[:, 7] = np.cos(half), np.sin(half)
    rows = truth_error(replace(snapshot, truth=truth[:30], truth_in_map=np.array([0.0, 0.0, 0.0, 0.0])))
    there = snapshot.truth[:30, 1:3] - snapshot.trajectory[:30, 1:3]
    np.testing.assert_allclose(rows["error"][:10], np.hypot(*there[:10].T), atol=1e-12)
    there[10:] += [0.03, 0.04]
    np.testing.assert_allclose(rows["error"][10:30], np.hypot(*there[10:].T), atol=1e-12)
    np.testing.assert_allclose(rows["error_yaw"][:30], -2.0 * half)
    assert np.isnan(rows["error"][30:]).all()
    assert np.isnan(rows["error_z"]).all()
    panel = PlotsPanel(scene)
    panel._page.value = AGAINST_TRUTH
    panel.draw(snapshot)
    assert not panel._nothing.visible
    panel.draw(replace(snapshot, sequence=2, truth=np.empty((0, 8))))
    assert panel._nothing.visible


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
