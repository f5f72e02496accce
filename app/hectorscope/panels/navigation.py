"""The navigation filter: what is wrong, which sources aid it, their gates, its biases, and the last fusion."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from viser import Icon

from hectorscope.page.scene import Scene
from hectorscope.panels import _workspace
from hectorscope.panels._dials import horizon_svg, turn_css
from hectorscope.panels._ellipses import SIGMAS, ellipses_svg
from hectorscope.panels._format import figure, fixed, text, tip
from hectorscope.panels._handles import put
from hectorscope.session.snapshot import Snapshot
from slam_core.config import AidingConfig, NavigationConfig
from slam_core.geometry import to_euler
from slam_core.results import AidingStatus, NavigationState, PlanarGaussian, StepResult

SILENT_NS = 2_000_000_000  # a source that was not heard for this long is silent
SWITCHES = {
    "gps": "gps",
    "gps velocity": "gps",
    "compass": "compass",
    "ground": "ground",
    "attitude": "attitude",
    "standstill": "standstill",
    "gravity": "standstill",
    "zero rate": "standstill",
}
HORIZON = horizon_svg("hs-filter-horizon")
NO_FILTER = (
    '<p class="hs-empty">Without inertial data there is no navigation filter: the matches alone predict the'
    " motion.</p>"
)


class NavigationPanel:
    """A tab beside the live read-outs."""

    title = "Navigation"
    order = 35
    rate = 4.0

    def __init__(self, scene: Scene) -> None:
        gui = scene.server.gui
        with _workspace.tab(scene, "Filter", Icon.COMPASS):
            self._turn = gui.add_html("")
            self._faults = gui.add_html("")
            self._fusion = gui.add_html(NO_FILTER)
            self._sources = gui.add_html("")
            self._biases = gui.add_html("")
            self._unused = gui.add_html("")

    def draw(self, snapshot: Snapshot) -> None:
        """Bring the tables up to date."""
        put(self._faults, faults_html(snapshot.warnings))
        put(self._unused, unused_html(snapshot.unused))
        result = snapshot.result
        state = result.navigation if result else None
        if result is None or state is None:
            put(self._fusion, NO_FILTER)
            aided = result is not None and bool(result.aiding)
            put(self._sources, sources_html(result, snapshot.config.aiding) if result and aided else "")
            put(self._biases, "")
            return
        put(self._turn, turn_css("hs-fusion", *to_euler(state.T_map_base.rotation)))
        put(self._fusion, fusion_html(result, state))
        put(self._sources, sources_html(result, snapshot.config.aiding))
        put(self._biases, biases_html(state, snapshot.config.navigation))


def faults_html(warnings: Sequence[str]) -> str:
    """What is wrong at this moment, a line each; nothing if all is well."""
    return "".join(f'<p class="hs-fault">{text(warning)}</p>' for warning in warnings)


def unused_html(unused: Mapping[str, int]) -> str:
    """How much was not used as it came, by reason; nothing if all was."""
    lines = "".join(f"<li>{count} × {text(reason)}</li>" for reason, count in unused.items())
    return f'<ul class="hs-unused" {tip("unused")}>{lines}</ul>' if lines else ""


def fusion_html(result: StepResult, state: NavigationState) -> str:
    """The ellipses of the last fusion, and how sure the filter is of the rest."""
    layers: dict[str, PlanarGaussian] = {}
    if result.prior is not None:
        layers["prior"] = result.prior
    if result.match is not None:
        layers["match"] = result.match.gaussian
    layers["fused"] = result.fused
    sigma = np.sqrt(np.maximum(np.diag(state.covariance), 0.0))
    speed = float(np.linalg.norm(state.velocity))
    figures = [
        figure("tilt 3σ", f"{fixed(3 * math.degrees(float(sigma[:2].max())), 2)}°"),
        figure("heading 3σ", f"{fixed(3 * math.degrees(float(sigma[2])), 2)}°"),
        figure("height 3σ", f"{fixed(3 * float(sigma[5]), 2)} m"),
        figure("speed", f"{fixed(speed, 2)} ± {fixed(3 * float(sigma[6:8].max()), 2)}", caption="speed, m/s"),
        *_world(result.world),
    ]
    names = "".join(f'<span class="hs-of-{name}"><i class="hs-ring"></i>{name}</span>' for name in layers)
    return (
        f'<div class="hs-fusion">{HORIZON}{ellipses_svg(layers, result.fused)}<div>{"".join(figures)}</div></div>'
        f'<div class="hs-legend">{names}<span {tip("fusion ellipses")}>ellipses of {SIGMAS:g} σ</span></div>'
    )


def _world(pose: PlanarGaussian | None) -> list[str]:
    """How far the map's x axis is turned from east, once satellites have measured it."""
    if pose is None:
        return []
    turn, sigma = math.degrees(float(pose.mean[2])), math.degrees(math.sqrt(float(pose.covariance[2, 2])))
    return [figure("from east", f"{fixed(turn, 0)}° ± {fixed(3 * sigma, 0)}°")]


