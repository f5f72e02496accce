"""The laboratories: each gives what is shown, the first at once, better ones while nothing else is asked for."""

import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np

from hectorscope.page.theme import SENT
from hectorscope.panels import _xray_words as words
from hectorscope.panels._format import number
from hectorscope.panels._xray_places import compared
from hectorscope.panels._xray_shown import Dots, Heat, Mark, Shown, ellipse, line, outline, robot
from hectorscope.panels._xray_wanted import Wanted
from hectorscope.run.xray.attitude import passage
from hectorscope.run.xray.covariances import Cloud, Fusion, fusion
from hectorscope.run.xray.landscape import FOUND, SIDE, Around, Basin, Landscape, is_same, landscape
from hectorscope.run.xray.lens import lens
from hectorscope.run.xray.match_problem import MatchProblem
from slam_core.measurements import Float64s
from slam_core.reference.scan_matching import Iteration, transformed

SLICE_S = 0.05  # of work between two pictures
REACH = 1.5  # metres: length of the longest arrow at the robot
SIGMAS_SHARE = 0.5  # metres: radius of the largest ellipse of the covariances
KEPT = 32  # results of a scan that are kept for those who ask again
# Of the cost, from low to high: bright where it is low, and in order of lightness for every reader.
STOPS = np.array([[253, 231, 37], [94, 201, 98], [33, 145, 140], [59, 82, 139], [68, 1, 84]], np.float64)
RISE = 0.5  # height of the surface, of its reach to each side
OPAQUE = 225
FOUND_RGBA, FAILED_RGBA = (60, 212, 160, 190), (255, 118, 70, 120)


class OpenScan:
    """A match problem with what was worked out of it; belongs to one thread."""

    def __init__(self, problem: MatchProblem) -> None:
        self.problem = problem
        self._kept: dict[Any, Any] = {}

    def keep(self, key: Any, make: Callable[[], Any]) -> Any:
        """What was made for a key, or what is made now; the oldest gives way."""
        if key not in self._kept:
            while len(self._kept) >= KEPT:
                del self._kept[next(iter(self._kept))]
            self._kept[key] = make()
        return self._kept[key]

    def level(self, wanted: int) -> int:
        """A level that there is."""
        return min(wanted, len(self.problem.grids) - 1)

    def shown(self, wanted: Wanted, dragged: Float64s | None) -> Iterator[Shown]:
        """What to show, one after another. dragged: (3,) another start than the run's."""
        start = self.problem.start if dragged is None else dragged
        yield from LABS[wanted.lab](self, wanted, start)


def _steps(opened: OpenScan, wanted: Wanted, start: Float64s) -> Iterator[Shown]:
    problem, levels = opened.problem, len(opened.problem.grids)
    found: tuple[Iteration, ...] = opened.keep(("steps", *start.tolist()), lambda: problem.iterations(start))
    k = min(wanted.step, len(found) - 1)
    resolution = problem.grids[found[k].level].resolution
    text = words.steps_html(found, k, resolution, problem.config.matcher.sigma)
    text += words.left_out_html(problem.match)
    dots = opened.keep(("dots", k, *start.tolist()), lambda: beams(problem, found[k]))
    yield Shown(
        text, _step_marks(found, k), dots, handle=start, level=found[k].level, steps=len(found), levels=levels
    )


def beams(problem: MatchProblem, now: Iteration) -> Dots:
    """Every endpoint in the colour of its residual, with the gradient of M: two cells long for one of 1 a cell."""
    ends = transformed(problem.points.astype(np.float64), now.pose)
    resolution = problem.grids[now.level].resolution
    lines = np.stack([ends, ends + 2.0 * resolution**2 * now.gradients], axis=1)
    return Dots(now.level, ends, SENT.residual_colours(now.residuals.astype(np.float32)), lines)


