"""What goes wrong with wheels: they are wild, stop, spin or slip while the base drives on."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from benchmarks.additions.faults import AT_S, LATER, Fault, changed
from hectorscope.inputs import Item
from slam_core.measurements import Odometry

BRAKES_S = 0.5  # in which wheels come to rest


def wild_wheels(items: Sequence[Item], seed: int) -> list[Item]:
    """One wheel velocity in twenty is up to 3 m/s off."""
    rng = np.random.default_rng([seed, 23])

    def wild(_t: float, item: Item) -> Item:
        if not isinstance(item, Odometry) or rng.random() >= 0.05:
            return item
        return replace(item, velocity=item.velocity + rng.uniform(-3.0, 3.0, 2))

    return changed(items, wild)


def spinning_wheels(items: Sequence[Item], _seed: int) -> list[Item]:
    """For two seconds the wheels turn 1 m/s too fast."""

    def spun(t: float, item: Item) -> Item:
        if not (isinstance(item, Odometry) and AT_S <= t < AT_S + 2.0):
            return item
        return replace(item, velocity=item.velocity + np.array([1.0, 0.0]))

    return changed(items, spun)


def stuck(seconds: float, every: float) -> Fault:
    """Wheels that come to rest within half a second for so long, again and again, while the base drives on."""

    def stop(wheels: Odometry, passed: float) -> Odometry:
        share = max(0.0, 1.0 - passed / BRAKES_S)
        return replace(wheels, velocity=share * wheels.velocity, yaw_rate=share * wheels.yaw_rate)

    return _wheels_again(seconds, every, stop)


def spinning(seconds: float, every: float) -> Fault:
    """Wheels that turn 1 m/s too fast at once for so long, again and again."""
    ahead = np.array([1.0, 0.0])
    return _wheels_again(seconds, every, lambda wheels, _: replace(wheels, velocity=wheels.velocity + ahead))


def slipping(seconds: float, every: float) -> Fault:
    """Wheels that show a tenth of each turn for so long, again and again."""
    return _wheels_again(seconds, every, lambda wheels, _: replace(wheels, yaw_rate=0.1 * wheels.yaw_rate))


def _wheels_again(seconds: float, every: float, change: Callable[[Odometry, float], Odometry]) -> Fault:
    """Change what wheels measure for so long, again and again; the change gets the time since then, too."""

    def fault(items: Sequence[Item], _seed: int) -> list[Item]:
        return changed(
            items,
            lambda t, i: (
                change(i, t % every) if isinstance(i, Odometry) and t > LATER and t % every < seconds else i
            ),
        )

    return fault
