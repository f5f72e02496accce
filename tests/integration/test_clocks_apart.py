"""Recordings whose laser and IMU are stamped by clocks that are far apart."""

import pytest

from benchmarks import ensembles


@pytest.mark.parametrize(
    "what", ["laser's clock 30 s behind", "IMU's clock from its start, and fast", "IMU's clock set by 40 s"]
)
@pytest.mark.parametrize("name", ["rooms", "handheld"])
def test_clocks_that_are_apart_lose_nobody(name: str, what: str) -> None:
    """Nor is anything written at a wrong place: stamps are put right by when messages were recorded."""
    found = ensembles.outcomes([ensembles.run(f"{name}, {what}", 2, {})])
    assert found[0].error < 0.03 and not (found[0].misplaced or found[0].silent)
