"""What aids the navigation filter: magnetometers, satellite receivers and distances to the ground.

As in `messages`: pure functions, REP-103 axes, SI units; `BadMessage` with the reason for what cannot be used.
"""

import math
from typing import Any

import numpy as np

from hectorscope.ros.messages import BadMessage, finite_vector
from slam_core import geometry
from slam_core.measurements import (
    Float64s,
    GpsPosition,
    GpsVelocity,
    GroundDistance,
    MagneticField,
    Transform,
)
from slam_core.navigation.aiding.geodesy import TangentPlane

# The Earth's field has 22 to 67 microtesla; metal nearby changes it by a factor, wrong units by powers of ten.
WEAKEST_FIELD, STRONGEST_FIELD = 5e-6, 3e-4
# sensor_msgs/NavSatStatus and NavSatFix: no position; covariance unknown.
NO_FIX, UNKNOWN_COVARIANCE = -1, 0
# A receiver that gives a plane position only: the height is as good as unknown, m².
NO_ALTITUDE = 1e6
# A beam at less than this sine under the horizon does not measure the ground.
STEEP = 0.8


def magnetic_field(message: Any, time_ns: int, rotation: Float64s) -> MagneticField:
    """sensor_msgs/MagneticField turned into base axes; rotation (4,) is that of T_base_sensor."""
    b = message.magnetic_field
    field = finite_vector("magnetic field", b.x, b.y, b.z)
    size = math.hypot(b.x, b.y, b.z)
    if not WEAKEST_FIELD < size < STRONGEST_FIELD:
        raise BadMessage(
            f"magnetic field out of {WEAKEST_FIELD:g} to {STRONGEST_FIELD:g} T, where the Earth has 2.2e-05 to "
            "6.7e-05: its driver must publish tesla"
        )
    return MagneticField(time_ns, geometry.rotate(rotation, field))


def geodetic(message: Any) -> tuple[float, float, float]:
    """Latitude, longitude and altitude of a sensor_msgs/NavSatFix; altitude NaN where the receiver gives none."""
    if message.status.status <= NO_FIX:
        raise BadMessage("satellite fix without a position")
    latitude, longitude = float(message.latitude), float(message.longitude)
    if not (abs(latitude) <= 90.0 and abs(longitude) <= 180.0):
        raise BadMessage("satellite fix off the Earth: latitude or longitude is out of range")
    return latitude, longitude, float(message.altitude)


def gps_position(message: Any, time_ns: int, plane: TangentPlane, antenna: Float64s) -> GpsPosition:
    """sensor_msgs/NavSatFix in a tangent plane; antenna: (3,) its place on the base."""
    latitude, longitude, altitude = geodetic(message)
    flat = not math.isfinite(altitude)
    position = plane.enu(latitude, longitude, plane.altitude if flat else altitude)
    covariance: Float64s | None = None
    if message.position_covariance_type != UNKNOWN_COVARIANCE:
        covariance = np.array(message.position_covariance, np.float64).reshape(3, 3)
        if not (np.isfinite(covariance).all() and (np.diag(covariance)[: 2 if flat else 3] > 0.0).all()):
            raise BadMessage("satellite fix whose covariance is no covariance")
        if flat:
            covariance[2] = covariance[:, 2] = 0.0
            covariance[2, 2] = NO_ALTITUDE
    return GpsPosition(time_ns, position, covariance, antenna)


def gps_velocity(message: Any, time_ns: int) -> GpsVelocity:
    """A geometry_msgs/TwistStamped or TwistWithCovarianceStamped of a receiver: east, north, up."""
    twist = getattr(message.twist, "twist", message.twist)
    v = twist.linear
    return GpsVelocity(time_ns, finite_vector("satellite velocity", v.x, v.y, v.z))


def ground_distance(message: Any, time_ns: int, T_base_sensor: Transform) -> GroundDistance:
    """A sensor_msgs/Range that looks down along its x axis."""
    value = float(message.range)
    if not message.min_range <= value <= message.max_range:
        raise BadMessage("distance to the ground out of the sensor's range")
    direction = geometry.rotation_matrix(T_base_sensor.rotation)[:, 0]
    if -direction[2] < STEEP:
        raise BadMessage("distance by a sensor that does not look down")
    return GroundDistance(time_ns, value, T_base_sensor.translation, direction)
