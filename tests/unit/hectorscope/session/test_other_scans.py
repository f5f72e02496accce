"""Other scans of a recording than the shown one."""

from dataclasses import replace

import numpy as np
import pytest

from slam_core.errors import SlamError
from tests.xray import PAPER, drive, other_scans, scanned


@pytest.mark.parametrize("number", [2, 20, 45, 53])
def test_a_scan_is_reached_as_the_run_processed_it(number: int):
    """Before and behind the checkpoint: result and configuration are those of the run, to the last byte."""
    others = other_scans()
    reached = list(others.way_to(float(others.times[number]), 60.0))[-1]
    assert reached is not None
    assert reached.config == PAPER
    again = reached.rework.again(others.settings)
    assert again.scans == number
    whole = list(others.way_to(float(others.times[-1]), 60.0))[-1]
    assert whole is not None
    _, last = scanned()
    np.testing.assert_array_equal(whole.result.T_map_base.translation, last.T_map_base.translation)
    np.testing.assert_array_equal(whole.result.fused.covariance, last.fused.covariance)


def test_the_way_is_taken_in_slices():
    """Whoever waits beside has a turn after each."""
    others = other_scans()
    found = list(others.way_to(float(others.times[20]), 0.0))
    assert len(found) > 20
    assert all(each is None for each in found[:-1])
    assert found[-1] is not None


def test_the_nearest_known_scan_is_chosen():
    """Times and steps beyond the ends are those of the first and last scan; without scans there is none."""
    others = other_scans()
    first, last = float(others.times[0]), float(others.times[-1])
    assert others.time_of(-5.0, 0) == first
    assert others.time_of(1e6, 0) == last
    assert others.time_of(first + 0.04, 0) == first
    assert others.time_of(first, 1) == others.times[1]
    assert others.time_of(last, 100) == last
    assert replace(others, times=np.empty(0)).time_of(1.0, 0) is None


def test_a_scan_that_is_not_there_is_told():
    """A recording that became shorter ends before it."""
    with pytest.raises(SlamError, match="ends before"):
        list(other_scans().way_to(drive()[-1].stamp_ns / 1e9 + 5.0, 60.0))
