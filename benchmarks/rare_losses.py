"""What keeps a laser alone from being lost: additions switched off one by one, where defaults are rarely lost.

    python -m benchmarks.rare_losses

Runs the variants of `benchmarks.ensembles`, and more of them where 30 leave it open what an addition is worth.
Writes docs/rare-losses.md after each batch.
"""

import math
from collections.abc import Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from statistics import median
from typing import Any

import numpy as np

from benchmarks.additions.catalogue import FULL, MEASURED
from benchmarks.additions.compare import CERTAIN, Comparison, sign_test
from benchmarks.ensembles import PROCESSES, Outcome, cases, outcomes, run
from benchmarks.tables import table
from hectorscope.run.warmup import load_everything
from tests.conftest import ROOT

BATCH, MOST = 30, 90  # variants
CASES = ("offices, 20 min, laser alone", "mit_csail, laser alone")
SWITCHED_OFF = (
    "tracking.unaided_mahalanobis_limit",
    "tracking.ignore_dynamic",
    "map.keyframe_max_delay",
    "tracking.min_overlap",
)

Ensemble = list[Outcome]


def judged(name: str, variant: int, settings: Mapping[str, Any]) -> Outcome:
    """One variant; the truth of both cases is known."""
    return outcomes([run(name, variant, settings)])[0]


def is_bad(outcome: Outcome) -> bool:
    """Whether it was lost, or wrote a scan at a wrong place."""
    return outcome.lost or outcome.misplaced


def rows(found: Mapping[str, Mapping[str, Ensemble]]) -> Iterator[list[str]]:
    """Of the table, by configuration."""
    for configuration, ensembles in found.items():
        yield [configuration if configuration == FULL else f"without `{configuration}`", *_cells(ensembles, found)]


def _cells(ensembles: Mapping[str, Ensemble], found: Mapping[str, Mapping[str, Ensemble]]) -> Iterator[str]:
    for name, ensemble in ensembles.items():
        error, bad = f"{median(each.error for each in ensemble):.3f} m", f"{sum(map(is_bad, ensemble))} of"
        if ensembles is found[FULL]:
            yield from (error, "-", f"{bad} {len(ensemble)}", "-")
            continue
        compared = _compared(ensemble, found[FULL][name])
        low, high = compared.interval
        ratio, split = f"{compared.ratio:.2f} ({low:.2f} to {high:.2f})", _split(ensemble, found[FULL][name])
        yield from (error, ratio, f"{bad} {len(ensemble)}", f"{split:.2g}")


def is_certain(ensembles: Mapping[str, Ensemble], defaults: Mapping[str, Ensemble]) -> bool:
    """Whether the difference that an addition makes shows in a case: in the errors, or in how many are bad."""
    pairs = [(ensemble, defaults[name]) for name, ensemble in ensembles.items()]
    return any(_split(*pair) < CERTAIN or _compared(*pair).effect in {"helps", "harms"} for pair in pairs)


def _compared(off: Ensemble, on: Ensemble) -> Comparison:
    """The errors; `on` may have more variants."""
    errors, errors_on = (np.array([each.error for each in ensemble]) for ensemble in (off, on[: len(off)]))
    return Comparison(errors, errors_on, math.inf, 0)


def _split(off: Ensemble, on: Ensemble) -> float:
    """The sign test on the bad ones."""
    pairs = [(is_bad(a), is_bad(b)) for a, b in zip(off, on, strict=False)]
    return sign_test(pairs.count((True, False)), pairs.count((False, True)))


def document(found: Mapping[str, Mapping[str, Ensemble]]) -> str:
    """docs/rare-losses.md."""
    head = ["configuration"]
    for name in found[FULL]:
        head += [f"{name}: error, median", "ratio", "lost or written wrong", "sign test"]
    return f"{INTRODUCTION}\n{table(head, rows(found))}"


INTRODUCTION = """# Rare losses

Written by `python -m benchmarks.rare_losses`; do not edit.

A laser alone is lost so rarely that twenty seeds do not show what keeps it. Here each addition that is meant to
is switched off alone, in more variants of the two longest cases of [ensembles.md](ensembles.md), which says what
*lost* and *written wrong* mean: 30 variants, and 30 more as long as the difference is not certain (5 %), at most
90. *Ratio*: median over the variants of the error without the addition over the
error with it, with the 95 % interval of it (bootstrap). *Sign test*: how probable so uneven a split of the bad
variants is, if the addition makes no difference.
"""


def main() -> None:
    """Run them, and write the document."""
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
