"""What a sweep looks for, and what is best by it."""

from math import inf

import pytest

from hectorscope.sweep.ranking import TargetError, check_target, cost, places, target_of
from hectorscope.sweep.spec import RunSpec

TRUTH = "truth.aligned_rmse_m"


def row(status: str, **figures: str) -> dict[str, str]:
    return {"status": status, **{name.replace("__", "."): cell for name, cell in figures.items()}}


def test_the_truth_is_the_target_where_all_have_one():
    """Else the consistency score; a run without figures has no say."""
    full, bare = row("ok", truth__aligned_rmse_m="0.1", consistency="0.5"), row("ok", consistency="0.5")
    assert target_of([full, row("timeout")]) == TRUTH
    assert target_of([full, bare]) == target_of([]) == "consistency"


def test_a_lost_run_is_behind_all_that_held():
    """And one without the figure behind all; a score counts the other way round."""
    held, lost = row("ok", truth__aligned_rmse_m="80", consistency="0.2"), row("lost", truth__aligned_rmse_m="0.1")
    assert cost(held, TRUTH) < cost(lost, TRUTH) < cost(row("crashed"), TRUTH) == inf
    assert cost(row("ok", consistency="0.9"), "consistency") < cost(held, "consistency")


def test_settings_are_placed_over_all_recordings():
    """With the median of the figure and the runs that did not hold; parts of recordings do not count."""
    specs = [RunSpec(bag, bag, {"map.levels": level}) for bag in "ab" for level in (1, 2)]
    cells = ("0.1", "0.3", "0.2", "")
    rows = {
        s.key: row("ok" if c else "timeout", truth__aligned_rmse_m=c) for s, c in zip(specs, cells, strict=True)
    }
    part = RunSpec("a", "a", {"map.levels": 3}, share=0.1)
    rows[part.key] = row("ok", truth__aligned_rmse_m="0.0")
    found = places([*specs, part], rows, TRUTH)
    assert [(place.spec.value("map.levels"), place.median, place.bad) for place in found] == [
        (1, 0.15, 0),
        (2, 0.3, 1),
    ]


def test_an_unknown_target_is_named():
    """With the nearest figure."""
    check_target(None)
    check_target("consistency")
    with pytest.raises(TargetError, match=r"did you mean truth.aligned_rmse_m\?"):
        check_target("aligned_rmse_m")
