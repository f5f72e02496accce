"""The last scan match in numbers, the three covariances side by side, and what the colours on the map mean."""

import math

import numpy as np
from viser import Icon

from hectorscope.page.scene import Display, Scene
from hectorscope.panels import _workspace
from hectorscope.panels._format import figure, fixed, left_out, number, tip
from hectorscope.panels._handles import put
from hectorscope.run.marks import WEAK
from hectorscope.run.wording import verdict_text
from hectorscope.session.snapshot import Snapshot
from slam_core.results import MatchResult, StepResult

ROWS = ("match", "prior", "fused")


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
        put(self._match, match_html(result, snapshot) if result else NOTHING)
        put(self._sigmas, sigmas_html(snapshot.series[-1]) if result else "")
        put(self._legend, legend_html(snapshot, self._scene.display) if result else "")


def match_html(result: StepResult, snapshot: Snapshot) -> str:
    """State of the tracking, residual, iterations, beams, map updates, the weakest direction and surprises."""
    match = result.match
    counts = [
        figure("scan", str(snapshot.scans)),
        figure("beams", str(result.beams)),
        figure("map updates", str(snapshot.map_updates)),
    ]
    if match is None:
        return readout([*counts, figure("tracking", "first scan", caption="")])
    return readout([*_fit(result, match), *counts, *_certainty(result, match)])


def _fit(result: StepResult, match: MatchResult) -> list[str]:
    """Whether the scan was matched, and how well."""
    good = result.tracking in {"tracking", "recovered"}
    why = verdict_text(result.verdict)
    word = f"{'✓' if good else '✕'} {result.tracking}"
    outcome = ("good", "converged") if match.converged else ("bad", "out of steps before it converged")
    return [
        figure("tracking", word, "good" if good else "bad", caption="", more=why),
        figure("residual", fixed(match.mean_residual, 3)),
        figure("steps", " · ".join(str(n) for n in match.iterations), outcome[0], more=outcome[1]),
    ]


def _certainty(result: StepResult, match: MatchResult) -> list[str]:
    """What the scan knows worst, and what contradicts the map."""
    few = "few beams fix" if match.weakest_share < WEAK else ""
    fixed_by = "too few beams fix" if match.leaves_direction else few
    more = f"{fixed_by} the position along a direction now" if fixed_by else ""
    return [
        figure("weakest σ", fixed(1e3 * match.weakest_sigma, 1) + " mm"),
        figure("support", f"{100 * match.weakest_share:.0f} %", "bad" if more else "", more=more),
        figure("unexpected", fixed(100.0 * float(np.mean(result.unexpected)), 0) + " %", more=left_out(match)),
    ]


def readout(figures: list[str]) -> str:
    """Figures in three columns."""
    return f'<div class="hs-readout">{"".join(figures)}</div>'


def sigmas_html(row: np.void) -> str:
    """One sigma of each covariance, in millimetres and degrees; the swatches are the legend of the ellipses."""
    lines = []
    for name in ROWS:
        x, y, yaw = (float(row[f"{name}_sigma_{axis}"]) for axis in ("x", "y", "yaw"))
        cells = "".join(
            f"<td>{v}</td>" for v in (fixed(1e3 * x, 1), fixed(1e3 * y, 1), fixed(math.degrees(yaw), 2))
        )
        lines.append(f"<tr {tip(name)}><th>{toggle(name, ring(name) + name)}</th>{cells}</tr>")
    head = f"<tr {tip('sigmas')}><th>1 σ</th><td>x mm</td><td>y mm</td><td>ψ °</td></tr>"
    return f'<table class="hs-sigmas"><thead>{head}</thead><tbody>{"".join(lines)}</tbody></table>'


def ring(colour: str) -> str:
    """A small ellipse in one of the palette's colours."""
    return f'<i class="hs-ring" style="color:var(--hs-{colour})"></i>'


def legend_html(snapshot: Snapshot, display: Display) -> str:
    """What the lines and colours on the map mean, if there; a click on an entry hides its layer there."""
    result = snapshot.result
    coloured = display.points == "residual"
    entries = (
        (True, "trajectory", f"{line('trajectory')}trajectory"),
        (len(snapshot.truth) > 0, "truth", f"{line('truth', 'hs-dashed')}truth"),
        (True, "", f"<span {tip('ellipses')}>ellipses of {number(display.ellipse_scale, 4)} σ</span>"),
        (result and result.navigation, "position", f"{ring('position')}position"),
        (coloured, "scan", f'<span {tip("residuals")}>residual 0<i class="hs-ramp"></i>1</span>'),
        (coloured, "scan", f"<span {tip('unexpected')}>{ring('unexpected')}unexpected</span>"),
    )
    shown = "".join(toggle(layer, entry) for there, layer, entry in entries if there)
    return f'<div class="hs-legend">{shown}</div>'


def toggle(layer: str, entry: str) -> str:
    """An entry of the legend that shows and hides its layer, if it has one, in one browser (static/browser.js)."""
    if not layer:
        return f"<span>{entry}</span>"
    return f'<button type="button" class="hs-entry" data-hs-own="layers" data-hs-layer="{layer}">{entry}</button>'


def line(colour: str, style: str = "") -> str:
    """A short line in one of the palette's colours."""
    return f'<i class="hs-line {style}" style="color:var(--hs-{colour})"></i>'


NOTHING = '<p class="hs-empty">No scan yet.</p>'

PANEL = MatchPanel
