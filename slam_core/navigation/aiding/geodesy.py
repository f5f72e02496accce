"""WGS 84: from latitude and longitude to metres in the plane that touches the ellipsoid at an origin."""

import math
from dataclasses import dataclass

import numpy as np

from slam_core.measurements import Float64s

SEMI_MAJOR = 6378137.0  # m
FLATTENING = 1.0 / 298.257223563
ECCENTRICITY_SQUARED = FLATTENING * (2.0 - FLATTENING)


@dataclass(frozen=True, slots=True)
class TangentPlane:
    """East, north and up at an origin: latitude, longitude in degrees, altitude over the ellipsoid in metres."""

    latitude: float
    longitude: float
    altitude: float

    def enu(self, latitude: float, longitude: float, altitude: float) -> Float64s:
        """(3,) metres east, north and up of the origin."""
        away = ecef(latitude, longitude, altitude) - ecef(self.latitude, self.longitude, self.altitude)
        return self._axes() @ away

    def geodetic(self, enu: Float64s) -> tuple[float, float, float]:
        """Latitude, longitude in degrees and altitude in metres of a point (3,) of the plane."""
        x, y, z = (ecef(self.latitude, self.longitude, self.altitude) + self._axes().T @ enu).tolist()
        across = math.hypot(x, y)
        latitude, altitude = math.atan2(z, across), 0.0
        for _ in range(6):  # converges by a factor of 150 a turn
            radius = _prime_vertical(latitude)
            altitude = across * math.cos(latitude) + z * math.sin(latitude) - SEMI_MAJOR**2 / radius
            latitude = math.atan2(z, across * (1.0 - ECCENTRICITY_SQUARED * radius / (radius + altitude)))
        return math.degrees(latitude), math.degrees(math.atan2(y, x)), altitude

    def _axes(self) -> Float64s:
        """(3, 3) the rows are east, north and up in the axes of the Earth."""
        phi, lam = math.radians(self.latitude), math.radians(self.longitude)
        s, c, sl, cl = math.sin(phi), math.cos(phi), math.sin(lam), math.cos(lam)
        return np.array([[-sl, cl, 0.0], [-s * cl, -s * sl, c], [c * cl, c * sl, s]])


def ecef(latitude: float, longitude: float, altitude: float) -> Float64s:
    """(3,) metres in the Earth's own axes."""
    phi, lam = math.radians(latitude), math.radians(longitude)
    radius = _prime_vertical(phi)
    across = (radius + altitude) * math.cos(phi)
    up = (radius * (1.0 - ECCENTRICITY_SQUARED) + altitude) * math.sin(phi)
    return np.array([across * math.cos(lam), across * math.sin(lam), up])


def _prime_vertical(phi: float) -> float:
    return SEMI_MAJOR / math.sqrt(1.0 - ECCENTRICITY_SQUARED * math.sin(phi) ** 2)
