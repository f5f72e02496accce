"""The navigation filter on inertial data alone: where is up, by it, by the accelerometer, by the device itself."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from benchmarks.cases import Recording
from hectorscope.ros.repairs import STANDARD_GRAVITY
from hectorscope.sources.bag import open_bag
from slam_core import geometry
from slam_core.config import SlamConfig
from slam_core.evaluation.trajectory import rms
from slam_core.measurements import Attitude, Float64s, Imu
from slam_core.navigation.filter import NavigationFilter
from slam_core.results import NavigationState

QUIET = 0.05  # rad/s: nobody moves a device that turns slower than this
FORCE = 0.3  # m/s²: nor one that feels gravity so exactly


@dataclass(frozen=True)
class Ride:
    """What was felt, sample by sample: directions (n, 3) of up in the axes of the base.

    ours: the filter's. felt: the specific force's. own: that of the orientation which the device estimates itself,
    no rows if it gives none. still: (n,) where the device is at rest. state: the filter's, at the end.
    """

    ours: Float64s
    felt: Float64s
    own: Float64s
    still: NDArray[np.bool_]
    state: NavigationState

    @cached_property
    def astray(self) -> float:
        """Median of degrees between our up and the force at rest."""
        return float(np.median(degrees(self.ours, self.felt)[self.still]))

    @cached_property
    def own_astray(self) -> float | None:
        """The same of the device's own."""
        return float(np.median(degrees(self.own, self.felt)[self.still])) if len(self.own) else None

    @cached_property
    def apart(self) -> float | None:
        """Root mean square of degrees between our up and the device's own."""
        return rms(degrees(self.ours, self.own)) if len(self.own) else None


def ride(recording: Recording) -> Ride:
    """A recording of inertial data through the filter, uncorrected by anything."""
    navigation = NavigationFilter(SlamConfig().navigation)
    rows: list[tuple[Float64s, Float64s, bool]] = []
    own: list[Float64s] = []
    for item in open_bag(recording.path, recording.options).items():
        if isinstance(item, Imu):
            navigation.predict(item)
            if navigation.ready:
                rows.append((_up(navigation.pose(item.stamp_ns).rotation), item.linear_acceleration, _still(item)))
        elif isinstance(item, Attitude) and navigation.ready:
            own.append(_up(item.rotation))
    forces = np.array([force for _, force, _ in rows])
    return Ride(
        ours=np.array([up for up, _, _ in rows]),
        felt=forces / np.linalg.norm(forces, axis=1, keepdims=True),
        own=np.array(own).reshape(-1, 3),
        still=np.array([still for _, _, still in rows]),
        state=navigation.state,
    )


def degrees(a: Float64s, b: Float64s) -> Float64s:
    """Angles (n,) between directions (n, 3)."""
    between: Float64s = np.degrees(np.arccos(np.clip(np.sum(a * b, axis=1), -1.0, 1.0)))
    return between


def _up(rotation: Float64s) -> Float64s:
    return geometry.rotate(geometry.conjugate(rotation), np.array([0.0, 0.0, 1.0]))


def _still(imu: Imu) -> bool:
    force = float(np.linalg.norm(imu.linear_acceleration))
    return bool(np.abs(imu.angular_velocity).max() < QUIET and abs(force - STANDARD_GRAVITY) < FORCE)
