"""docs/beyond-the-paper.md from the stored runs."""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping

import numpy as np

from benchmarks.additions.cases import RANGE_NOISE, SECONDS, SEEDS, VARIANTS, Case, cases
from benchmarks.additions.catalogue import FULL, LAST_POSE, MEASURED, PAPER, scope
from benchmarks.additions.compare import FEWEST, SHOWN, Comparison, compare
from benchmarks.additions.runs import DECIDED, GHOSTLY, PROBED, SMALL, Figures, Key, rows_of
from benchmarks.additions.words import DIFFERS, HEAD
from benchmarks.tables import table
from slam_core.config import Addition, Leaves, SlamConfig

Rows = Mapping[Key, Figures]
UNITS = {"height": "m", "roll": "°", "off_map": "%"}
"""Of the figures that are no planar error, which is in centimetres."""
QUICKER = (
    "matcher.converged_step",
    "matcher.surfel_weight",
    "matcher.prior_restart_sigmas",
)


class Found:
    """What was found of an addition: a comparison for each case and figure."""

    def __init__(self, rows: Rows, every: list[Case], addition: Addition) -> None:
        self.addition = addition
        extra = scope(addition.name).figure
        pairs = [(case, figure) for case in every for figure in dict.fromkeys((case.figure, extra or case.figure))]
        compared = [(case, figure, compare(rows, case, addition.name, figure)) for case, figure in pairs]
        self.all = [(case, figure, found) for case, figure, found in compared if found is not None]

    def of(self, *effects: str) -> list[tuple[Case, str, Comparison]]:
        """Those with one of these effects."""
        return [each for each in self.all if each[2].effect in effects]


def document(rows: Rows) -> str:
    """The whole file."""
    every = cases()
    found = [Found(rows, every, addition) for addition in MEASURED]
    parts = (
        HEAD,
        _method(rows, every),
        _summary(found),
        DIFFERS,
        _paper(rows, every),
        _removed(),
        _ghosts(rows, every),
        _speed(rows, every),
        "## Each addition\n",
        *map(_section, found),
    )
    return "\n".join(parts).rstrip() + "\n"


def _method(rows: Rows, every: list[Case]) -> str:
    seeds = [len(list(rows_of(rows, case, FULL))) for case in every if case.family != "recordings"]
    undecided = "" if max(seeds) >= FEWEST else "**No drive has that many yet: the summary decides nothing.**"
    return f"""## How it is measured

{len(every)} cases: drives through simulated rooms (six rates and motions), the paper's three scenes, a hall with
people, one with glass, a bare corridor, drives with faults and outages, and recordings. Simulated drives differ by
their seed: the noise, the angle to the walls at the start, and who walks where ({min(seeds)} to {max(seeds)} of
{SEEDS} seeds were run). Most of them take {SECONDS:g} s. A recording is run as it is, and in up to {VARIANTS - 1}
variants with {1e3 * RANGE_NOISE:g} mm of noise on every range and without some of its first scans.

Every configuration runs on the same measurements, so seeds are compared in pairs. *Ratio* is the median over the
seeds of the error without the addition over the error with it, with the 95 % interval of it (bootstrap).
The addition *helps* in a case if the interval lies above 1 and the ratio above {1 + SHOWN:g}, or if
significantly fewer seeds are lost with it (sign test, 5 %); it *harms* in the opposite case. With fewer than
{FEWEST} seeds a case stays *unclear*, unless every byte is the same: so few may all lie on one side by chance.
{undecided}

The error is the raw planar error (rms, first pose on first pose); of recordings with truth the aligned one;
after a fault the mean of the last two seconds. Some additions are compared by height or roll besides. A run is
lost above 1 m (10 m in the corridor). A recording without a truth is only lost or not: it has to end within 1 m of
its start, or to meet its first map again.

Not every addition is run on every seed. One that changes not one byte of the first {PROBED} trajectories of a case
is not run there again, as long as what it reacts to does not occur. Neither is one that changes the first
{PROBED} errors by less than {100 * SMALL:g} %, or the first {DECIDED} all by more than that and in the same
direction. The column *n* gives the seeds.
"""


def _summary(found: Iterable[Found]) -> str:
    lines = []
    for each in found:
        effects = ("helps", "harms", "unclear", "none")
        counts = [str(len(each.of(effect))) if each.all else "-" for effect in effects]
        name = f"[`{each.addition.name}`](#{_anchor(each.addition)})"
        lines.append([name, each.addition.title, *counts, _best(each)])
    head = ("setting", "what it does", "helps", "harms", "unclear", "same", "where it helps most")
    return f"""## Summary

The number of cases in which an addition helps, harms, makes no clear difference, or leaves every byte the same.
A dash: it was not run.

{table(head, lines)}"""


def _removed() -> str:
    return """## Removed again

These were defaults once. Over 20 seeds of each case that they could change, none of them helped or harmed. So
they were removed with their settings: fewer beams for the coarser levels (`matcher.coarse_beams`; a match took
1.03 times as long without it), the gate of the wheels (`motion.odometry_gate`), and the test of the size of the
magnetic field (`aiding.compass_tolerance`). Slip and the gate of the aiding sensors do what the last two did.
Without an IMU, `motion.observed_only` widened at a match only the covariance of the pose and of what is
correlated with it. It made no certain difference to 30 drives through the offices and 30 variants of mit_csail
either: none was bad, and the ratio was 1.05 (0.96 to 1.17) and 1.01 (0.93 to 1.08).

## Rare losses

A laser alone is lost so rarely that 20 seeds show nothing of what keeps it. Hence `matcher.back_face_share`,
`map.keyframe_max_delay`, `tracking.unaided_mahalanobis_limit`, `tracking.min_overlap` and
`tracking.ignore_dynamic` are measured by more and longer drives in [rare-losses.md](rare-losses.md).
"""


