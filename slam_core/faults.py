"""What is wrong with the sources of the motion at this moment: a sentence each, with its remedy."""

from collections.abc import Iterator

from slam_core.aiding.gates import LEAST_STREAK
from slam_core.inertial import AT_RANGE
from slam_core.navigation import LEAPT, SET_BACK, NavigationFilter
from slam_core.results import AidingStatus

SILENT_NS = 500_000_000


def faults(estimator: NavigationFilter, time_ns: int, patience: float) -> Iterator[str]:
    """For the filter as it is at the time of a scan; patience in seconds, see `navigation.gate_patience`."""
    if estimator.weightless:
        yield (
            "the accelerometers show no gravity: of the IMU only the yaw rate is used; its driver must publish the"
            " specific force in m/s², gravity included"
        )
    if estimator.ready and time_ns - estimator.sample_ns > SILENT_NS:
        yield "no inertial data comes: the motion is predicted from the matches alone; check the IMU"
    if estimator.counts[AT_RANGE]:
        yield "the gyro was clipped: turn slower, or set a wider range in the IMU and in navigation.gyro_range"
    if estimator.counts[SET_BACK]:
        yield "the clock of the IMU was set back: the filter went on from where it was; restart if that is wrong"
    if estimator.counts[LEAPT]:
        yield "the clock of the IMU leapt ahead: the filter went on from where it was; restart if that is wrong"
    for status in estimator.aiding:
        yield from _of_source(status, patience)


def _of_source(status: AidingStatus, patience: float) -> Iterator[str]:
    if status.frozen:
        yield f"{status.source} repeats one value while the robot moves and is not used: check that sensor"
    elif status.streak >= LEAST_STREAK and status.stamp_ns - status.streak_ns >= patience * 1e9:
        yield f"{status.source} contradicts the other sensors and is not used: check its frame, units and noise"
