"""The last scan match in numbers, the three covariances side by side, and what the colours on the map mean."""

import numpy as np
from viser import Icon

from app.panels import _workspace
from app.panels._format import figure, fixed
from app.panels._handles import put
from app.snapshot import Snapshot
from app.web.stage import Stage
from app.web.theme import Theme, css
from slam_core.results import MatchResult

ROWS = (("match", "match", "R, eq. (15)"), ("filter", "prior", "P before"), ("fused", "fused", "P⁺, eq. (16)"))


class MatchPanel:
    """Two read-outs and a legend below the dials."""

    title = "Match"
    order = 30
    rate = 5.0

    def __init__(self, stage: Stage) -> None:
        self._stage = stage
        self._legend_theme: Theme | None = None
        gui = stage.server.gui
        with _workspace.tab(stage, "Live", Icon.GAUGE):
            self._match = gui.add_html("")
            self._sigmas = gui.add_html("")
            self._legend = gui.add_html("")

    def draw(self, snapshot: Snapshot) -> None:
        """Bring the read-outs up to date."""
        theme = self._stage.theme
        if theme is not self._legend_theme:
            self._legend_theme = theme
            self._legend.content = legend_html(theme)
        result = snapshot.result
        if result is None:
            return
        put(self._match, match_html(result.match, result.beams, snapshot))
        put(self._sigmas, sigmas_html(snapshot.series[-1:], theme))


def match_html(match: MatchResult | None, beams: int, snapshot: Snapshot) -> str:
    """Residual, iterations, beams, map updates."""
    cells = [figure("beams", str(beams)), figure("map updates", str(snapshot.map_updates))]
    if match is None:
        return readout([figure("scan", str(snapshot.scans)), *cells, figure("", "first scan")])
    state = figure("", "converged", "good") if match.converged else figure("", "out of steps", "bad")
    steps = figure("iterations", " · ".join(str(n) for n in match.iterations))
    return readout(
        [
            figure("residual", fixed(match.mean_residual, 3)),
            steps,
            state,
            figure("scan", str(snapshot.scans)),
            *cells,
        ]
    )


def readout(figures: list[str]) -> str:
    """Figures that flow over two lines."""
    return f'<div class="hs-readout">{"".join(figures)}</div>'


def sigmas_html(row: np.ndarray, theme: Theme) -> str:
    """One sigma of each covariance, in millimetres and degrees; the swatches are the legend of the ellipses."""
    lines = []
    for name, colour, note in ROWS:
        x, y, yaw = (float(row[f"{name}_sigma_{axis}"][0]) for axis in ("x", "y", "yaw"))
        swatch = f'<i class="hs-ring" style="border-color:{css(getattr(theme, colour))}"></i>'
        cells = "".join(
            f"<td>{value}</td>" for value in (fixed(1e3 * x, 1), fixed(1e3 * y, 1), fixed(np.degrees(yaw), 2))
        )
        lines.append(f'<tr><th title="{note}">{swatch}{name}</th>{cells}</tr>')
    head = "<tr><th>1 σ</th><td>x mm</td><td>y mm</td><td>ψ °</td></tr>"
    return f'<table class="hs-sigmas"><thead>{head}</thead><tbody>{"".join(lines)}</tbody></table>'


def legend_html(theme: Theme) -> str:
    """Lines, the robot's marks and the scale of the residuals."""
    ramp = ", ".join(css(stop) for stop in theme.ramp)
    return (
        '<div class="hs-legend">'
        f'<span><i class="hs-line" style="background:{css(theme.trajectory)}"></i>trajectory</span>'
        f'<span><i class="hs-line hs-dashed" style="color:{css(theme.truth)}"></i>truth</span>'
        f'<span><i class="hs-ring" style="border-color:{css(theme.position)}"></i>position</span>'
        f'<span>residual 0<i class="hs-ramp" style="background:linear-gradient(90deg, {ramp})"></i>1</span></div>'
    )


PANEL = MatchPanel
