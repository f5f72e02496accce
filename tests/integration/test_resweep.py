"""Slow sweeps without inertial data: the match corrects the motion by which the beams were placed."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.accuracy import outcome, process
from hectorscope.simulation import SceneOptions, Simulation
from slam_core.config import SlamConfig, with_value

SLOW = SceneOptions(scan_rate=5.0, beams=541, imu=False, duration=30.0)


@pytest.fixture(scope="module")
def slow_drive():
    """Half a minute through the rooms, five sweeps a second."""
    return list(Simulation("rooms", SLOW).items())


def driven(items, refinements):
    """The pipeline after all of them."""
    return process(items, with_value(SlamConfig(), "motion.deskew_refinements", refinements))


def test_a_slow_sweep_is_placed_by_the_motion_that_its_match_shows(slow_drive):
    """With refinements the error is below 10 cm and less than half of what it is without."""
    refined = outcome(driven(slow_drive, 3)).raw
    assert refined < 0.10
    assert refined < 0.5 * outcome(driven(slow_drive, 0)).raw


def test_a_sweep_is_judged_as_it_is_placed_in_the_end(slow_drive):
    """One that a wrong guess of the turn has bent is placed anew before its match is doubted: none is lost."""
    assert set(driven(slow_drive, 3).states) == {"tracking"}


def test_sweeps_that_take_no_time_are_not_touched():
    """Where all beams leave at once there is nothing to place anew: the trajectory is the same to the byte."""
    items = list(Simulation("rooms", replace(SLOW, beam_timing=False, duration=10.0)).items())
    np.testing.assert_array_equal(*(driven(items, refinements).trajectory for refinements in (0, 3)))
