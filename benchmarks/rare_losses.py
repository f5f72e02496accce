"""What keeps a laser alone from being lost: additions switched off one by one, where defaults are rarely lost.

    python -m benchmarks.rare_losses [--variants 30]

Runs the variants of `benchmarks.ensembles` and writes docs/rare-losses.md after each configuration.
"""

import argparse
import math
from collections.abc import Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from statistics import median
from typing import Any

import numpy as np

from benchmarks.additions.catalogue import FULL, MEASURED
from benchmarks.additions.compare import Comparison, sign_test
from benchmarks.ensembles import PROCESSES, Outcome, cases, outcomes, run
from benchmarks.tables import table
from hectorscope.run.warmup import load_everything
from tests.conftest import ROOT

VARIANTS = 30
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
        defaults = found[FULL][name]
        off, on = (list(map(is_bad, each)) for each in (ensemble, defaults))
        saved, spoiled = (sum(a and not b for a, b in zip(*pair, strict=True)) for pair in ((off, on), (on, off)))
        error, bad = f"{median(each.error for each in ensemble):.3f} m", f"{sum(off)} of {len(off)}"
        if ensembles is found[FULL]:
            yield from (error, "-", bad, "-")
        else:
            yield from (error, _ratio(ensemble, defaults), bad, f"{sign_test(saved, spoiled):.2g}")


def _ratio(off: Ensemble, on: Ensemble) -> str:
    errors, errors_on = (np.array([each.error for each in ensemble]) for ensemble in (off, on))
    compared = Comparison(errors, errors_on, math.inf, 0)
    low, high = compared.interval
    return f"{compared.ratio:.2f} ({low:.2f} to {high:.2f})"


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
*lost* and *written wrong* mean. *Ratio*: median over the variants of the error without the addition over the
error with it, with the 95 % interval of it (bootstrap). *Sign test*: how probable so uneven a split of the bad
variants is, if the addition makes no difference.
"""


def main() -> None:
    """Run them, and write the document."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--variants", type=int, default=VARIANTS)
    variants = range(1, parser.parse_args().variants + 1)
    values = {addition.name: addition.values for addition in MEASURED}
    present = [case.name for case in cases() if case.name in CASES]
    found: dict[str, dict[str, Ensemble]] = {}
    with ProcessPoolExecutor(PROCESSES, initializer=load_everything) as pool:
        for configuration in (FULL, *SWITCHED_OFF):
            settings = values.get(configuration, {})
            found[configuration] = ensembles = {}
            for name in present:
                futures = [pool.submit(judged, name, k, settings) for k in variants]
                ensembles[name] = [each.result() for each in futures]
                bad = [k for k, each in zip(variants, ensembles[name], strict=True) if is_bad(each)]
                print(f"{configuration}: {name}: bad {bad}", flush=True)
            (ROOT / "docs" / "rare-losses.md").write_text(document(found), encoding="utf-8")


if __name__ == "__main__":
    main()
