"""Where magnetic north lies in the map: no chart is needed, and metal that passes by is left out."""

import math

import numpy as np

from slam_core.geometry import wrap

NORTHS = 10.0  # independent headings over which the direction of north is averaged


class Compass:
    """Remembers where magnetic north lay in the map while the map could be trusted.

    norths: how many independent headings speak for `north`.
    """

    def __init__(self) -> None:
        self.norths = 0.0
        self._north = np.zeros(2)
        self._contrary = 0.0  # independent headings in a row that speak against it

    @property
    def north(self) -> float:
        """Direction of magnetic north in the map, radians; 0 until it was learned."""
        return math.atan2(self._north[1], self._north[0])

    def learn_north(self, direction: float, share: float, sigma: float) -> None:
        """The direction of the field at a moment when the heading was trusted; share: what is new in it.

        Once there is a north, one further than two sigma (radians) away has passed metal, and is left out. If that
        goes on, something about the robot has changed, and north is learned anew.
        """
        if share <= 0.0:  # of a field that is not later than the last one
            return
        far = self.norths > 1.0 and abs(wrap(direction - self.north)) > 2.0 * sigma
        self._contrary = self._contrary + share if far else 0.0
        if far and self._contrary < NORTHS:
            return
        if far:
            self.norths = self._contrary = 0.0
        self.norths = min(self.norths + share, NORTHS)
        wanted = np.array([math.cos(direction), math.sin(direction)])
        self._north = self._north + share / self.norths * (wanted - self._north)
