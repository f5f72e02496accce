"""What is wrong with the sensors and the map: codes and values, which the application puts into words."""

from collections.abc import Hashable, Iterable
from typing import Generic, Literal, NamedTuple, TypeVar

SHOWN_NS = 5_000_000_000  # a diagnostic that no longer holds is reported for this long

# Reasons for which a scan has no result.
NO_BEAM = "scan without a beam in range"
NO_ATTITUDE = "scan before the attitude was known"
REPEATED = "scan that repeats the one before while the robot moves"
TOO_LATE = "scan older than the state buffer (navigation.history)"
NOT_LOCALISED = "scan before the robot was found in the map"

Code = Literal[
    "map_limit",  # the map stopped growing; value: its limit in megabytes
    "no_gravity",  # the accelerometers measure no gravity: only the yaw rate is used
    "no_attitude",  # inertial data comes, but too little at a time to find the attitude
    "imu_silent",  # no inertial data comes
    "gyro_clipped",
    "imu_clock_set_back",
    "imu_clock_set_ahead",
    "imu_implausible",  # values that are not finite or out of any sensor's range
    "imu_repeats",  # the same sample again and again, of a sensor with noise
    "imu_spikes",  # samples far from those on both sides
    "imu_shaken",  # it leaps, and the next samples follow
    "no_beam_in_range",
    "scans_repeated",
    "scans_too_late",  # older than the state buffer reaches back
    "came_together",  # source: of which several came at once after a pause, stamped on arrival
    "wheels_slip",  # they stop or spin as no base does, or scans contradict them
    "height_unknown",  # nothing measures the height of a platform that stays level
    "aid_implausible",  # source: which one, as in AidingStatus
    "aid_too_late",
    "aid_frozen",  # it repeats one value while the robot moves
    "aid_contradicts",  # it is rejected for long
]


class Diagnostic(NamedTuple):
    """One fault. source: the sensor that it is about, where there are several. value: see the code."""

    code: Code
    source: str = ""
    value: float = 0.0


T = TypeVar("T", bound=Hashable)


class Recent(Generic[T]):
    """Items with the time at which each held last."""

    def __init__(self) -> None:
        self._held: dict[T, int] = {}

    def add(self, items: Iterable[T], time_ns: int) -> None:
        """They hold at this time."""
        self._held.update(dict.fromkeys(items, time_ns))

    def at(self, time_ns: int) -> tuple[T, ...]:
        """Those that held less than SHOWN_NS before or, if a clock was set, after this time."""
        if not self._held:  # nearly always
            return ()
        return tuple(item for item, held_ns in self._held.items() if abs(time_ns - held_ns) < SHOWN_NS)
