"""Cases of the ensembles as tests run them."""

from collections.abc import Sequence
from typing import Any

from benchmarks import ensembles
from benchmarks.ensembles import Outcome
from hectorscope.inputs import Item
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings


def outcomes(case: str, variants: Sequence[int], settings: dict[str, Any]) -> list[Outcome]:
    """Of some variants of a case."""
    return ensembles.outcomes([ensembles.run(case, variant, settings) for variant in variants])


def failures(found: Sequence[Outcome]) -> int:
    """How many ended lost, wrote at a wrong place, or were there without a word."""
    return sum(each.lost or each.misplaced or each.silent for each in found)


def told(items: Sequence[Item]) -> tuple[Pipeline, set[str]]:
    """A run, and the codes of all faults that the user was told of meanwhile."""
    pipeline, faults = Pipeline(Settings(), items[0].stamp_ns), set[str]()
    for item in items:
        for measurement in pipeline.admit(item):
            pipeline.step(measurement)
            faults |= {each.code for each in pipeline.slam.diagnostics}
    return pipeline, faults


def items_of(case: str) -> list[Item]:
    """The first variant of a case, as it was."""
    return next(each for each in ensembles.cases() if each.name == case).load(1)
