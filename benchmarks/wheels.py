"""Wheels for a simulated drive: they measure the velocity of the base, a little too large and with noise."""

from collections.abc import Iterable, Iterator

import numpy as np

from hectorscope.inputs import Item
from slam_core import geometry
from slam_core.measurements import Odometry, TruthPose

EVERY_NS = 50_000_000
SCALE, NOISE = 1.01, 0.02  # of the velocity; m/s and rad/s


def with_wheels(items: Iterable[Item], seed: int) -> Iterator[Item]:
    """The items, and after every few true poses the mean velocity since the last of them."""
    rng = np.random.default_rng([seed, 3])
    last: TruthPose | None = None
    for item in items:
        yield item
        if isinstance(item, TruthPose) and (last is None or item.stamp_ns - last.stamp_ns >= EVERY_NS):
            if last is not None:
                yield _measured(last, item, rng)
            last = item


def _measured(last: TruthPose, now: TruthPose, rng: np.random.Generator) -> Odometry:
    dt = (now.stamp_ns - last.stamp_ns) * 1e-9
    before, after = geometry.planar(last.T_map_base), geometry.planar(now.T_map_base)
    moved = geometry.compose(geometry.inverse(before), after) / dt
    forward, left, rate = SCALE * moved + NOISE * rng.normal(size=3)
    return Odometry((last.stamp_ns + now.stamp_ns) // 2, np.array([forward, left]), float(rate))
