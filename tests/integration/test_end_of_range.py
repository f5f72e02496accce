"""A laser that sends the end of its range, with noise, where nothing returns."""

import pytest

from benchmarks import ensembles


@pytest.mark.parametrize("name", ["rooms", "glass, laser alone"])
def test_the_end_of_the_range_is_no_wall_that_moves_with_the_robot(name: str) -> None:
    """Half of what is sent lies below the end of the range: the map has nothing there, and nobody gets lost."""
    found = ensembles.outcomes([ensembles.run(f"{name}, 8 m sent without a return", 2, {})])
    assert found[0].error < 0.1 and not (found[0].misplaced or found[0].silent)