@dataclass(frozen=True, slots=True)
class Standing:
    """Where a source stands: a word for its state, and the innovation as a share of its gate (None: no gate)."""

    word: str
    share: float | None


def standing(status: AidingStatus, now_ns: int, aiding: AidingConfig) -> Standing:
    """live, rejected, frozen, silent or off."""
    share = math.sqrt(status.nis / status.bound) if 0.0 < status.bound < math.inf and status.nis >= 0.0 else None
    switch = SWITCHES.get(status.source)
    if switch is not None and not getattr(aiding, switch):
        return Standing("off", None)
    if now_ns - status.stamp_ns > SILENT_NS:
        return Standing("silent", None)
    if status.frozen:
        return Standing("frozen", share)
    return Standing("live" if status.accepted else "rejected", share)


def sources_html(result: StepResult, aiding: AidingConfig) -> str:
    """A row a source: state, innovation over gate, how many were used and how many not."""
    heads = {"innovation": "innovation", "used": "used", "rejected count": "rejected", "not used": "not used"}
    names = "".join(f"<td {tip(name)}>{word}</td>" for name, word in heads.items())
    rows = "".join(_row(status, standing(status, result.stamp_ns, aiding)) for status in result.aiding)
    return f'<table class="hs-sources"><thead><tr><th>source</th>{names}</tr></thead><tbody>{rows}</tbody></table>'


def _row(status: AidingStatus, stands: Standing) -> str:
    share = stands.share
    bar = "" if share is None else f'<i class="hs-bar-of"><i style="width:{100 * min(share, 1.0):.0f}%"></i></i>'
    reasons = "; ".join(f"{count} × {reason}" for reason, count in status.dropped.items())
    return (
        f'<tr class="hs-is-{stands.word}"><th {tip(stands.word)}><i></i>{text(status.source)}'
        f"<small>{stands.word}</small></th><td {tip('innovation', _innovation(status))}>{bar}</td>"
        f"<td {tip('used')}>{status.used}</td><td {tip('rejected count')}>{status.rejected}</td>"
        f"<td {tip('not used', reasons)}>{sum(status.dropped.values())}</td></tr>"
    )


def _innovation(status: AidingStatus) -> str:
    """The last one, with its sigma."""
    pairs = zip(status.innovation, status.sigma, strict=True)
    return ", ".join(f"{v:.3g} ± {s:.2g}" for v, s in pairs)


def biases_html(state: NavigationState, config: NavigationConfig) -> str:
    """Each bias with three sigma, on a track as wide as it could be at the start."""
    sigma = np.sqrt(np.maximum(np.diag(state.covariance), 0.0))
    degrees = math.degrees(1.0)
    rows = (
        _bias_row("gyro °/s", degrees * state.gyro_bias, degrees * sigma[9:12], degrees * config.gyro_bias_sigma),
        _bias_row("accel m/s²", state.accel_bias, sigma[12:15], config.accel_bias_sigma),
    )
    head = f"<tr {tip('biases')}><th>bias ± 3σ</th><td>x</td><td>y</td><td>z</td></tr>"
    return f'<table class="hs-biases"><thead>{head}</thead><tbody>{"".join(rows)}</tbody></table>'


def _bias_row(name: str, values: np.ndarray, sigmas: np.ndarray, limit: float) -> str:
    cells = "".join(_bias(float(v), 3 * float(s), 3 * limit) for v, s in zip(values, sigmas, strict=True))
    return f"<tr {tip(name)}><th>{name}</th>{cells}</tr>"


def _bias(value: float, bound: float, limit: float) -> str:
    """Numbers over a track from -limit to limit: a band of the bounds, a tick at the value."""
    low, middle, high = (
        50.0 + 50.0 * max(-1.0, min(1.0, v / limit)) for v in (value - bound, value, value + bound)
    )
    return (
        f"<td>{fixed(value, 2)} <small>± {fixed(bound, 2)}</small>"
        f'<i class="hs-track"><i style="left:{low:.0f}%;width:{high - low:.0f}%"></i>'
        f'<b style="left:{middle:.0f}%"></b></i></td>'
    )


PANEL = NavigationPanel
