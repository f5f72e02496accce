import numpy as np

from hectorscope.run.metrics import map_in_world, medians, sources
from hectorscope.run.series import SERIES_DTYPE
from slam_core.results import PlanarGaussian
from tests.page import step_result


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


def test_what_aids_the_filter_is_counted() -> None:
    """Every source with its counters; a run without results has none."""
    found = sources(step_result())
    assert found["gps"] == {"used": 60, "rejected": 7, "dropped": {}}
    assert found["compass"]["dropped"] == {"<metal>": 4}
    assert sources(None) == {}


def test_the_place_of_the_map_in_the_world_is_told_once_it_is_known() -> None:
    """Metres east and north of the first fix, degrees from east, and how sure that is."""
    world = PlanarGaussian(np.array([3.0, -2.0, np.pi / 2]), np.diag([0.25, 0.16, np.radians(2.0) ** 2]))
    found = map_in_world(step_result()._replace(world=world))
    assert found == {"east_m": 3.0, "north_m": -2.0, "from_east_deg": 90.0, "sigma_m": 0.5, "sigma_deg": 2.0}
    assert map_in_world(step_result()) is None
    assert map_in_world(None) is None
