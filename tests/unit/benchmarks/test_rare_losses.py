"""The table of rare losses: each addition against the defaults, variant by variant."""

from dataclasses import replace

from benchmarks.additions.catalogue import FULL, MEASURED
from benchmarks.ensembles import Outcome
from benchmarks.rare_losses import SWITCHED_OFF, document, is_certain

GOOD = Outcome(0.02, 0.01, lost=False, misplaced=False, silent=False, slides=0)
LOST = Outcome(4.0, 0.5, lost=True, misplaced=False, silent=False, slides=0)
MISPLACED = Outcome(0.3, 0.1, lost=False, misplaced=True, silent=True, slides=0)


def test_a_row_counts_the_variants_and_how_uneven_they_are_split() -> None:
    """Six of eight that are bad without the addition alone are a split of one in 32; the defaults have no test."""
    found = {
        FULL: {"offices": [GOOD] * 8},
        "map.keyframe_max_delay": {"offices": [LOST] * 3 + [MISPLACED] * 3 + [GOOD] * 2},
    }
    lines = document(found).splitlines()
    assert lines[-2].split(" | ") == ["| defaults", "0.020 m", "-", "0 of 8", "-", "0", "- |"]
    assert lines[-1].split(" | ") == [
        "| without `map.keyframe_max_delay`", "0.300 m", "15.00 (7.83 to 200.00)", "6 of 8", "0.031", "0", "1 |",
    ]  # fmt: skip


def test_a_variant_that_is_bad_either_way_tells_nothing() -> None:
    """Only those that differ are split."""
    ensembles = {"offices": [LOST, LOST, GOOD]}
    lines = document({FULL: ensembles, "tracking.min_overlap": {"offices": [LOST, GOOD, LOST]}}).splitlines()
    assert lines[-1].endswith("| 2 of 3 | 1 | 0 | 1 |")


def test_defaults_may_have_more_variants() -> None:
    """An addition is compared in the variants that it has."""
    found = {FULL: {"offices": [GOOD] * 12}, "tracking.min_overlap": {"offices": [LOST] * 6 + [GOOD] * 2}}
    full, without = document(found).splitlines()[-2:]
    assert full.endswith("| 0 of 12 | - | 0 | - |")
    assert without.endswith("| 6 of 8 | 0.031 | 0 | 1 |")


def test_a_difference_is_certain_by_the_errors_the_slides_or_the_bad_ones() -> None:
    """Six bad ones against none are certain, five are not; so are larger errors, and more slides."""
    larger, slides = replace(GOOD, error=0.03), replace(GOOD, slides=7)
    on = {"offices": [GOOD] * 20, "mit": [GOOD] * 20}
    for off, certain in (
        ([LOST] * 6, True),
        ([LOST] * 5, False),
        ([larger] * 20, True),
        ([slides] * 6, True),
        ([], False),
    ):
        assert is_certain({"offices": [*off, *[GOOD] * (20 - len(off))], "mit": [GOOD] * 20}, on) == certain


def test_each_addition_that_is_switched_off_is_one() -> None:
    """A name that nobody knows would run the defaults."""
    assert set(SWITCHED_OFF) <= {addition.name for addition in MEASURED}
