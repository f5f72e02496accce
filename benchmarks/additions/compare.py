"""Two configurations over the same seeds: medians, losses, and whether the difference shows."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from benchmarks.additions.cases import Case
from benchmarks.additions.catalogue import FULL
from benchmarks.additions.runs import Figures, Key, rows_of
from slam_core.measurements import Float64s

Effect = Literal["helps", "harms", "unclear", "none"]
RESAMPLED = 2000
SMALLEST = 1e-6  # metres: an error below this counts as this
SHOWN = 0.02  # a median ratio nearer to one is no effect, however certain
FEWEST = 5  # seeds: fewer may all lie on one side by chance
CERTAIN = 0.05  # of the sign test on lost runs


@dataclass(frozen=True, slots=True)
class Comparison:
    """An addition in a case. off, on: (n,) errors without and with it, one a seed.

    limit: an error above this counts as lost. same: seeds whose trajectories are the same bytes. graded: see Case.
    """

    off: Float64s
    on: Float64s
    limit: float
    same: int
    graded: bool = True

    @property
    def ratios(self) -> Float64s:
        """(n,) error without over error with."""
        return np.maximum(self.off, SMALLEST) / np.maximum(self.on, SMALLEST)

    @property
    def ratio(self) -> float:
        """The median ratio."""
        return float(np.median(self.ratios))

    @property
    def interval(self) -> tuple[float, float]:
        """95 % of the median ratios of resampled seeds."""
        drawn = np.random.default_rng(0).integers(0, len(self.ratios), (RESAMPLED, len(self.ratios)))
        low, high = np.quantile(np.median(self.ratios[drawn], axis=1), [0.025, 0.975])
        return float(low), float(high)

    @property
    def lost(self) -> tuple[int, int]:
        """How many seeds are lost without and with it."""
        return int(np.sum(~(self.off <= self.limit))), int(np.sum(~(self.on <= self.limit)))

    @property
    def worse_without(self) -> tuple[int, int]:
        """In how many seeds the error is larger without the addition, and in how many it is smaller."""
        return int(np.sum(self.off > self.on)), int(np.sum(self.off < self.on))

    @property
    def effect(self) -> Effect:
        """Whether the addition helps: by the interval of the median ratio, or by runs that are lost."""
        if self.same == len(self.off):
            return "none"
        saved = int(np.sum(~(self.off <= self.limit) & (self.on <= self.limit)))
        spoiled = int(np.sum((self.off <= self.limit) & ~(self.on <= self.limit)))
        if sign_test(saved, spoiled) < CERTAIN:
            return "helps" if saved > spoiled else "harms"
        low, high = self.interval
        if not self.graded or len(self.off) < FEWEST:
            return "unclear"
        if low > 1.0 and self.ratio > 1.0 + SHOWN:
            return "helps"
        if high < 1.0 and self.ratio < 1.0 - SHOWN:
            return "harms"
        return "unclear"


def sign_test(more: int, fewer: int) -> float:
    """Probability of so uneven a split of more + fewer fair coins, two-sided."""
    n = more + fewer
    tail = sum(math.comb(n, k) for k in range(min(more, fewer) + 1)) / 2**n
    return float(min(1.0, 2.0 * tail))


def compare(rows: Mapping[Key, Figures], case: Case, name: str, figure: str = "") -> Comparison | None:
    """An addition in a case by a figure, else by that of the case; None if there are fewer than three seeds."""
    with_it = {row["seed"]: row for row in rows_of(rows, case, FULL)}
    without = {row["seed"]: row for row in rows_of(rows, case, name)}
    figure = figure or case.figure
    graded = case.graded or figure != case.figure
    seeds = [seed for seed in with_it if seed in without and with_it[seed][figure] is not None]
    if len(seeds) < 3:
        return None
    same = sum(with_it[seed]["bytes"] == without[seed]["bytes"] for seed in seeds)
    off, on = (_column([found[seed] for seed in seeds], figure) for found in (without, with_it))
    limit = math.inf if figure in {"height", "roll"} else case.lost
    return Comparison(off, on, limit, same, graded)


def _column(rows: Sequence[Figures], figure: str) -> Float64s:
    return np.array([math.inf if row[figure] is None else row[figure] for row in rows], np.float64)
