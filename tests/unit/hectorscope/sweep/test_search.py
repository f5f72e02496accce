"""Quasi-random points and successive halving."""

import numpy as np
import pytest

from hectorscope.sweep.search import quasi_random, radical_inverse, rungs, standing
from hectorscope.sweep.spec import RunSpec
from hectorscope.sweep.vary import Axis, VaryError, parse

AXES = [parse("fusion.omega=0.001:0.999"), parse("matcher.sigma=0.1:0.9"), parse("map.levels=1,2,3")]


def test_the_digits_are_mirrored():
    """The van der Corput sequence in two bases."""
    assert [radical_inverse(k, 2) for k in range(1, 6)] == [0.5, 0.25, 0.75, 0.125, 0.625]
    np.testing.assert_allclose([radical_inverse(k, 3) for k in (1, 2, 3)], [1 / 3, 2 / 3, 1 / 9])


def test_a_seed_gives_the_same_points_and_another_seed_others():
    """Also the same first ones, however many are asked for."""
    assert list(quasi_random(AXES, 20, 1)) == list(quasi_random(AXES, 40, 1))[:20]
    assert list(quasi_random(AXES, 20, 1)) != list(quasi_random(AXES, 20, 2))


@pytest.mark.parametrize("seed", range(5))
def test_the_points_are_spread_evenly(seed: int):
    """Each tenth of each range has about a tenth of 200 points, and each choice about its share."""
    points = list(quasi_random(AXES, 200, seed))
    for name, low, high in (("fusion.omega", 0.001, 0.999), ("matcher.sigma", 0.1, 0.9)):
        counts, _ = np.histogram([point[name] for point in points], 10, (low, high))
        assert counts.min() >= 17
        assert counts.max() <= 23
    levels = [point["map.levels"] for point in points]
    assert all(60 <= levels.count(level) <= 73 for level in (1, 2, 3))


def test_a_search_needs_something_to_vary():
    """And not more settings than the sequence has bases."""
    with pytest.raises(VaryError, match="varies 0 settings"):
        list(quasi_random([], 3, 1))
    with pytest.raises(VaryError, match="varies 17 settings"):
        list(quasi_random([Axis(str(k), (1, 2)) for k in range(17)], 3, 1))


def test_each_rung_has_a_third_of_the_settings_and_three_times_the_time():
    """A search of a few settings runs them all at once."""
    assert rungs(90) == [(1 / 9, 90), (1 / 3, 30), (1.0, 10)]
    assert rungs(2) == [(1 / 9, 2), (1.0, 1)]
    assert rungs(1) == [(1.0, 1)]


def test_settings_stand_by_their_mean_rank():
    """The scale of a recording's errors does not count; what has no figure is last there; ties share a rank."""
    specs = {
        (bag, level): RunSpec(bag, bag, {"map.levels": level}) for bag in ("near", "far") for level in (1, 2, 3)
    }
    costs = {("near", 1): 0.1, ("near", 2): 0.2, ("near", 3): 0.3, ("far", 1): 50.0, ("far", 2): 10.0}
    order = standing(list(specs.values()), {specs[place].key: cost for place, cost in costs.items()})
    levels = {spec.setting_key: spec.settings["map.levels"] for spec in specs.values()}
    assert [levels[key] for key in order] == [1, 2, 3]  # 1 and 2 have the mean rank 0.5: the first stays first
    costs["far", 3] = 1.0
    order = standing(list(specs.values()), {specs[place].key: cost for place, cost in costs.items()})
    assert [levels[key] for key in order] == [1, 2, 3]
