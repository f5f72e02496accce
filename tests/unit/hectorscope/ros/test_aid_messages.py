"""Messages of aiding sensors, of both generations."""

import math
from typing import Any

import numpy as np
import pytest

from hectorscope.ros import aid_messages
from hectorscope.ros.messages import BadMessage
from slam_core import geometry
from slam_core.measurements import Transform
from slam_core.navigation.aiding.geodesy import TangentPlane
from tests.ros_messages import Messages

PLANE = TangentPlane(47.0, 8.0, 400.0)


@pytest.fixture(params=["ros1", "ros2"])
def ros(request: pytest.FixtureRequest) -> Messages:
    """Both generations."""
    return Messages(request.param)


def position(message: Any) -> Any:
    return aid_messages.gps_position(message, 1, PLANE, np.zeros(3))


def test_a_field_is_turned_into_the_axes_of_the_base(ros: Messages) -> None:
    """A magnetometer that lies upside down sees y and z swapped in sign."""
    upside_down = geometry.from_euler(math.pi, 0.0, 0.0)
    found = aid_messages.magnetic_field(ros.magnetic(1, (2e-5, 1e-5, 4e-5)), 1, upside_down)
    np.testing.assert_allclose(found.field, [2e-5, -1e-5, -4e-5], atol=1e-12)


@pytest.mark.parametrize("field", [(0.2, 0.1, 0.4), (0.0, 0.0, 0.0), (20.0, 0.0, 40.0)])
def test_a_field_in_gauss_or_microtesla_is_named(ros: Messages, field: tuple[float, float, float]) -> None:
    """The reason gives range and unit, the same for each value: it is counted. NaN is a reason of its own."""
    with pytest.raises(BadMessage, match=r"^magnetic field out of 5e-06 to 0\.0003 T, .* must publish tesla$"):
        aid_messages.magnetic_field(ros.magnetic(1, field), 1, Transform().rotation)
    with pytest.raises(BadMessage, match="NaN"):
        aid_messages.magnetic_field(ros.magnetic(1, (math.nan, 0.0, 0.0)), 1, Transform().rotation)


def test_a_fix_becomes_metres_in_the_plane(ros: Messages) -> None:
    """A thousandth of a degree north is 111 m; the covariance and the antenna's place come along."""
    found = aid_messages.gps_position(ros.fix(1, 47.001, 8.0, 403.0), 1, PLANE, np.array([0.1, 0.2, 0.3]))
    np.testing.assert_allclose(found.position, [0.0, 111.2, 3.0], atol=0.1)
    np.testing.assert_allclose(found.covariance, np.diag([4.0, 4.0, 16.0]))
    assert found.antenna.tolist() == [0.1, 0.2, 0.3]
    assert position(ros.fix(1, 47.0, 8.0, 400.0, known=0)).covariance is None


def test_a_fix_without_an_altitude_tells_the_plane_alone(ros: Messages) -> None:
    """The height is given at the plane's, with a variance that makes it worthless."""
    found = position(ros.fix(1, 47.0, 8.0, math.nan))
    assert found.position[2] == pytest.approx(0.0)
    assert found.covariance[2, 2] > 1e5


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"status": -1}, "without a position"),
        ({"latitude": 91.0}, "off the Earth"),
        ({"latitude": math.nan}, "off the Earth"),
        ({"longitude": 200.0}, "off the Earth"),
        ({"variance": math.nan}, "no covariance"),
        ({"variance": 0.0}, "no covariance"),
    ],
)
def test_a_fix_that_is_none_is_named(ros: Messages, changes: dict[str, float], reason: str) -> None:
    """Each with its reason."""
    with pytest.raises(BadMessage, match=reason):
        position(ros.fix(1, **{"latitude": 47.0, "longitude": 8.0, "altitude": 400.0, **changes}))


def test_a_velocity_comes_with_or_without_covariance(ros: Messages) -> None:
    """Both types tell the same; NaN is refused."""
    for covariance in (False, True):
        message = ros.gps_velocity(1, (1.0, 2.0, 0.1), covariance=covariance)
        assert aid_messages.gps_velocity(message, 7).velocity.tolist() == [1.0, 2.0, 0.1]
    with pytest.raises(BadMessage, match="satellite velocity with NaN"):
        aid_messages.gps_velocity(ros.gps_velocity(1, (math.nan, 0.0, 0.0)), 7)


def test_a_downward_range_is_a_beam_to_the_ground(ros: Messages) -> None:
    """A sensor 0.2 m over the base that looks straight down at 1.2 m; others are named."""
    mount = Transform(np.array([0.0, 0.0, 0.2]), geometry.from_euler(0.0, math.pi / 2, 0.0))
    found = aid_messages.ground_distance(ros.range(0, 1.2), 0, mount)
    assert found.distance == pytest.approx(1.2)
    np.testing.assert_allclose(found.origin + found.distance * found.direction, [0.0, 0.0, -1.0], atol=1e-9)
    with pytest.raises(BadMessage, match="look down"):
        aid_messages.ground_distance(ros.range(0, 1.2), 0, Transform())
    with pytest.raises(BadMessage, match="out of the sensor's range"):
        aid_messages.ground_distance(ros.range(0, math.inf), 0, mount)
