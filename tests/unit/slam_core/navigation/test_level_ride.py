"""A platform that stays level without a height source is noticed; others are not."""

from dataclasses import replace

import numpy as np

from slam_core.config import PlatformConfig
from slam_core.measurements import Height
from slam_core.navigation.filter import NavigationFilter
from slam_core.navigation.level_ride import LevelRide
from tests.filters import CONFIG, OMEGA, R, xi
from tests.motions import Ride, euler_matrix, still


def noticed(ride=None, *, heights=False, planar=False, seconds=26.0):
    """Whether the ride, with matches at 10 Hz, is noticed at its end."""
    ride, level_ride, found = ride or still(), LevelRide(), False
    estimator = NavigationFilter(replace(CONFIG), PlatformConfig(planar=planar))
    for k, sample in enumerate(ride.samples(seconds, rate=50.0)):
        estimator.predict(sample)
        if estimator.ready and k % 5 == 0:
            estimator.fuse_planar(sample.stamp_ns, xi(ride, k / 50), R, OMEGA)
            if heights:
                measured = Height(sample.stamp_ns, 0.0)
                estimator.update_height(measured.stamp_ns, measured.height)
            found = level_ride.unknown_height(estimator, estimator.aiding, sample.stamp_ns)
    return found


def test_a_level_ride_without_a_height_source_is_noticed():
    """After twenty seconds, not before."""
    assert noticed()
    assert not noticed(seconds=15.0)


def test_a_barometer_or_a_planar_platform_needs_no_notice():
    """The height is measured, or zero by definition."""
    assert not noticed(heights=True)
    assert not noticed(planar=True)


def test_a_platform_that_tilts_is_not_taken_for_planar():
    """It leans by 12 degrees now and then."""
    ride = Ride(lambda t: np.zeros(3), lambda t: euler_matrix(0.2 * np.sin(0.8 * t), 0.0, 0.0))
    assert not noticed(ride)
