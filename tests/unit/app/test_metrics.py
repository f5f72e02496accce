import numpy as np

from app.metrics import medians
from app.snapshot import SERIES_DTYPE
from app.warmup import warm_up


def test_medians_are_microseconds_and_the_map_update_only_counts_where_there_was_one():
    """A map that is updated every third scan does not look free of charge."""
    series = np.zeros(7, SERIES_DTYPE)
    series["match_ms"] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]
    series["map_updates"] = [1, 1, 1, 2, 2, 2, 3]
    series["update_ms"] = [5.0, 0, 0, 2.0, 0, 0, 3.0]
    got = medians(series)
    assert got == {"stabilise": 0.0, "match": 400.0, "update": 3000.0, "filter": 0.0}


def test_medians_of_nothing_are_zero():
    """No map update at all is no reason to fail."""
    assert medians(np.zeros(0, SERIES_DTYPE))["update"] == 0.0


def test_the_warm_up_runs_through():
    """The made-up room exercises the whole pipeline without an error."""
    warm_up()
