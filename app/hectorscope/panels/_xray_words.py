"""The equations of the paper with the numbers of the shown scan put in, as HTML."""

import math
from collections.abc import Iterable
from html import escape

import numpy as np

from hectorscope.panels._format import fixed, left_out, number
from hectorscope.run.xray.attitude import ASIDE, OMEGA, REACH, Passage
from hectorscope.run.xray.covariances import Cloud, Fusion
from hectorscope.run.xray.landscape import FOUND, UNTRIED, Basin, Landscape
from hectorscope.run.xray.lens import Lens
from slam_core.measurements import Float64s
from slam_core.reference.scan_matching import Iteration, hessian_covariance
from slam_core.results import MatchResult

NOTHING = (
    "<p>Pause a recording to look at the match of one scan, or go to a scan of your own. If this text stays, step"
    " one scan back (,) and forward (.).</p>"
)
FIRST = "<p>This scan was matched to nothing: it made the map. Step one scan forward (.).</p>"
ON_THE_WAY = "<p>The run is processed again up to this scan.</p>"


def unreached(reason: str) -> str:
    """Why a scan cannot be looked at."""
    return f"<p>This scan cannot be looked at: {escape(reason)}.</p>"


def equation(name: str, formula: str, value: str) -> str:
    """A numbered equation, and what it gives here."""
    head = f"<p><b>{name}</b><span>{formula}</span></p>"
    return f'<div class="hs-equation">{head}<div class="hs-value">{value}</div></div>'


def matrix(values: Float64s) -> str:
    """Rows of numbers between brackets."""
    rows = "".join(
        f"<tr>{''.join(f'<td>{number(v)}</td>' for v in row)}</tr>" for row in np.atleast_2d(values).tolist()
    )
    return f'<table class="hs-matrix">{rows}</table>'


def pose(values: Float64s) -> str:
    """Metres and degrees."""
    return f"{fixed(values[0], 4)} m, {fixed(values[1], 4)} m, {fixed(math.degrees(values[2]), 3)}°"


def small(values: Float64s) -> str:
    """Millimetres and degrees."""
    return f"{fixed(1e3 * values[0], 2)} mm, {fixed(1e3 * values[1], 2)} mm, {fixed(math.degrees(values[2]), 4)}°"


def table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """Figures in columns; the first names the row."""
    top = "".join(f"<th>{word}</th>" for word in head)
    body = "".join(
        "<tr><th>{}</th>{}</tr>".format(name, "".join(f"<td>{v}</td>" for v in values)) for name, *values in rows
    )
    return f'<table class="hs-xray-table"><tr>{top}</tr>{body}</table>'


def steps_html(found: tuple[Iteration, ...], k: int, resolution: float, sigma: float) -> str:
    """One iteration; the last one is an evaluation without a step."""
    now = found[k]
    same = [i for i, each in enumerate(found[:-1]) if each.level == now.level]
    last = k == len(found) - 1
    where = "evaluation at ξ*" if last else f"iteration {same.index(k) + 1} of {len(same)}"
    title = f"<h3>Level {now.level} · cells of {number(100 * resolution, 4)} cm · {where}</h3>"
    after = "" if last else f" → {fixed(found[k + 1].cost, 3)}" if found[k + 1].level == now.level else ""
    after = after and f"{after} after the step"
    parts = [
        equation("ξ", "= (x, y, ψ)", pose(now.pose)),
        equation("(7)", "Σ [1 − M(S<sub>i</sub>(ξ))]²", f"{fixed(now.cost, 3)}{after}"),
        equation("(13)", "H = Σ [∇M ∂S/∂ξ]<sup>T</sup> [∇M ∂S/∂ξ]", matrix(now.H)),
        equation("b of (12)", "Σ [∇M ∂S/∂ξ]<sup>T</sup> [1 − M]", matrix(now.b)),
    ]
    if not last:
        parts.append(equation("(12)", "Δξ = H<sup>−1</sup> b", small(now.step)))
    if np.linalg.matrix_rank(now.H) == 3:
        R = hessian_covariance(now.H, sigma)
        parts.append(
            equation("(15)", f"R = σ² H<sup>−1</sup>, σ = {number(sigma)}: 1 σ", small(np.sqrt(np.diag(R))))
        )
    parts.append(equation("λ", "of H, position", eigen(now.H)))
    return title + "".join(parts)


def left_out_html(match: MatchResult) -> str:
    """That the run did without some beams, and the X-ray does too; nothing if it took all."""
    words = left_out(match)
    return f"<p>{words}, and are here.</p>" if words else ""


def eigen(H: Float64s) -> str:
    """Eigenvalues of the position block, the larger first, and the directions of their vectors."""
    values, axes = np.linalg.eigh(H[:2, :2])
    angles = [math.degrees(math.atan2(axes[1, j], axes[0, j])) % 180.0 for j in (1, 0)]
    named = zip(("λ₁", "λ₂"), values[::-1].tolist(), angles, strict=True)
    return ", ".join(f"{name} = {number(value)} at {fixed(angle, 0)}°" for name, value, angle in named)


