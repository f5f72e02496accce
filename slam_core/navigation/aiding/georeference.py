"""The pose of the map in the tangent plane of the satellites: estimated while both are known, used if one is not.

The map begins wherever the first scan was taken, facing anywhere. Pairs of a place in the map and in the plane,
and of a velocity in both, give the motion p_plane = R(theta) p_map + t by weighted least squares: the centroids
map on each other, and theta is the direction of the sum of w (dot, cross) over what they leave. That sum is the
resultant of a von Mises density, so a compass adds its own direction to it with its own weight.
"""

import math

import numpy as np

from slam_core import geometry
from slam_core.measurements import Float64s
from slam_core.results import PlanarGaussian

# A turn less certain than this does not give the pose of the map yet.
KNOWN_TURN = 0.15  # rad


class Georeference:
    """Sums over the pairs so far; weights are 1 / variance of what is independent in a measurement."""

    def __init__(self) -> None:
        self._weight = 0.0
        self._in_map = np.zeros(3)
        self._in_plane = np.zeros(3)
        self._pairs = np.zeros(2)  # w (dot, cross)
        self._concentration = 0.0
        self._compass = np.zeros(2)

    @property
    def turn_known(self) -> bool:
        """Whether a direction in the plane is known in the map."""
        return self.turn_variance < KNOWN_TURN**2

    @property
    def known(self) -> bool:
        """Whether a position in the plane is known in the map."""
        return self._weight > 0.0 and self.turn_known

    @property
    def turn(self) -> float:
        """The direction theta of the map's x axis in the plane, from east, radians."""
        cosine, sine = (self._pairs + self._compass).tolist()
        return math.atan2(sine, cosine)

    @property
    def turn_variance(self) -> float:
        """Of theta, radians squared."""
        information = self._concentration + math.hypot(*self._compass.tolist())
        return 1.0 / information if information else math.inf

    def add_place(self, in_map: Float64s, in_plane: Float64s, weight: float) -> None:
        """One place (3,) by both, metres."""
        total = self._weight + weight
        away_map, away_plane = in_map - self._in_map, in_plane - self._in_plane
        if self._weight:
            self.add_vector(away_map, away_plane, weight * self._weight / total)
        self._in_map = self._in_map + weight / total * away_map
        self._in_plane = self._in_plane + weight / total * away_plane
        self._weight = total

    def add_vector(self, in_map: Float64s, in_plane: Float64s, weight: float) -> None:
        """One vector (3,) by both: a velocity, or what lies between two places."""
        dot = in_map[0] * in_plane[0] + in_map[1] * in_plane[1]
        cross = in_map[0] * in_plane[1] - in_map[1] * in_plane[0]
        self._pairs = self._pairs + weight * np.array([dot, cross])
        self._concentration += weight * float(in_map[0] ** 2 + in_map[1] ** 2)

    def set_compass(self, turn: float, sigma: float) -> None:
        """Theta by a compass, radians: counted once, since its error is constant."""
        self._compass = np.array([math.cos(turn), math.sin(turn)]) / sigma**2

    def place(self, in_plane: Float64s) -> tuple[Float64s, Float64s]:
        """A place (3,) of the plane in the map, and the (3, 3) covariance of the relation; it must be `known`."""
        away, spread = self.vector(in_plane - self._in_plane)
        return self._in_map + away, spread + np.eye(3) / self._weight

    def vector(self, in_plane: Float64s) -> tuple[Float64s, Float64s]:
        """The same of a vector (3,), for which `turn_known` is enough."""
        turned = geometry.rotate(geometry.yaw_quaternion(-self.turn), in_plane)
        across = np.array([-turned[1], turned[0], 0.0])
        return turned, self.turn_variance * np.outer(across, across)

    def pose(self) -> PlanarGaussian:
        """The map's origin and heading in the plane; it must be `known`."""
        turn, variance = self.turn, self.turn_variance
        (x, y, _), (east, north, _) = self._in_map.tolist(), self._in_plane.tolist()
        c, s = math.cos(turn), math.sin(turn)
        x, y = c * x - s * y, s * x + c * y
        place = 1.0 / self._weight
        covariance = np.array([
            [variance * y * y + place, -variance * x * y, variance * y],
            [-variance * x * y, variance * x * x + place, -variance * x],
            [variance * y, -variance * x, variance],
        ])  # fmt: skip
        return PlanarGaussian(np.array([east - x, north - y, turn]), covariance)