def _step_marks(found: tuple[Iteration, ...], k: int) -> list[Mark]:
    now = found[k]
    at, level = now.pose[:2], now.level
    values, axes = np.linalg.eigh(now.H[:2, :2])
    marks = [
        line("path", level, np.array([each.pose[:2] for each in found[: k + 1]])),
        robot("now", level, now.pose),
    ]
    if values[1] > 0.0:
        for j in (0, 1):
            arm = REACH * np.sqrt(max(values[j], 0.0) / values[1]) * axes[:, j]
            marks.append(line("axis", level, np.array([at - arm, at + arm]), f"λ{'₁₂'[1 - j]}"))
    for kind, vector, name in (("force", now.b[:2], "b"), ("step", now.step[:2], "Δξ")):
        size = float(np.hypot(*vector))
        if size > 0.0 and k < len(found) - 1:  # at the end both are what rounding leaves
            marks.append(line(kind, level, np.array([at, at + 0.7 * REACH * vector / size]), name))
    return marks


def _landscape(opened: OpenScan, wanted: Wanted, start: Float64s) -> Iterator[Shown]:
    problem, level = opened.problem, opened.level(wanted.level)
    around = Around(wanted.plane, wanted.span, wanted.yaw if wanted.plane == "xy" else 0.0)
    found: Landscape = opened.keep((level, around), lambda: landscape(problem, level, around))
    basin: Basin | None = opened.keep(around, lambda: Basin(problem, around)) if wanted.show == "basin" else None
    rises = wanted.show == "surface"
    cost: Heat = opened.keep(("heat", level, around, rises), lambda: cost_heat(found, problem, rises=rises))
    while True:
        heat = basin_heat(basin, found, problem) if basin else cost
        yield _landscape_shown(opened, found, basin, heat, start)
        if basin is None or basin.whole:
            return
        ends = time.monotonic() + SLICE_S
        while time.monotonic() < ends and not basin.whole:
            basin.try_next()


def _landscape_shown(
    opened: OpenScan, found: Landscape, basin: Basin | None, heat: Heat, start: Float64s
) -> Shown:
    problem, level = opened.problem, found.level
    match = problem.end(start, trace=True)
    path = np.concatenate([start[None], match.trace[:, 1:]])
    same, matched = is_same(problem, match.pose), problem.matched
    text = words.ends_html(start, match.pose, matched, same)
    text += words.landscape_html(found, basin, matched, problem.grids[level].resolution)
    marks = [robot("matched", level, matched, "ξ*"), line("path", level, path)]
    marks += [robot("start", level, start), robot("same" if same else "elsewhere", level, match.pose)]
    return Shown(text, marks, heat=heat, handle=start, level=level, levels=len(problem.grids))


def cost_heat(found: Landscape, problem: MatchProblem, *, rises: bool) -> Heat:
    """Bright where the cost is low; the surface rises with the cost."""
    costs = found.costs - found.costs.min()
    share = costs / max(float(costs.max()), 1e-12)
    picture = np.empty((SIDE, SIDE, 4), np.uint8)
    at = np.sqrt(share) * (len(STOPS) - 1)
    for channel in range(3):
        picture[..., channel] = np.interp(at, np.arange(len(STOPS)), STOPS[:, channel])
    picture[..., 3] = OPAQUE
    return _heat(found, problem, picture, 0.05 + RISE * found.around.span * share if rises else None)


def basin_heat(basin: Basin, found: Landscape, problem: MatchProblem) -> Heat:
    """Starts that end at the matched pose, and those that do not."""
    picture = np.zeros((SIDE, SIDE, 4), np.uint8)
    outcome = basin.coarse()
    picture[:] = FAILED_RGBA
    picture[outcome == FOUND] = FOUND_RGBA
    return _heat(found, problem, picture, None)


def _heat(found: Landscape, problem: MatchProblem, picture: Any, heights: Float64s | None) -> Heat:
    side = 2.0 * found.around.span + found.around.step[0]  # a pose lies in the middle of its pixel
    return Heat(found.level, picture, problem.matched[:2], (side, side), heights)


