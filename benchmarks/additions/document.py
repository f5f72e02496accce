"""docs/beyond-the-paper.md from the stored runs."""

from collections.abc import Iterator, Mapping

import numpy as np

from benchmarks.additions.cases import RANGE_NOISE, SECONDS, SEEDS, VARIANTS, Case, cases
from benchmarks.additions.catalogue import FULL, LAST_POSE, MEASURED, PAPER
from benchmarks.additions.compare import SHOWN, Comparison, compare
from benchmarks.additions.runs import PROBED, Figures, Key, rows_of
from benchmarks.tables import table
from slam_core.config import Addition, Leaves, SlamConfig

Rows = Mapping[Key, Figures]
Found = list[tuple[Case, Comparison]]

HEAD = """# Beyond the paper

Written by `python -m benchmarks.additions`; do not edit.

The defaults add to the method of the paper. `SlamConfig.paper()`, `--preset paper` and the choice *Preset* on the
page switch all of these additions off. This document lists them, and what each is worth when it alone is switched
off.
"""

DIFFERS = """## Where `SlamConfig.paper()` differs from the paper

- The [slips in print](errata.md) are corrected: eqs. (13), (17), (18) and (20).
- The attitude is a quaternion, and its error a small rotation. Eq. (1) with Euler angles is singular at 90 degrees
  of pitch.
- The paper needs an IMU. Without one, a planar filter of nearly constant velocity takes the place of the EKF. It
  gives the start estimate, which is the alternative of section V-B (the estimated velocities are integrated).
  `--matcher.start-estimate last_pose` starts at the last pose instead, as the reference implementation does.
- The paper leaves the map update, the number of iterations and the thresholds open. They are those of the reference
  implementation: log-odds with one change a cell a scan, 4 iterations a coarse level and 6 on the finest, an update
  after 0.4 m or 0.06 rad, three levels from 0.05 m.
- The roll and pitch at the start come from the mean acceleration of the first half second.
- The map grows, up to `map.limit`. The paper does not say what happens at the edge.
- Measurements act at their own times (a late match is fused where it belongs, and later samples are predicted
  again). The paper fuses "as soon as they arrive".
- Satellites, compass, ground distance and a foreign attitude are fused as this project does it. "The fusion of other
  sensors than the scan matching pose is not within the scope of this paper."
- Broken input is rejected: values that are no numbers, clipped gyroscopes, frozen sensors, clocks that were set.

These have no switch.
"""


def document(rows: Rows) -> str:
    """The whole file."""
    every = cases()
    found = {addition.name: _found(rows, every, addition) for addition in MEASURED}
    parts = [
        HEAD,
        _method(rows, every),
        _summary(found),
        DIFFERS,
        _paper(rows, every),
        _ghosts(rows, every),
        _speed(rows, every),
        "## Each addition\n",
        *(_section(addition, found[addition.name]) for addition in MEASURED),
    ]
    return "\n".join(parts)


def _found(rows: Rows, every: list[Case], addition: Addition) -> Found:
    compared = ((case, compare(rows, case, addition.name)) for case in every)
    return [(case, comparison) for case, comparison in compared if comparison is not None]


def _method(rows: Rows, every: list[Case]) -> str:
    seeds = sorted({len(list(rows_of(rows, case, FULL))) for case in every if case.family != "recordings"})
    return f"""## How it is measured

{len(every)} cases: simulated drives through rooms (six rates and motions), the paper's three scenes, a hall with people, one with
glass, a bare corridor, drives with faults and outages, and recordings. Simulated drives differ by their seed: the
noise, the angle to the walls at the start, and who walks where ({seeds[0]} to {seeds[-1]} of {SEEDS} seeds here). A recording
is run as it is, and in up to {VARIANTS - 1} variants with {1e3 * RANGE_NOISE:g} mm of noise on every range and without its first scans. Most
drives take {SECONDS:g} s.

Every configuration runs on the same measurements, so the seeds are compared in pairs. *Ratio* is the median over the
seeds of the error without the addition over the error with it, with the 95 % interval of the median (bootstrap):
above 1 the addition helps. *Worse / better* counts the seeds. An addition *helps* in a case if that interval lies
above 1 and the ratio above {1 + SHOWN:g}, or if significantly fewer seeds are lost with it (sign test, 5 %); *harms* is the
opposite. The error is the raw planar error (rms, first pose on first pose); for recordings with a truth the aligned
one; after a fault the mean of the last two seconds; for wild heights the height. A run is lost above 1 m (10 m in
the corridor); a recording without a truth counts as lost if it does not end within 1 m of its start, or does not
meet its first map again. An addition that changes not one byte of the first {PROBED} trajectories of a case is not run there on the other seeds.
"""


def _summary(found: Mapping[str, Found]) -> str:
    lines = []
    for addition in MEASURED:
        effects = [comparison.effect for _, comparison in found[addition.name]]
        counts = [str(effects.count(effect)) for effect in ("helps", "harms", "unclear", "none")]
        lines.append(
            [
                f"[{_settings(addition)}](#{_anchor(addition)})",
                addition.title,
                *counts,
                _best(found[addition.name]),
            ]
        )
    head = ("setting", "what it does", "helps", "harms", "unclear", "no change", "where it helps most")
    return f"""## Summary

Cases in which an addition helps, harms, makes no clear difference, or changes nothing at all.

{table(head, lines)}"""


