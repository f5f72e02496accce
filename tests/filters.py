"""Navigation filters for tests: begun, run along a ride, and compared."""

from collections.abc import Iterator

import numpy as np

from slam_core import geometry
from slam_core.config import NavigationConfig
from slam_core.measurements import Transform
from slam_core.navigation.filter import NavigationFilter
from slam_core.results import NavigationState
from tests.motions import Ride, stamp, still

CONFIG = NavigationConfig()
R = np.diag([0.005, 0.005, np.radians(0.1)]) ** 2
OMEGA = 0.02


def xi(ride: Ride, t: float) -> np.ndarray:
    """The planar pose of the truth."""
    return geometry.planar(Transform(ride.position(t), geometry.from_rotation_matrix(ride.attitude(t))))


def begun(seconds: float = 1.0, ride: Ride | None = None, config: NavigationConfig = CONFIG) -> NavigationFilter:
    """A filter after the first seconds of a ride, without noise."""
    estimator = NavigationFilter(config)
    for sample in (ride or still()).samples(seconds):
        estimator.predict(sample)
    return estimator


def run(
    ride: Ride, seconds: float, noise: float = 1.0, seed: int = 0, bias: np.ndarray | None = None
) -> Iterator[tuple[float, NavigationState]]:
    """Inertial data, matches at 40 Hz and heights at 10 Hz; yields (time, state) after each match."""
    estimator, rng, t = NavigationFilter(CONFIG), np.random.default_rng([seed, 1]), 0.0
    for k, sample in enumerate(ride.samples(seconds, noise=noise, bias=bias, seed=seed)):
        estimator.predict(sample)
        if k % 10 == 0:
            estimator.update_height(sample.stamp_ns, ride.position(k / 100)[2] + 0.15 * noise * rng.normal())
        while t + 0.015 <= k / 100:
            error = noise * np.array([0.01, 0.01, np.radians(0.1)]) * rng.normal(size=3)
            if estimator.ready:
                yield t, estimator.fuse_planar(stamp(t), xi(ride, t) + error, R, OMEGA)
            t += 0.025


def same(a: NavigationState, b: NavigationState, tolerance: float = 1e-9) -> bool:
    """Whether two beliefs agree in every number."""
    return a.stamp_ns == b.stamp_ns and all(
        np.allclose(p, q, rtol=0.0, atol=tolerance)
        for p, q in [
            (a.T_map_base.rotation, b.T_map_base.rotation),
            (a.T_map_base.translation, b.T_map_base.translation),
            (a.velocity, b.velocity),
            (a.gyro_bias, b.gyro_bias),
            (a.accel_bias, b.accel_bias),
            (a.covariance, b.covariance),
        ]
    )


def tilt_error(state: NavigationState, ride: Ride, t: float) -> float:
    """Angle in degrees between the vertical of the belief and that of the truth."""
    up = geometry.rotation_matrix(state.T_map_base.rotation)[2]
    return float(np.degrees(np.arccos(np.clip(up @ ride.attitude(t)[2], -1.0, 1.0))))