def _lens(opened: OpenScan, wanted: Wanted, start: Float64s) -> Iterator[Shown]:
    levels = len(opened.problem.grids)
    if wanted.at is None:
        yield Shown("<p>Click a place of the map.</p>", levels=levels)
        return
    found = lens(opened.problem, opened.level(wanted.at[0]), *wanted.at[1:])
    size, place = found.resolution, np.array(found.place)
    first = (np.array(found.cell) + 0.5) * size
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    names = ("P00", "P10", "P11", "P01")
    values = (found.corners[0], found.corners[1], found.corners[3], found.corners[2])
    marks = [outline("patch", found.level, first + size * square)]
    for corner, name, value in zip(square, names, values, strict=True):
        cell = first + size * (corner - 0.5)
        marks.append(outline("cell", found.level, cell + size * square, f"{name} {value:.2f}"))
    steep = float(np.hypot(*found.gradient))
    if steep > 0.0:
        tip = place + min(steep * size, 1.0) * 2.0 * size * found.gradient / steep
        marks.append(line("step", found.level, np.array([place, tip]), "∇M"))
    yield Shown(words.lens_html(found), marks, levels=levels)


def _covariance(opened: OpenScan, wanted: Wanted, start: Float64s) -> Iterator[Shown]:
    if wanted.of == "places":
        for text in compared(opened.keep, wanted.noise, SLICE_S):
            yield Shown(text, levels=len(opened.problem.grids))
        return
    problem, levels = opened.problem, len(opened.problem.grids)
    cloud: Cloud = opened.keep(("cloud", wanted.noise), lambda: Cloud(problem, wanted.noise))
    run_omega = problem.config.fusion.omega
    fused: Fusion = opened.keep("fusion", lambda: fusion(problem, run_omega))
    found = fused.at(wanted.omega)
    named = {
        "prior": found.P, "match": found.R, "sampled": found.sampled, "fused": found.fused,
        "optimal": found.optimal, "kalman": found.kalman,
    }  # fmt: skip
    largest = max(float(np.linalg.eigvalsh(C[:2, :2])[-1]) for C in named.values())
    scale = SIGMAS_SHARE / max(largest, 1e-12) ** 0.5
    while True:
        marks = [ellipse(kind, 0, problem.matched, C, scale) for kind, C in named.items()]
        if len(cloud) > 1:
            mean = problem.matched[:2] + scale * (cloud.ends.mean(axis=0) - problem.matched)[:2]
            marks.append(ellipse("cloud", 0, mean, cloud.covariance, scale))
        note = f"<p>Ellipses of {number(scale)} σ around ξ*; the cloud is enlarged alike.</p>"
        text = words.covariance_html(found, cloud, problem.matched, run_omega) + note
        key = "dots of the cloud", wanted.noise, len(cloud), scale  # the same are not sent again
        dots: Dots = opened.keep(key, partial(_cloud_dots, problem, cloud, scale))
        yield Shown(text, marks, dots, level=0, levels=levels)
        if cloud.whole:
            return
        ends = time.monotonic() + SLICE_S
        while time.monotonic() < ends and not cloud.whole:
            cloud.try_next()


def _cloud_dots(problem: MatchProblem, cloud: Cloud, scale: float) -> Dots:
    """The ends, as far from the matched pose as the ellipses are large."""
    offsets = cloud.ends[:, :2] - problem.matched[:2]
    points = problem.matched[:2] + scale * offsets
    colours = np.tile(np.array(SENT.accent, np.uint8), (len(points), 1))
    return Dots(0, points, colours, np.empty((0, 2, 2)), size=0.02)


def _attitude(opened: OpenScan, wanted: Wanted, start: Float64s) -> Iterator[Shown]:
    yield Shown(words.attitude_html(passage(wanted.pitch)), levels=len(opened.problem.grids))


LABS: dict[str, Callable[[OpenScan, Wanted, Float64s], Iterator[Shown]]] = {
    "steps": _steps, "landscape": _landscape, "lens": _lens, "covariance": _covariance,
    "attitude": _attitude,
}  # fmt: skip
