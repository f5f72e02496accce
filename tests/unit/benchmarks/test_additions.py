"""The comparison of the defaults with and without each addition."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.additions.cases import Case, cases, varied
from benchmarks.additions.catalogue import CONFIGURATIONS, FULL, MEASURED, SCOPES
from benchmarks.additions.compare import Comparison, compare, sign_test
from benchmarks.additions.runs import Figures, Key, is_idle, is_settled, key, missing
from hectorscope.inputs import Item
from slam_core.config import ADDITIONS, SlamConfig
from slam_core.measurements import Imu, LaserScan

CASE = Case("rooms", "some", load=lambda seed: [], seeds=20)
NAME = "matcher.surfel_weight"
SEEDS = 10


def rows(with_it: float, without: float, same: bool = False) -> dict[Key, Figures]:
    """Runs of ten seeds by the defaults, and without the surfels."""
    found = {}
    for seed in range(1, SEEDS + 1):
        for config, error in ((FULL, with_it), (NAME, without)):
            ends = "all" if same else config
            row = {
                "family": "rooms",
                "case": "some",
                "seed": seed,
                "config": config,
                "raw": error * (1 + 0.01 * seed),
            }
            found[key(row)] = {**row, "bytes": f"{ends}{seed}", "states": {"tracking": 9}}
    return found


def effect(with_it: float, without: float, same: bool = False) -> str:
    """What the comparison of such runs finds."""
    comparison = compare(rows(with_it, without, same), CASE, NAME)
    assert comparison is not None
    return comparison.effect


def test_every_addition_is_measured_under_a_name_of_its_own() -> None:
    """Those of the preset are among them; each differs from the defaults."""
    names = [addition.name for addition in MEASURED]
    assert len(set(names)) == len(names)
    assert {addition.name for addition in ADDITIONS} <= set(names)
    assert SCOPES.keys() <= set(names)
    assert all(CONFIGURATIONS[name] != SlamConfig() for name in names)


def test_cases_are_told_apart() -> None:
    """No row of the file belongs to two of them, and cases that share a simulation are run together."""
    every = cases()
    assert len({(case.family, case.name) for case in every}) == len(every)


def test_a_smaller_error_in_every_seed_helps() -> None:
    """Five per cent show, one does not, and a larger error harms; the same bytes are no difference."""
    assert effect(0.010, 0.0105) == "helps"
    assert effect(0.010, 0.0101) == "unclear"
    assert effect(0.0105, 0.010) == "harms"
    assert effect(0.010, 0.010, same=True) == "none"


def test_lost_runs_count_before_errors() -> None:
    """Six of ten lost without the addition show, also where the median error does not."""
    on = np.full(SEEDS, 0.1)
    off = np.where(np.arange(SEEDS) < 6, 2.0, 0.09)
    assert Comparison(off, on, limit=1.0, same=0).effect == "helps"
    assert Comparison(on, off, limit=1.0, same=0).effect == "harms"
    assert Comparison(off, on, limit=1.0, same=0).lost == (6, 0)


def test_a_distance_that_is_no_error_is_lost_or_not() -> None:
    """How far a recording ends from its start is not graded below the limit."""
    on, off = np.full(SEEDS, 0.1), np.full(SEEDS, 0.3)
    assert Comparison(off, on, limit=1.0, same=0, graded=False).effect == "unclear"


@pytest.mark.parametrize(("more", "fewer", "p"), [(0, 0, 1.0), (5, 5, 1.0), (6, 0, 0.03125), (1, 9, 22 / 1024)])
def test_sign_test(more: int, fewer: int, p: float) -> None:
    """Two-sided binomial probabilities."""
    assert sign_test(more, fewer) == pytest.approx(p)


def test_runs_that_tell_nothing_new_are_left_out() -> None:
    """The same bytes are copied; small differences and those in one direction are not run again."""
    assert is_idle(CASE, NAME, rows(0.01, 0.01, same=True))
    for without, settled in ((0.01001, True), (0.012, True), (0.008, True)):
        found = rows(0.01, without)
        assert not is_idle(CASE, NAME, found)
        assert is_settled(CASE, NAME, found) == settled
        assert (NAME in missing(CASE, SEEDS + 1, found)) == (not settled)
    mixed = rows(0.01, 0.012) | {("rooms", "some", 2, NAME): {**rows(0.01, 0.005)["rooms", "some", 2, NAME]}}
    assert not is_settled(CASE, NAME, mixed)
    assert missing(replace(CASE, seeds=3), 4, {}) == []


def test_a_variant_has_other_noise_and_begins_later() -> None:
    """Some first scans are left out, ranges differ by millimetres, other items go by."""
    items: list[Item] = [LaserScan(k, np.full(1000, 5.0, np.float32), 0.0, 1e-3) for k in range(20)]
    items.append(Imu(20, np.zeros(3), np.zeros(3)))
    changed = [list(varied(items, seed)) for seed in range(2, 12)]
    assert len({len(each) for each in changed}) > 2
    for each in changed:
        assert each[-1] is items[-1]
        scan = each[0]
        assert isinstance(scan, LaserScan)
        assert np.std(scan.ranges - 5.0) == pytest.approx(0.003, rel=0.15)
