"""What is worth a look in a run: marks at its times, from its rows, its settings and its warnings."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from hectorscope.inputs import SourceReport
from hectorscope.run.series import TRACKING
from hectorscope.run.settings import Settings
from hectorscope.run.wording import SILENCES
from slam_core.localization.tracking import UNCERTAIN

Kind = Literal["bad_match", "lost", "recovered", "degenerate", "weak", "gap", "setting", "warning", "finding"]
TITLES: Mapping[Kind, str] = {
    "bad_match": "bad match",
    "lost": "pose lost",
    "recovered": "pose recovered",
    "degenerate": "degenerate direction",
    "weak": "weakly observable direction",
    "gap": "gap",
    "setting": "settings changed",
    "warning": "warning",
    "finding": "sensor check",
}

APART_S = 1.0  # what happens again within this time is one mark
GAP_S = 0.5  # between two scans, and
USUAL = 5.0  # this many times as long as usual: a gap
# Fewer beams, as a share, fix a direction badly; for so long, the map may get too long or too short along it.
WEAK, WEAK_S = 0.06, 2.0
UNOBSERVED = 1.0  # metres: the sigma of no match along a direction that it observes

Series = NDArray[np.void]


@dataclass(frozen=True, slots=True)
class Mark:
    """kind: in TITLES. scan: how many scans had given a result by then. text: a sentence without its full stop."""

    kind: Kind
    time_ns: int
    scan: int
    text: str


def marks(
    series: Series,
    start_ns: int,
    settings: Settings,
    report: SourceReport,
    warned: Mapping[str, tuple[int, int]] | None = None,
) -> tuple[Mark, ...]:
    """All of a run, by time. series: (n,) of SERIES_DTYPE. warned: as in a `Pipeline`. report: of the source."""
    found = [
        *_of_tracking(series, start_ns),
        *_unobserved(series, start_ns, settings),
        *_gaps(series, start_ns),
        *_changes(series, start_ns, settings),
        *_warnings(warned or {}),
        *(Mark("finding", start_ns, 0, finding.fact) for finding in report.findings),
        *(Mark("finding", start_ns, 0, f"repaired: {finding.fact}") for finding in report.repaired),
    ]
    return tuple(sorted(found, key=lambda mark: mark.time_ns))


def _of_tracking(series: Series, start_ns: int) -> Iterator[Mark]:
    """Stretches of rejected matches, and of an unknown pose with its recovery.

    Where one direction is not observable and has become uncertain the state is degraded, too: a mark of its own.
    """
    state, hits = series["tracking"], series["fit"]
    uncertain = np.hypot(series["fused_sigma_x"], series["fused_sigma_y"]) > UNCERTAIN
    rejected = (state == TRACKING.index("degraded")) & ~(uncertain & (series["weakest_sigma"] > UNOBSERVED))
    for first, last in _stretches(series, rejected):
        worst = hits[first:last][np.isfinite(hits[first:last])]
        fits = f": at worst {worst.min():.0%} of the points lie on walls" if len(worst) else ""
        count = int(np.count_nonzero(rejected[first:last]))
        yield _mark("bad_match", series, first, start_ns, f"{count} {_plural('match', count)} rejected{fits}")
    for first, last in _stretches(series, state == TRACKING.index("lost")):
        yield _mark("lost", series, first, start_ns, f"the pose is lost{_duration(series, first, last)}")
        back = last + np.flatnonzero(state[last:] != TRACKING.index("lost"))[:1]
        if len(back):
            yield _mark("recovered", series, int(back[0]), start_ns, "the pose is known again")


def _unobserved(series: Series, start_ns: int, settings: Settings) -> Iterator[Mark]:
    """Where too few beams fix one direction, by the threshold of that time, and where few do for long."""
    changes_ns = [start_ns, *(change.time_ns for change in settings.changes)]
    changes_s = np.array([(time_ns - start_ns) / 1e9 for time_ns in changes_ns])
    limits = np.array([settings.at(time_ns).matcher.degeneracy_threshold for time_ns in changes_ns])
    limit = limits[np.maximum(np.searchsorted(changes_s, series["time_s"] + 1e-9, side="right") - 1, 0)]
    shares = series["weakest_share"]
    for first, last in _stretches(series, shares < limit):
        share = np.nanmin(shares[first:last])
        text = f"one direction is not observable{_duration(series, first, last)}: {share:.2%} of the beams fix it"
        yield _mark("degenerate", series, first, start_ns, text)
    for first, last in _stretches(series, (limit <= shares) & (shares < WEAK)):
        if series["time_s"][last - 1] - series["time_s"][first] >= WEAK_S:
            share = np.nanmin(shares[first:last])
            text = f"few beams fix one direction{_duration(series, first, last)}: at worst {share:.1%} of them"
            held = np.nanmax(series["weakest_sigma"][first:last]) > UNOBSERVED
            text += ", and for a time it counted as unobservable" if held else ""
            yield _mark("weak", series, first, start_ns, text)


def _gaps(series: Series, start_ns: int) -> Iterator[Mark]:
    """Where no scan gave a result for long; the mark is at the first one behind it."""
    steps = np.diff(series["time_s"])
    if len(steps):
        longest = max(GAP_S, USUAL * float(np.median(steps)))
        for row in np.flatnonzero(steps > longest).tolist():
            yield _mark("gap", series, row + 1, start_ns, f"no scan was used for {steps[row]:.1f} s")


def _changes(series: Series, start_ns: int, settings: Settings) -> Iterator[Mark]:
    """Those of one time are one mark."""
    for time_ns, group in groupby(settings.changes, lambda change: change.time_ns):
        text = ", ".join(f"{change.name} = {change.value}" for change in group)
        yield Mark("setting", time_ns, int(np.searchsorted(series["time_s"], (time_ns - start_ns) / 1e9)), text)


def _warnings(warned: Mapping[str, tuple[int, int]]) -> Iterator[Mark]:
    for text, (time_ns, scans) in warned.items():
        yield Mark("gap" if text in SILENCES else "warning", time_ns, scans, text)


def _stretches(series: Series, where: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First row and the row behind the last one, of rows that are no more than APART_S apart."""
    rows = np.flatnonzero(where)
    if not len(rows):
        return []
    breaks = np.flatnonzero(np.diff(series["time_s"][rows]) > APART_S) + 1
    edges = [0, *breaks.tolist(), len(rows)]
    return [(int(rows[begin]), int(rows[end - 1]) + 1) for begin, end in pairwise(edges)]


def _mark(kind: Kind, series: Series, row: int, start_ns: int, text: str) -> Mark:
    return Mark(kind, start_ns + round(1e9 * float(series["time_s"][row])), row + 1, text)


def _duration(series: Series, first: int, last: int) -> str:
    seconds = series["time_s"][last - 1] - series["time_s"][first]
    return f" for {seconds:.1f} s" if seconds >= 0.05 else ""


def _plural(word: str, count: int) -> str:
    return word if count == 1 else f"{word}es"


def listed(found: Sequence[Mark], start_ns: int) -> list[tuple[float, str, str]]:
    """Seconds since the start, what it is, and the text, of each mark."""
    return [((mark.time_ns - start_ns) / 1e9, TITLES[mark.kind], mark.text) for mark in found]
