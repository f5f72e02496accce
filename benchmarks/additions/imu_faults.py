"""What goes wrong with an IMU: its values leap, or the base is hit or knocked round."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from benchmarks.additions.faults import LATER, Fault, changed
from hectorscope.inputs import Item
from slam_core import geometry
from slam_core.measurements import Float32s, Float64s, Imu, LaserScan, Transform, TruthPose

WILD = 5.0, 30.0  # rad/s, m/s²: one sigma of a spike of an IMU
# The specific force (m/s²) of a base that is hit, from sample to sample, and the most that its IMU measures.
HIT, TWO_G = (40.0, 40.0, -16.0, -16.0, -16.0, -16.0, -16.0), 19.6
SHAKEN = 2.0  # rad/s, one sigma of its turns at first; it turns back as well
IMU_S = 0.01  # from one inertial sample of a simulation to the next


def spiked(share: float, samples: int) -> Fault:
    """At so many of the samples of an IMU its values leap, for so many samples."""

    def fault(items: Sequence[Item], seed: int) -> list[Item]:
        rng, left = np.random.default_rng([seed, 26]), 0
        off = np.zeros(6)

        def spike(_t: float, item: Item) -> Item:
            nonlocal left
            if not isinstance(item, Imu):
                return item
            if not left and rng.random() < share:
                left, off[:] = samples, rng.standard_normal(6) * np.repeat(WILD, 3)
            if not left:
                return item
            left -= 1
            return _moved(item, off)

        return changed(items, spike)

    return fault


def hit(every: float) -> Fault:
    """About so often (s) the base is hit: it is as fast after it as before, but its accelerometers end at 2 g."""

    def fault(items: Sequence[Item], seed: int) -> list[Item]:
        rng, due = np.random.default_rng([seed, 27]), LATER
        left, along, turn = 0, np.zeros(3), np.zeros(3)

        def shake(t: float, item: Item) -> Item:
            nonlocal due, left
            if not isinstance(item, Imu):
                return item
            if t > due:
                due, left = t + every * rng.uniform(0.5, 1.5), len(HIT)
                along[:], turn[:] = rng.standard_normal(3), SHAKEN * rng.standard_normal(3)
                along[:] /= np.linalg.norm(along)
            push = HIT[-left] if left else 0.0
            left = max(left - 1, 0)
            felt = _moved(item, np.concatenate([push / HIT[0] * turn, push * along]))
            return replace(felt, linear_acceleration=np.clip(felt.linear_acceleration, -TWO_G, TWO_G))

        return changed(items, shake)

    return fault


def knocked(every: float, degrees: float, seconds: float = 0.02) -> Fault:
    """About so often (s) the base is turned about its laser, to and fro, within so many seconds."""

    def fault(items: Sequence[Item], seed: int) -> list[Item]:
        rng, lasts = np.random.default_rng([seed, 28]), 1e-9 * (items[-1].stamp_ns - items[0].stamp_ns)
        at = LATER + np.cumsum(every * rng.uniform(0.5, 1.5, 2 * round(lasts / every)))
        times = np.column_stack([at, at + seconds]).ravel()
        turns = np.radians(degrees) * np.resize([0.0, 1.0, 1.0, 0.0], len(times))
        mount = next(item.T_base_laser.translation for item in items if isinstance(item, LaserScan))

        def knock(t: float, item: Item) -> Item:
            before, turn, after = np.interp([t - 0.5 * IMU_S, t, t + 0.5 * IMU_S], times, turns)
            if isinstance(item, Imu):
                return _moved(_turned(item, turn), np.array([0.0, 0.0, (after - before) / IMU_S, 0.0, 0.0, 0.0]))
            if isinstance(item, LaserScan):
                return replace(item, ranges=_shifted(item.ranges, round(turn / item.angle_increment)))
            if isinstance(item, TruthPose):
                turned = geometry.yaw_quaternion(turn)
                about = Transform(mount - geometry.rotate(turned, mount), turned)
                return replace(item, T_map_base=geometry.chain(item.T_map_base, about))
            return item

        return changed(items, knock)

    return fault


def _turned(imu: Imu, turn: float) -> Imu:
    """A sample in axes that are turned to the left by so many radians."""
    values, back = (imu.angular_velocity, imu.linear_acceleration), geometry.yaw_quaternion(-turn)
    rates, forces = (geometry.rotate(back, each) for each in values)
    return replace(imu, angular_velocity=rates, linear_acceleration=forces)


def _shifted(ranges: Float32s, beams: int) -> Float32s:
    """Ranges of a laser that is turned to the left by so many beams; what it did not see there has no return."""
    unseen = np.full(abs(beams), np.inf, np.float32)
    padded = np.concatenate([ranges, unseen]) if beams > 0 else np.concatenate([unseen, ranges])
    return padded[-len(ranges) :] if beams > 0 else padded[: len(ranges)]


def _moved(imu: Imu, off: Float64s) -> Imu:
    """A sample whose rates and forces are so far (6,) off."""
    rates, forces = imu.angular_velocity + off[:3], imu.linear_acceleration + off[3:]
    return replace(imu, angular_velocity=rates, linear_acceleration=forces)
