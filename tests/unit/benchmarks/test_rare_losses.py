"""The table of rare losses: each addition against the defaults, variant by variant."""

from benchmarks.additions.catalogue import FULL, MEASURED
from benchmarks.ensembles import Outcome
from benchmarks.rare_losses import SWITCHED_OFF, document

GOOD = Outcome(0.02, 0.01, lost=False, misplaced=False, silent=False)
LOST = Outcome(4.0, 0.5, lost=True, misplaced=False, silent=False)
MISPLACED = Outcome(0.3, 0.1, lost=False, misplaced=True, silent=True)


def test_a_row_counts_the_variants_and_how_uneven_they_are_split() -> None:
    """Six of eight that are bad without the addition alone are a split of one in 32; the defaults have no test."""
    found = {
        FULL: {"offices": [GOOD] * 8},
        "map.keyframe_max_delay": {"offices": [LOST] * 3 + [MISPLACED] * 3 + [GOOD] * 2},
    }
    lines = document(found).splitlines()
    assert lines[-2].split(" | ") == ["| defaults", "0.020 m", "-", "0 of 8", "- |"]
    assert lines[-1].split(" | ") == [
        "| without `map.keyframe_max_delay`", "0.300 m", "15.00 (7.83 to 200.00)", "6 of 8", "0.031 |",
    ]  # fmt: skip


def test_a_variant_that_is_bad_either_way_tells_nothing() -> None:
    """Only those that differ are split."""
    ensembles = {"offices": [LOST, LOST, GOOD]}
    lines = document({FULL: ensembles, "tracking.min_overlap": {"offices": [LOST, GOOD, LOST]}}).splitlines()
    assert lines[-1].endswith("| 2 of 3 | 1 |")


def test_each_addition_that_is_switched_off_is_one() -> None:
    """A name that nobody knows would run the defaults."""
    assert set(SWITCHED_OFF) <= {addition.name for addition in MEASURED}
