"""What keeps a laser alone from being lost: additions switched off one by one, where defaults are rarely lost.

    python -m benchmarks.rare_losses

Runs the variants of `benchmarks.ensembles`, and more of them where 30 leave it open what an addition is worth.
Writes docs/rare-losses.md after each batch.
"""

import argparse
import math
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from statistics import mean, median
from typing import Any

import numpy as np

from benchmarks.additions.catalogue import FULL, MEASURED
from benchmarks.additions.compare import CERTAIN, Comparison, sign_test
from benchmarks.ensemble_cases import cases
from benchmarks.ensembles import PROCESSES, Outcome, outcomes, run
from benchmarks.tables import table
from hectorscope.run.warmup import load_everything
from tests.conftest import ROOT

BATCH, MOST = 30, 60  # variants
CASES = ("offices, 10 min, 1 degree, laser alone", "people, laser alone, 8 m", "mit_csail, laser alone")
SWITCHED_OFF = (
    "matcher.back_face_share",
    "tracking.unaided_mahalanobis_limit",
    "tracking.ignore_dynamic",
    "tracking.keep_speed",
    "map.keyframe_max_delay",
    "tracking.min_overlap",
)

Ensemble = list[Outcome]


def judged(name: str, variant: int, settings: Mapping[str, Any]) -> Outcome:
    """One variant; the truth of each case is known."""
    return outcomes([run(name, variant, settings)])[0]


def is_bad(outcome: Outcome) -> bool:
    """Whether it was lost, or wrote a scan at a wrong place."""
    return outcome.lost or outcome.misplaced


def rows(found: Mapping[str, Mapping[str, Ensemble]], case: str) -> Iterator[list[str]]:
    """Of the table of a case, by configuration."""
    defaults = found[FULL][case]
    for configuration, ensembles in found.items():
        ensemble = ensembles[case]
        compared = _compared(ensemble, defaults)
        low, high = compared.interval
        cells = [
            f"{median(each.error for each in ensemble):.3f} m",
            f"{compared.ratio:.2f} ({low:.2f} to {high:.2f})",
            f"{sum(map(is_bad, ensemble))} of {len(ensemble)}",
            f"{_split(ensemble, defaults, is_bad):.2g}",
            f"{mean(each.slides for each in ensemble):.0f}",
            f"{_split(ensemble, defaults, _slides):.2g}",
        ]
        if configuration == FULL:  # has nothing to be compared with
            yield [configuration, *(cell if k % 2 == 0 else "-" for k, cell in enumerate(cells))]
        else:
            yield [f"without `{configuration}`", *cells]


def is_certain(ensembles: Mapping[str, Ensemble], defaults: Mapping[str, Ensemble]) -> bool:
    """Whether the difference that an addition makes shows in a case: in errors, slides, or how many are bad."""
    pairs = [(ensemble, defaults[name]) for name, ensemble in ensembles.items()]
    split = any(_split(*pair, value) < CERTAIN for pair in pairs for value in (is_bad, _slides))
    return split or any(_compared(*pair).effect in {"helps", "harms"} for pair in pairs)


def _compared(off: Ensemble, on: Ensemble) -> Comparison:
    """The errors; `on` may have more variants."""
    errors, errors_on = (np.array([each.error for each in ensemble]) for ensemble in (off, on[: len(off)]))
    return Comparison(errors, errors_on, math.inf, 0)


def _split(off: Ensemble, on: Ensemble, value: Callable[[Outcome], int]) -> float:
    """The sign test on the variants in which something differs."""
    pairs = [(value(a), value(b)) for a, b in zip(off, on, strict=False)]
    return sign_test(sum(a > b for a, b in pairs), sum(a < b for a, b in pairs))


def _slides(outcome: Outcome) -> int:
    return outcome.slides


def document(found: Mapping[str, Mapping[str, Ensemble]]) -> str:
    """docs/rare-losses.md."""
    tables = (f"\n## Case: {name}\n\n{table(HEAD, rows(found, name))}" for name in found[FULL])
    return "".join((INTRODUCTION, *tables))


HEAD = ("configuration", "error, median", "ratio", "lost or written wrong", "sign test", "slides", "sign test")
INTRODUCTION = """# Rare losses

Written by `python -m benchmarks.rare_losses`; do not edit.

A laser alone is lost so rarely that twenty seeds do not show what keeps it. Here each addition that is meant to
is switched off alone, in more variants of two hard cases and a real drive of [ensembles.md](ensembles.md), which
says what *lost* and *written wrong* mean: 30 variants, and 30 more if no difference is certain (5 %).

*Ratio*: median over the variants of the error without the addition over the error with it, with the 95 % interval
of it (bootstrap). *Slides*: scans of a run from which on the motion over two seconds is wrong by more than 0.1 m,
mean. *Sign test*: how probable so uneven a split of the bad variants is, or of those with more slides and those
with fewer, if the addition makes no difference. Ratio and tests compare the same variants.
"""


def main() -> None:
    """Run them, and write the document."""
    argparse.ArgumentParser(description=__doc__.partition("\n")[0]).parse_args()
    values = {addition.name: addition.values for addition in MEASURED}
    found: dict[str, dict[str, Ensemble]] = {}
    with ProcessPoolExecutor(PROCESSES, initializer=load_everything) as pool:

        def extend(configuration: str, count: int) -> None:
            """Run its variants up to so many."""
            settings = values.get(configuration, {})
            for name, ensemble in found[configuration].items():
                variants = range(len(ensemble) + 1, count + 1)
                futures = [pool.submit(judged, name, k, settings) for k in variants]
                ensemble += [each.result() for each in futures]
                bad = [k for k, each in enumerate(ensemble, start=1) if is_bad(each)]
                print(f"{configuration}: {name}: bad {bad} of {len(ensemble)}", flush=True)

        for configuration in (FULL, *SWITCHED_OFF):
            found[configuration] = {case.name: [] for case in cases() if case.name in CASES}
            for count in range(BATCH, MOST + 1, BATCH):
                extend(configuration, count)
                extend(FULL, count)
                (ROOT / "docs" / "rare-losses.md").write_text(document(found), encoding="utf-8")
                if configuration == FULL or is_certain(found[configuration], found[FULL]):
                    break


if __name__ == "__main__":
    main()
