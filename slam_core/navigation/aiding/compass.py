"""The magnetic field as a direction in the map, and when it is not the Earth's.

Metal and currents change the field's size and inclination as well as its direction: a field that differs in either
from what was usual is rejected. The usual field is the mean of what the magnetometer has measured, so no chart is
needed.
"""

import math
from typing import NamedTuple

import numpy as np

from slam_core.geometry import wrap
from slam_core.measurements import Float64s

LEARNED = 20  # samples before there is a usual field
REMEMBERED = 500  # samples over which the usual field is averaged
PATIENCE_NS = 20_000_000_000  # a change that lasts longer is the new usual
NORTHS = 10.0  # independent headings over which the direction of north is averaged


class Field(NamedTuple):
    """A field as the map sees it: size in tesla; inclination below the horizon and direction from x, radians."""

    size: float
    inclination: float
    direction: float


def seen(in_map: Float64s) -> Field:
    """The field (3,) in the map's axes, taken apart."""
    x, y, z = in_map.tolist()
    across = math.hypot(x, y)
    return Field(math.hypot(across, z), math.atan2(-z, across), math.atan2(y, x))


class Compass:
    """Remembers the usual field, and where magnetic north lay in the map while the map could be trusted.

    norths: how many independent headings speak for `north`.
    """

    def __init__(self) -> None:
        self.norths = 0.0
        self._north = np.zeros(2)
        self._count = 0
        self._size = 0.0
        self._inclination = 0.0
        self._disturbed_ns: int | None = None

    @property
    def north(self) -> float:
        """Direction of magnetic north in the map, radians; 0 until it was learned."""
        return math.atan2(self._north[1], self._north[0])

    def check(self, field: Field, time_ns: int, tolerance: float) -> str:
        """What speaks against a field, else empty; tolerance: share of the size, and radians of inclination."""
        if self._count >= LEARNED and self._unusual(field, tolerance):
            self._disturbed_ns = time_ns if self._disturbed_ns is None else self._disturbed_ns
            if time_ns - self._disturbed_ns < PATIENCE_NS:
                return "magnetic field disturbed by metal or currents"
            self._count, self.norths = 0, 0.0
        self._disturbed_ns = None
        self._count = min(self._count + 1, REMEMBERED)
        self._size += (field.size - self._size) / self._count
        self._inclination += (field.inclination - self._inclination) / self._count
        return "" if self._count >= LEARNED else "usual magnetic field not known yet"

    def learn_north(self, direction: float, share: float, sigma: float) -> None:
        """The direction of the field at a moment when the heading was trusted; share: what is new in it.

        Once there is a north, one further than two sigma (radians) away has passed metal, and is left out.
        """
        if self.norths > 1.0 and abs(wrap(direction - self.north)) > 2.0 * sigma:
            return
        self.norths = min(self.norths + share, NORTHS)
        wanted = np.array([math.cos(direction), math.sin(direction)])
        self._north = self._north + share / self.norths * (wanted - self._north)

    def _unusual(self, field: Field, tolerance: float) -> bool:
        changed = abs(field.size / self._size - 1.0)
        return max(changed, abs(field.inclination - self._inclination)) > tolerance
