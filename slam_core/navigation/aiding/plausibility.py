"""Whether an aiding measurement has values at all, and none that no robot can measure."""

import numpy as np

from slam_core.measurements import (
    PLAUSIBLE,
    Aid,
    Attitude,
    Float64s,
    GpsPosition,
    GpsVelocity,
    GroundDistance,
    Height,
    MagneticField,
    Odometry,
)

UNIT = 0.01  # by how much the norm of a unit quaternion or direction may be off
LEAST_VARIANCE = 1e-8  # m^2, of a satellite fix
FASTEST = 1e3  # m/s, rad/s, of wheels and satellites
STRONGEST = 1.0  # tesla

SOURCES: dict[type[Aid], str] = {
    Attitude: "attitude",
    Odometry: "wheels",
    Height: "height",
    GroundDistance: "ground",
    MagneticField: "compass",
    GpsPosition: "gps",
    GpsVelocity: "gps velocity",
}
"""The source of each kind of measurement, as in `AidingStatus`."""


def is_plausible(aid: Aid) -> bool:
    """Finite, in the range of what can be measured; unit quaternions and directions; positive variances."""
    match aid:
        case Attitude():
            fits = _is_unit(aid.rotation)
        case Odometry():
            fits = _is_below(FASTEST, aid.velocity) and abs(aid.yaw_rate) < FASTEST
        case Height():
            fits = abs(aid.height) < PLAUSIBLE
        case GroundDistance():
            fits = 0.0 <= aid.distance < PLAUSIBLE and _is_below(PLAUSIBLE, aid.origin) and _is_unit(aid.direction)
        case MagneticField():
            fits = _is_below(STRONGEST, aid.field) and bool(np.any(aid.field))
        case GpsPosition():
            places = np.concatenate([aid.position, aid.antenna])
            fits = _is_below(PLAUSIBLE, places) and _is_covariance(aid.covariance)
        case GpsVelocity():
            fits = _is_below(FASTEST, aid.velocity)
    return fits


def _is_below(limit: float, values: Float64s) -> bool:
    return bool(np.all(np.abs(values) < limit))  # no number is below nothing


def _is_unit(vector: Float64s) -> bool:
    return bool(abs(np.linalg.norm(vector) - 1.0) < UNIT)


def _is_covariance(covariance: Float64s | None) -> bool:
    if covariance is None:
        return True
    return _is_below(PLAUSIBLE**2, covariance) and bool(np.linalg.eigvalsh(covariance)[0] >= LEAST_VARIANCE)
