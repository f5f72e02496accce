"""Runs every compiled kernel once, so that the first real scan does not wait for the compiler."""

import sys
import threading

import numpy as np

from app.pipeline import Pipeline
from app.settings import Settings
from slam_core.config import SlamConfig, with_value
from slam_core.given import GivenMap, saved_levels
from slam_core.measurements import Height, Imu, LaserScan, Measurement, Odometry

PATIENCE_S = 3.0


def warm_up() -> None:
    """A few scans of a small made-up room through every branch; says so on stderr when it takes longer."""
    notice = threading.Timer(PATIENCE_S, lambda: print("Compiling ... (first start only)", file=sys.stderr))
    notice.start()
    try:
        for inertial in (True, False):
            _run(inertial)
    finally:
        notice.cancel()


def _run(inertial: bool) -> None:
    # The surfaces are looked for in every scan.
    config = with_value(with_value(SlamConfig(), "map.size", 256), "matcher.weak_share", 1.0)
    given = None
    for method in ("hessian", "sampled"):
        pipeline = Pipeline(Settings(with_value(config, "matcher.covariance", method)), given=given)
        for measurement in _room(inertial):
            for ready in pipeline.admit(measurement):
                pipeline.step(ready)
        for ready in pipeline.flush():
            pipeline.step(ready)
        given = GivenMap(
            "the room", saved_levels(pipeline.slam.pyramid)
        )  # the second run looks for its place in it


def _room(inertial: bool) -> list[Measurement]:
    """Two seconds in the middle of a room of 4 by 4 metres: a scan every 0.1 s, other data besides."""
    angles = np.linspace(-np.pi, np.pi, 181)
    ranges = (2.0 / np.maximum(np.abs(np.cos(angles)), np.abs(np.sin(angles)))).astype(np.float32)
    ranges[:3] = np.inf
    measurements: list[Measurement] = []
    for tick in range(200):
        stamp_ns = tick * 10_000_000
        if inertial:
            measurements.append(Imu(stamp_ns, np.zeros(3), np.array([0.0, 0.0, 9.80665])))
            measurements.append(Height(stamp_ns, 0.0))
        if tick % 10 == 0:
            measurements.append(Odometry(stamp_ns, np.zeros(2), 0.0))
            seen = ranges if tick < 190 else 0.4 * ranges  # the last one fits nowhere: it is searched for
            measurements.append(LaserScan(stamp_ns, seen, -np.pi, float(angles[1] - angles[0]), 1e-5, 0.1, 30.0))
    return measurements