def _best(found: Found) -> str:
    helped = found.of("helps")
    if not helped:
        return "-"
    case, figure, best = max(helped, key=lambda each: (each[2].lost[0] - each[2].lost[1], each[2].ratio))
    without, with_it = best.lost
    lost = f", lost {without} against {with_it} of {len(best.off)}" if without != with_it else ""
    return f"{_name(case, figure)}: {_times(best.ratio)} times the error without it{lost}"


def _paper(rows: Rows, every: list[Case]) -> str:
    lines = []
    for case in filter(lambda case: case.graded, every):
        columns = [[row[case.figure] for row in rows_of(rows, case, name)] for name in (LAST_POSE, PAPER, FULL)]
        if columns[2]:
            lines.append([_name(case, case.figure), *(_errors(each, case.lost, case.figure) for each in columns)])
    head = ("case", "paper, started at the last pose", "paper", "defaults")
    return f"""## The paper and the defaults

Errors in centimetres unless another unit is given, median / worst, and how many seeds are lost.

{table(head, lines)}"""


def _ghosts(rows: Rows, every: list[Case]) -> str:
    case = next(case for case in every if case.ghosts)
    lines = []
    for name in GHOSTLY:
        label = name if name in {FULL, PAPER} else f"without `{name}`"
        watched = [row for row in rows_of(rows, case, name) if "ghosts" in row]
        if watched:
            cells, longest = ([row[key] for row in watched] for key in ("ghosts", "longest"))
            times = f"{np.median(longest):.1f} / {max(longest):.1f} s"
            lines.append([label, str(len(watched)), f"{np.median(cells):.0f} / {max(cells)}", times])
    head = ("configuration", "n", "cells", "longest in sight")
    return f"""## Artefacts of moving objects

The hall with people: cells that were occupied although nobody had been there for five seconds in which beams could
pass, and the time in sight until the last such cell was free; median / worst over the seeds.

{table(head, lines)}"""


def _speed(rows: Rows, every: list[Case]) -> str:
    lines = []
    for name in QUICKER:
        cells = [f"`{name}`"]
        for figure in ("match_us", "iterations"):
            compared = (compare(rows, case, name, figure) for case in every if case.family in {"rooms", "scenes"})
            ratios = [found.ratio for found in compared if found is not None]
            cells.append(f"{np.median(ratios):.2f} ({min(ratios):.2f} to {max(ratios):.2f})" if ratios else "-")
        lines.append(cells)
    head = ("without", "time of a match", "iterations a scan")
    return f"""## Speed

Without the addition over with it, in the rooms and scenes with an IMU: the median of the cases, and their range.

{table(head, lines)}"""


def _section(found: Found) -> str:
    addition, leaf = found.addition, Leaves(SlamConfig())
    values = ", ".join(
        f"`{name}` is {_word(leaf[name].value)}, off with {_word(value)}"
        for name, value in addition.values.items()
    )
    text = f"### `{addition.name}`\n\n{addition.title} {values}.\n\n"
    if shown := found.of("helps", "harms"):
        head = ("case", "", "n", "with", "without", "ratio", "seeds worse / better without")
        text += table(head, (_row(*each) for each in shown)) + "\n"
    for effect, words in (("unclear", "No clear difference"), ("none", "Every byte the same")):
        if families := Counter(case.family for case, *_ in found.of(effect)):
            named = (f"{family} ({count})" for family, count in families.items())
            text += f"{words}, number of cases: {', '.join(named)}.\n\n"
    return text


def _row(case: Case, figure: str, found: Comparison) -> Iterator[str]:
    yield _name(case, figure)
    yield found.effect
    yield str(len(found.off))
    yield _errors(found.on.tolist(), found.limit, figure)
    yield _errors(found.off.tolist(), found.limit, figure)
    low, high = found.interval
    yield f"{_times(found.ratio)} ({_times(low)} to {_times(high)})"
    yield "{} / {}".format(*found.worse_without)


def _errors(values: list[float | None], limit: float, figure: str) -> str:
    """Median / worst, and how many are lost."""
    if not values:
        return "-"
    found = np.array([np.inf if value is None else value for value in values], np.float64)
    unit = UNITS.get(figure, "cm")
    shown = [_short(value * (1.0 if unit in {"m", "°"} else 100.0)) for value in (np.median(found), found.max())]
    lost = int(np.sum(~(found <= limit))) if figure not in {"height", "roll"} else 0
    text = " / ".join(shown) + (f" {unit}" if unit != "cm" else "")
    return f"{text}, lost {lost} of {len(found)}" if lost else text


def _short(value: float) -> str:
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}"


_times = _short


def _name(case: Case, figure: str) -> str:
    besides = f" ({figure})" if figure in {"height", "roll"} else ""
    return f"{case.family}: {case.name}{besides}"


def _anchor(addition: Addition) -> str:
    return addition.name.replace(".", "")


def _word(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