def _best(found: Found) -> str:
    helped = [(case, c) for case, c in found if c.effect == "helps"]
    if not helped:
        return "-"
    case, c = max(helped, key=lambda pair: (pair[1].lost[0] - pair[1].lost[1], pair[1].ratio))
    lost = f", lost {c.lost[0]} against {c.lost[1]} of {len(c.off)}" if c.lost[0] != c.lost[1] else ""
    return f"{_name(case)}: {_times(c.ratio)}{lost}"


def _paper(rows: Rows, every: list[Case]) -> str:
    lines = []
    for case in every:
        if case.graded:
            columns = [
                [row[case.figure] for row in rows_of(rows, case, name)] for name in (LAST_POSE, PAPER, FULL)
            ]
            if columns[2]:
                lines.append([_name(case), *(_errors(values, case.lost) for values in columns)])
    head = ("case", "paper, start at the last pose", "paper", "defaults")
    return f"""## The paper and the defaults

Errors in centimetres, median / worst, and how many seeds are lost.

{table(head, lines)}"""


def _ghosts(rows: Rows, every: list[Case]) -> str:
    case = next(case for case in every if case.ghosts)
    lines = []
    for name, label in (
        (FULL, "defaults"),
        ("map.clear_interval", "without `map.clear_interval`"),
        (PAPER, "paper"),
    ):
        watched = [row for row in rows_of(rows, case, name) if "ghosts" in row]
        if watched:
            cells, longest = ([row[key] for row in watched] for key in ("ghosts", "longest"))
            lines.append(
                [
                    label,
                    f"{np.median(cells):.0f} / {max(cells)}",
                    f"{np.median(longest):.1f} / {max(longest):.1f} s",
                ]
            )
    head = ("configuration", "cells", "longest in sight")
    return f"""## Artefacts of moving objects

The hall with people. Cells that were occupied although nobody had been there for five seconds in which beams could
pass, and the time in sight until the last such cell was free; median / worst over the seeds.

{table(head, lines)}"""


def _speed(rows: Rows, every: list[Case]) -> str:
    lines = []
    for name in (
        "matcher.converged_step",
        "matcher.coarse_beams",
        "matcher.surfel_weight",
        "matcher.prior_restart_sigmas",
    ):
        for figure, words in (("match_us", "time of a match"), ("iterations", "iterations a scan")):
            ratios = [
                comparison.ratio
                for case in every
                if case.family in {"rooms", "scenes"} and (comparison := compare(rows, case, name, figure))
            ]
            if ratios:
                lines.append(
                    [f"`{name}`", words, f"{np.median(ratios):.2f}", f"{min(ratios):.2f} to {max(ratios):.2f}"]
                )
    head = ("without", "figure", "ratio, median over the cases", "cases from, to")
    return f"""## Speed

Without the addition over with it, in the rooms and scenes with an IMU.

{table(head, lines)}"""


def _section(addition: Addition, found: Found) -> str:
    leaf = Leaves(SlamConfig())
    values = ", ".join(
        f"`{name}` {_word(leaf[name].value)} (off: {_word(value)})" for name, value in addition.values.items()
    )
    shown = [(case, c) for case, c in found if c.effect in {"helps", "harms"}]
    text = f"### {_settings(addition)}\n\n{addition.title} {values}.\n\n"
    if shown:
        head = ("case", "", "with", "without", "ratio", "worse / better without")
        text += table(head, (_row(case, c) for case, c in shown)) + "\n"
    for effect, words in (("unclear", "No clear difference"), ("none", "Not one byte differs")):
        names = [_name(case) for case, c in found if c.effect == effect]
        if names:
            text += f"{words}: {', '.join(names)}.\n\n"
    return text


def _row(case: Case, c: Comparison) -> Iterator[str]:
    yield _name(case)
    yield c.effect
    yield _errors(c.on.tolist(), c.limit, case.figure)
    yield _errors(c.off.tolist(), c.limit, case.figure)
    low, high = c.interval
    yield f"{_times(c.ratio)} ({_times(low)} to {_times(high)})"
    yield "{} / {}".format(*c.worse_without)


def _errors(values: list[float | None], limit: float, figure: str = "raw") -> str:
    """Centimetres (or %), median / worst, and how many are lost."""
    if not values:
        return "-"
    found = np.array([np.inf if value is None else value for value in values], np.float64)
    lost = int(np.sum(~(found <= limit)))
    unit = " %" if figure == "off_map" else ""
    text = f"{_short(100 * float(np.median(found)))} / {_short(100 * float(found.max()))}{unit}"
    return f"{text}, lost {lost} of {len(found)}" if lost else text


def _short(value: float) -> str:
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}"


def _times(ratio: float) -> str:
    return f"{ratio:.0f}" if ratio >= 100 else f"{ratio:.3g}"


def _name(case: Case) -> str:
    return f"{case.family}: {case.name}"


def _settings(addition: Addition) -> str:
    return ", ".join(f"`{name}`" for name in addition.values)


def _anchor(addition: Addition) -> str:
    return addition.name.replace(".", "")


def _word(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