def landscape_html(found: Landscape, basin: Basin | None, matched: Float64s, resolution: float) -> str:
    """The lowest cost and where it is; how much of the basin is known."""
    costs = found.costs
    away = found.lowest - matched
    rows = [
        ("lowest (7)", fixed(float(costs.min()), 3)),
        ("highest (7)", fixed(float(costs.max()), 3)),
        ("lowest pose, from ξ*", small(away)),
        ("from pose to pose", _steps(found)),
    ]
    title = f"<h3>Level {found.level} · cells of {number(100 * resolution, 4)} cm</h3>"
    parts = title + table(("", ""), rows)
    if basin is not None:
        tried = max(int((basin.outcome != UNTRIED).sum()), 1)
        share = float((basin.outcome == FOUND).sum()) / tried
        parts += table(
            ("Basin", ""),
            [
                ("starts tried", f"{basin.tried} of {basin.outcome.size}"),
                ("end at ξ*", f"{fixed(100 * share, 1)} %"),
            ],
        )
    return parts


def _steps(found: Landscape) -> str:
    along, up = found.around.step
    second = f"{fixed(1e3 * up, 1)} mm" if found.around.plane == "xy" else f"{fixed(math.degrees(up), 2)}°"
    return f"{fixed(1e3 * along, 1)} mm, {second}"


def ends_html(start: Float64s, end: Float64s, matched: Float64s, same: bool) -> str:
    """Where the matcher goes from the dragged start."""
    word = "<b class='hs-good'>ends at ξ*</b>" if same else "<b class='hs-bad'>ends elsewhere</b>"
    rows = [("start, from ξ*", small(start - matched)), ("end, from ξ*", small(end - matched))]
    return f"<p>From this start the matcher {word}.</p>{table(('', ''), rows)}"


def lens_html(found: Lens) -> str:
    """Eqs. (4)-(6) at a place."""
    p00, p10, p01, p11 = (fixed(p, 4) for p in found.corners)
    x, y = (fixed(v, 3) for v in found.share.tolist())
    cells = matrix(np.array([[found.corners[2], found.corners[3]], [found.corners[0], found.corners[1]]]))
    formula = f"{y} ({x} · {p11} + (1 − {x}) · {p01})<br>+ (1 − {y}) ({x} · {p10} + (1 − {x}) · {p00})"
    rows = [
        ("∂M/∂x (5)", *(number(v[0], 5) for v in (found.gradient, found.differences))),
        ("∂M/∂y (6)", *(number(v[1], 5) for v in (found.gradient, found.differences))),
    ]
    where = f"cell {found.cell[0]}, {found.cell[1]} · {number(100 * found.resolution, 4)} cm"
    return (
        f"<h3>Level {found.level} · {where}</h3>"
        + equation("P", "P<sub>01</sub> P<sub>11</sub> above P<sub>00</sub> P<sub>10</sub>", cells)
        + equation("(4)", formula, f"M = {fixed(found.M, 4)}")
        + table(("1/m", "equation", "difference"), rows)
    )


def covariance_html(found: Fusion, cloud: Cloud, matched: Float64s, omega: float) -> str:
    """One sigma of each covariance, and of the cloud. omega: of the run."""
    named = {
        "prior": ("prior P", found.P),
        "match": ("scan R (15)", found.R),
        "sampled": ("R sampled", found.sampled),
        "fused": (f"P+ (18), ω {fixed(found.omega, 3)}", found.fused),
        "optimal": (f"P+ (18), best ω {fixed(found.best, 3)}", found.optimal),
        "kalman": ("Kalman", found.kalman),
        "cloud": (f"cloud of {len(cloud)}", cloud.covariance),
    }
    rows = [(f'<i class="hs-xray-key hs-xray-{key}"></i>{name}', *_sigmas(C)) for key, (name, C) in named.items()]
    ratio = np.sqrt(np.diag(found.R)) / np.maximum(np.sqrt(np.diag(cloud.covariance)), 1e-12)
    told = ", ".join(number(float(v), 2) for v in ratio) if len(cloud) > 1 else "–"
    noise = fixed(1e3 * cloud.noise, 0)
    bias = small(cloud.ends.mean(axis=0) - matched) if len(cloud) else "–"
    return table(("1 σ", "x mm", "y mm", "ψ °"), rows) + (
        f"<p>The cloud: ends of {len(cloud)} matches of this scan with noise of {noise} mm on each range. R of"
        f" (15) is {told} times as wide in x, y, ψ. Mean of the cloud from ξ*: {bias}. The"
        f" run fuses with ω {number(omega)}.</p>"
    )


def _sigmas(covariance: Float64s) -> tuple[str, str, str]:
    x, y, psi = np.sqrt(np.maximum(np.diag(covariance), 0.0)).tolist()
    return fixed(1e3 * x, 2), fixed(1e3 * y, 2), fixed(math.degrees(psi), 3)


def attitude_html(found: Passage) -> str:
    """E of eq. (1) at a pitch, and what it does to a turn through it."""
    aside, reach = fixed(math.degrees(ASIDE), 1), fixed(math.degrees(REACH), 0)
    heading_rate = number(math.degrees(float((found.E @ OMEGA)[2])))
    errors = {"by (1)": found.by_angles, "by a quaternion": found.by_quaternion}
    rows = [(name, fixed(math.degrees(error), 3)) for name, error in errors.items()]
    return (
        equation("(1)", "dΩ/dt = E<sub>Ω</sub> ω, E<sub>Ω</sub> for φ = 0 and this θ", matrix(found.E))
        + equation("dψ/dt", f"for {aside}°/s about z", f"{heading_rate}°/s")
        + table(("error at the end", "°"), rows)
        + f"<p>A turn at 90°/s, from {reach}° below this pitch to {reach}° above it, with {aside}°/s about the"
        " other two axes, by 100 samples a second. The filter turns a quaternion, which no pitch disturbs.</p>"
    )
