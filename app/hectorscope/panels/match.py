"""The last scan match in numbers, the three covariances side by side, and what the colours on the map mean."""

import math

import numpy as np
from viser import Icon

from hectorscope.page.scene import Display, Scene
from hectorscope.panels import _workspace
from hectorscope.panels._format import figure, fixed, number
from hectorscope.panels._handles import put
from hectorscope.session.snapshot import Snapshot
from slam_core.results import StepResult

ROWS = (("match", "match", "R, eq. (15)"), ("prior", "prior", "P before"), ("fused", "fused", "P⁺, eq. (16)"))


class MatchPanel:
    """Two read-outs and a legend below the dials."""

    title = "Match"
    order = 30
    rate = 5.0

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        gui = scene.server.gui
        with _workspace.tab(scene, "Live", Icon.GAUGE):
            self._match = gui.add_html("")
            self._sigmas = gui.add_html("")
            self._legend = gui.add_html("")

    def draw(self, snapshot: Snapshot) -> None:
        """Bring the read-outs up to date."""
        result = snapshot.result
        if result is None:
            return
        put(self._match, match_html(result, snapshot))
        put(self._sigmas, sigmas_html(snapshot.series[-1]))
        put(self._legend, legend_html(snapshot, self._scene.display))


def match_html(result: StepResult, snapshot: Snapshot) -> str:
    """State of the tracking, residual, iterations, beams, map updates, the weakest direction and surprises."""
    match = result.match
    counts = [
        figure("scan", str(snapshot.scans)),
        figure("beams", str(result.beams)),
        figure("map updates", str(snapshot.map_updates)),
    ]
    if match is None:
        return readout([*counts, figure("", "first scan")])
    tracking = figure("", result.tracking, "good" if result.tracking in {"tracking", "recovered"} else "bad")
    residual = figure("residual", fixed(match.mean_residual, 3))
    outcome = ("good", "converged") if match.converged else ("bad", "out of steps before it converged")
    steps = figure("steps", " · ".join(str(n) for n in match.iterations), *outcome)
    weakest = figure("weakest", fixed(1e3 * match.weakest_sigma, 1) + " mm", hint=WEAKEST)
    share = figure(
        "fixed by", f"{100 * match.weakest_share:.1f} %", "bad" if match.unobservable.any() else "", FIXED
    )
    unexpected = figure("unexpected", fixed(100.0 * float(np.mean(result.unexpected)), 1) + " %", hint=UNEXPECTED)
    return readout([tracking, residual, steps, *counts, weakest, share, unexpected])


def readout(figures: list[str]) -> str:
    """Figures in three columns."""
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


WEAKEST = "Sigma of the position in the direction that the match fixes worst."
FIXED = "Share of the beams that fix the position in the direction that the shape of the scan fixes worst."
UNEXPECTED = "Beams that end where the map knows free space: something new, or somebody on the move."


def legend_html(snapshot: Snapshot, display: Display) -> str:
    """What the lines and colours on the map mean, if there; static/dress.js hides those of hidden layers."""
    result = snapshot.result
    coloured = display.points == "residual"
    entries = (
        (True, "trajectory", f"{line('trajectory')}trajectory"),
        (len(snapshot.truth) > 0, "truth", f"{line('truth', 'hs-dashed')}truth"),
        (True, "fused", f"ellipses of {number(display.ellipse_scale, 4)} σ"),
        (result and result.navigation, "position", f"{ring('position')}position"),
        (coloured, "scan", 'residual 0<i class="hs-ramp"></i>1'),
        (coloured, "scan", f'<span title="{UNEXPECTED}">{ring("unexpected")}unexpected</span>'),
    )
    shown = "".join(f'<span data-hs-of="{layer}">{entry}</span>' for there, layer, entry in entries if there)
    return f'<div class="hs-legend">{shown}</div>'


def line(colour: str, style: str = "") -> str:
    """A short line in one of the palette's colours."""
    return f'<i class="hs-line {style}" style="color:var(--hs-{colour})"></i>'


PANEL = MatchPanel
