"""Curves over time, one page of them at once: what is not shown is not sent."""

from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray
from viser import GuiUplotHandle, Icon, ViserServer

from hectorscope.page.scene import Scene
from hectorscope.page.theme import Theme, css
from hectorscope.panels._curves import AGAINST_TRUTH, LOG_FLOOR, PAGES, WINDOWS, Chart
from hectorscope.panels._decimate import decimate
from hectorscope.panels._truth_error import truth_error
from hectorscope.session.snapshot import Snapshot

POINTS = 300  # of a curve: about one a pixel
HEIGHT = 132  # pixels of a chart


class PlotsPanel:
    """A docked panel of its own below the controls, so that curves and settings are seen together."""

    title = "Plots"
    order = 40
    rate = 2.5  # a curve of 30 s moves by four pixels in between; each time it takes 19 KB

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._drawn: tuple[int, str, str, Theme] | None = None
        gui = scene.server.gui
        panel = gui.add_panel()
        with panel.add_tab(self.title, Icon.CHART_LINE):
            gui.add_html('<i class="hs-mark hs-plots"></i>')
            self._page = gui.add_dropdown("Show", tuple(PAGES), initial_value="Covariance")
            self._window = gui.add_dropdown("Window", tuple(WINDOWS), initial_value="30 s")
            self._nothing = gui.add_html(NOTHING)
            self._charts = {
                page: [ChartPlot(scene.server, c, scene.theme) for c in charts] for page, charts in PAGES.items()
            }
        panel.dock_below(gui.main_panel)

    def draw(self, snapshot: Snapshot) -> None:
        """Send the shown page's curves if there is something new in them."""
        page, window, theme = self._page.value, self._window.value, self._scene.theme
        state = (snapshot.sequence, page, window, theme)
        if state == self._drawn:
            return
        if self._drawn is not None and self._drawn[-1] is not theme:
            self._drawn = None
            for chart in chain(*self._charts.values()):
                chart.wear(theme)
            return
        self._drawn = state
        rows = truth_error(snapshot) if page == AGAINST_TRUTH else snapshot.series
        first = recent(rows, WINDOWS[window])
        shown = [
            chart.draw(rows if name == page else None, first)
            for name, charts in self._charts.items()
            for chart in charts
        ]
        if self._nothing.visible == any(shown):
            self._nothing.visible = not any(shown)


def recent(series: NDArray[np.void], window: float) -> int:
    """The number of the first row of the last `window` seconds."""
    if len(series) == 0 or not np.isfinite(window):
        return 0
    times = series["time_s"]
    return int(np.searchsorted(times, times[-1] - window))


class ChartPlot:
    """One chart in the page."""

    def __init__(self, server: ViserServer, chart: Chart, theme: Theme) -> None:
        self._server, self._chart = server, chart
        self._handle: GuiUplotHandle = server.gui.add_uplot(
            (np.ones(1),) * (1 + len(chart.curves)),
            series_options(chart, theme),
            title=chart.title,
            axes=AXES,
            height=HEIGHT,
            scales={"x": {"time": False}, "y": {"distr": 3 if chart.log else 1}},
            padding=(9, 12, 0, 0),
            cursor={"y": False},
            visible=False,
        )

    def draw(self, series: NDArray[np.void] | None, first: int) -> bool:
        """Show the rows from `first` on, and whether there are any; None hides the chart."""
        data = curves(self._chart, series, first) if series is not None else ()
        with self._server.atomic():
            if data:
                self._handle.data = data  # type: ignore[assignment]  # the page takes float32: half the bytes
            if self._handle.visible != bool(data):
                self._handle.visible = bool(data)
        return bool(data)

    def wear(self, theme: Theme) -> None:
        """Take other colours, hidden until the next `draw`: a chart rebuilt in sight loses its time axis."""
        with self._server.atomic():
            self._handle.visible = False
            self._handle.series = series_options(self._chart, theme)


def curves(chart: Chart, series: NDArray[np.void], first: int) -> tuple[NDArray[np.float32], ...]:
    """Time and the curves, thinned, in the chart's unit; nothing when no curve has two finite values."""
    known = np.any([np.isfinite(series[curve.column][first:]) for curve in chart.curves], axis=0)
    first += int(np.argmax(known)) if len(known) else 0  # with a gap in front its axis would find no range
    whole = [series[curve.column] for curve in chart.curves]
    values = [(np.unwrap(column) if chart.angles else column)[first:] for column in whole]
    if not any(np.count_nonzero(np.isfinite(column)) > 1 for column in values):
        return ()
    x, columns = decimate(series["time_s"][first:], values, POINTS, first)
    floor = LOG_FLOOR if chart.log else -np.inf
    return x.astype(np.float32), *(np.maximum(c * chart.factor, floor).astype(np.float32) for c in columns)


def series_options(chart: Chart, theme: Theme) -> tuple[Any, ...]:
    """Description for uPlot of time and the curves."""
    return (
        {"label": "s"},
        *(
            {"label": c.name, "stroke": colour(c.colour, theme), "width": 1.5, "points": {"show": False}}
            for c in chart.curves
        ),
    )


def colour(name: str | int, theme: Theme) -> str:
    """A curve's colour as CSS."""
    return css(theme.series[name % len(theme.series)] if isinstance(name, int) else getattr(theme, name))


NOTHING = '<p class="hs-empty">No data yet.</p>'
AXES: tuple[Any, ...] = (
    {"size": 22, "font": "11px system-ui, sans-serif", "space": 60, "ticks": {"size": 3}},
    {"size": 44, "font": "11px system-ui, sans-serif", "space": 24, "ticks": {"size": 3}},
)

PANEL = PlotsPanel
