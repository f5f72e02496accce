"""The last scan match in numbers, the three covariances side by side, and what the colours on the map mean."""

import math

import numpy as np
from viser import Icon

from app.panels import _workspace
from app.panels._format import figure, fixed
from app.panels._handles import put
from app.snapshot import Snapshot
from app.web.stage import Stage
from slam_core.results import StepResult

ROWS = (("match", "match", "R, eq. (15)"), ("filter", "prior", "P before"), ("fused", "fused", "P⁺, eq. (16)"))


class MatchPanel:
    """Two read-outs and a legend below the dials."""

    title = "Match"
    order = 30
    rate = 5.0

    def __init__(self, stage: Stage) -> None:
        gui = stage.server.gui
        with _workspace.tab(stage, "Live", Icon.GAUGE):
            self._match = gui.add_html("")
            self._sigmas = gui.add_html("")
            gui.add_html(LEGEND)

    def draw(self, snapshot: Snapshot) -> None:
        """Bring the read-outs up to date."""
        result = snapshot.result
        if result is None:
            return
        put(self._match, match_html(result, snapshot))
        put(self._sigmas, sigmas_html(snapshot.series[-1]))


def match_html(result: StepResult, snapshot: Snapshot) -> str:
    """State of the tracking, residual, iterations, beams, map updates, the weakest direction and surprises."""
    match = result.match
    cells = [figure("beams", str(result.beams)), figure("map updates", str(snapshot.map_updates))]
    if match is None:
        return readout([figure("scan", str(snapshot.scans)), *cells, figure("", "first scan")])
    state = figure("", "converged", "good") if match.converged else figure("", "out of steps", "bad")
    tracking = figure("", result.tracking, "good" if result.tracking in {"tracking", "recovered"} else "bad")
    unexpected = figure("unexpected %", fixed(100.0 * float(np.mean(result.unexpected)), 1))
    weakest = figure("weakest σ mm", fixed(1e3 * match.weakest_sigma, 1))
    share = figure(
        "fixed by", f"{100 * match.weakest_share:.1f} % of beams", "bad" if match.blind.any() else "good"
    )
    steps = figure("iterations", " · ".join(str(n) for n in match.iterations))
    return readout(
        [
            tracking,
            figure("residual", fixed(match.mean_residual, 3)),
            steps,
            state,
            figure("scan", str(snapshot.scans)),
            *cells,
            weakest,
            unexpected,
            share,
        ]
    )


def readout(figures: list[str]) -> str:
    """Figures that flow over two lines."""
    return f'<div class="hs-readout">{"".join(figures)}</div>'


def sigmas_html(row: np.void) -> str:
    """One sigma of each covariance, in millimetres and degrees; the swatches are the legend of the ellipses."""
    lines = []
    for name, colour, note in ROWS:
        x, y, yaw = (float(row[f"{name}_sigma_{axis}"]) for axis in ("x", "y", "yaw"))
        cells = "".join(
            f"<td>{v}</td>" for v in (fixed(1e3 * x, 1), fixed(1e3 * y, 1), fixed(math.degrees(yaw), 2))
        )
        lines.append(f'<tr><th title="{note}">{ring(colour)}{name}</th>{cells}</tr>')
    head = "<tr><th>1 σ</th><td>x mm</td><td>y mm</td><td>ψ °</td></tr>"
    return f'<table class="hs-sigmas"><thead>{head}</thead><tbody>{"".join(lines)}</tbody></table>'


def ring(colour: str) -> str:
    """A small ellipse in one of the palette's colours."""
    return f'<i class="hs-ring" style="color:var(--hs-{colour})"></i>'


UNEXPECTED = "Beams that end where the map knows free space: something new, or somebody on the move."
LEGEND = (
    '<div class="hs-legend"><span><i class="hs-line" style="color:var(--hs-trajectory)"></i>trajectory</span>'
    '<span><i class="hs-line hs-dashed" style="color:var(--hs-truth)"></i>truth</span>'
    f'<span>{ring("position")}position</span><span>residual 0<i class="hs-ramp"></i>1</span>'
    f'<span title="{UNEXPECTED}">{ring("unexpected")}unexpected</span></div>'
)

PANEL = MatchPanel
