"""Latitude and longitude against what is known of the Earth."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slam_core.navigation.aiding.geodesy import SEMI_MAJOR, TangentPlane, ecef

degrees = st.floats(-89.9, 89.9)


def test_known_places_lie_where_they_are() -> None:
    """The equator at Greenwich is a radius away on x; a pole is 6356752.3142 m up the axis."""
    np.testing.assert_allclose(ecef(0.0, 0.0, 0.0), [SEMI_MAJOR, 0.0, 0.0])
    np.testing.assert_allclose(ecef(90.0, 0.0, 0.0), [0.0, 0.0, 6356752.3142], atol=1e-4)


def test_a_minute_of_latitude_is_about_a_sea_mile() -> None:
    """North by a minute is 1852 m, within half a percent, and no way east; east shrinks by the cosine."""
    plane = TangentPlane(45.0, 8.0, 100.0)
    north = plane.enu(45.0 + 1 / 60, 8.0, 100.0)
    east = plane.enu(45.0, 8.0 + 1 / 60, 100.0)
    assert north[1] == pytest.approx(1852.0, rel=5e-3)
    assert abs(north[0]) < 1e-6
    assert east[0] == pytest.approx(1852.0 * math.cos(math.radians(45.0)), rel=5e-3)
    np.testing.assert_allclose(plane.enu(45.0, 8.0, 103.0), [0.0, 0.0, 3.0], atol=1e-6)


@given(degrees, st.floats(-180.0, 180.0), st.tuples(*[st.floats(-5000.0, 5000.0)] * 3))
def test_there_and_back(latitude: float, longitude: float, point: tuple[float, float, float]) -> None:
    """A point of the plane comes back from its latitude and longitude to a tenth of a millimetre."""
    plane = TangentPlane(latitude, longitude, 300.0)
    np.testing.assert_allclose(plane.enu(*plane.geodetic(np.array(point))), point, atol=1e-4)
