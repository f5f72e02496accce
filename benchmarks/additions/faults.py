"""What goes wrong in a drive: scans that are missing, broken or from elsewhere, and measurements that are wild."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np

from benchmarks.strays import astray
from hectorscope.inputs import Item
from slam_core import geometry
from slam_core.measurements import (
    Float32s,
    Float64s,
    GpsPosition,
    Height,
    Imu,
    LaserScan,
    Odometry,
    Transform,
    TruthPose,
)

Fault = Callable[[Sequence[Item], int], list[Item]]
"""The items of a drive, damaged; the seed draws the noise."""
Change = Callable[[float, Item], Item | None]
AT_S = 12.0  # seconds from the first item to the fault
BROKEN_SCANS = 10
BRAKES_S = 0.5  # in which wheels come to rest
LATER = 5.0  # seconds from the first item to what happens again and again
HAND = 0.4  # metres before the laser
WILD = 5.0, 30.0  # rad/s, m/s²: one sigma of a spike of an IMU
# The specific force (m/s²) of a base that is hit, from sample to sample, and the most that its IMU measures.
HIT, TWO_G = (40.0, 40.0, -16.0, -16.0, -16.0, -16.0, -16.0), 19.6
IMU_S = 0.01  # from one inertial sample of a simulation to the next
SHAKEN = 2.0  # rad/s, one sigma of its turns at first; it turns back as well
AROUND, AWAY, BODY = 4.2, 0.7, 0.25  # radians of the field that people stand in, metres to them, their radius


def changed(items: Iterable[Item], change: Change) -> list[Item]:
    """Each item changed, or left out (None), by its seconds since the first one."""
    items = list(items)
    begin_ns = items[0].stamp_ns
    found = (change((item.stamp_ns - begin_ns) * 1e-9, item) for item in items)
    return [item for item in found if item is not None]


def without_scans(begin: float, end: float) -> Fault:
    """No scan between two times."""

    def fault(items: Sequence[Item], _seed: int) -> list[Item]:
        return changed(items, lambda t, item: None if isinstance(item, LaserScan) and begin <= t < end else item)

    return fault


def broken_scans(items: Sequence[Item], seed: int) -> list[Item]:
    """Some scans whose ranges are noise."""
    rng, left = np.random.default_rng([seed, 21]), BROKEN_SCANS

    def broken(t: float, item: Item) -> Item:
        nonlocal left
        if not isinstance(item, LaserScan) or t < AT_S or not left:
            return item
        left -= 1
        return replace(item, ranges=rng.uniform(0.5, 10.0, len(item.ranges)).astype(np.float32))

    return changed(items, broken)


def carried_away(items: Sequence[Item], seed: int) -> list[Item]:
    """The drive up to a time, and from there its own seconds from the fourth on again."""
    begin_ns, jump_ns = items[0].stamp_ns, round((AT_S - 4.0) * 1e9)
    first = [item for item in items if item.stamp_ns - begin_ns < AT_S * 1e9]
    again = [item for item in items if 4.0 <= (item.stamp_ns - begin_ns) * 1e-9 < AT_S - 2.0]
    return [*first, *(replace(item, stamp_ns=item.stamp_ns + jump_ns) for item in again)]


def carried_on(items: Sequence[Item], seed: int) -> list[Item]:
    """Eight seconds of the drive happen while nothing measures; there is no scan for twenty seconds then."""
    begin_ns, from_ns, lasts_ns = items[0].stamp_ns, round(25.0 * 1e9), round(8.0 * 1e9)
    first = [item for item in items if item.stamp_ns - begin_ns < from_ns]
    rest = [item for item in items if item.stamp_ns - begin_ns >= from_ns + lasts_ns]
    moved = [replace(item, stamp_ns=item.stamp_ns - lasts_ns) for item in rest]
    return without_scans(25.0, 45.0)([*first, *moved], seed)


def stray_beams(items: Sequence[Item], seed: int) -> list[Item]:
    """Three beams in ten end anywhere before the wall."""
    return list(astray(items, 0.3, seed))


def no_heights(items: Sequence[Item], _seed: int) -> list[Item]:
    """No barometer."""
    return [item for item in items if not isinstance(item, Height)]


def wild_heights(items: Sequence[Item], seed: int) -> list[Item]:
    """One height in twenty is up to 20 m off."""
    rng = np.random.default_rng([seed, 22])

    def wild(_t: float, item: Item) -> Item:
        if not isinstance(item, Height) or rng.random() >= 0.05:
            return item
        return replace(item, height=item.height + float(rng.uniform(-20.0, 20.0)))

    return changed(items, wild)


def raised_heights(items: Sequence[Item], _seed: int) -> list[Item]:
    """A door opens: the air pressure shows 3 m more from a time on."""
    return changed(
        items, lambda t, i: replace(i, height=i.height + 3.0) if isinstance(i, Height) and t >= AT_S else i
    )


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


def jumping_satellites(items: Sequence[Item], _seed: int) -> list[Item]:
    """For five seconds the satellites show 50 m more."""

    def jumped(t: float, item: Item) -> Item:
        if not (isinstance(item, GpsPosition) and 28.0 <= t < 33.0):
            return item
        return replace(item, position=item.position + np.array([50.0, 0.0, 0.0]))

    return changed(items, jumped)


def seen_within(reach: float, item: Item) -> Item:
    """A scan as such a laser measures it; what is no scan as it is."""
    if not isinstance(item, LaserScan):
        return item
    return replace(item, ranges=np.where(item.ranges > reach, np.inf, item.ranges), range_max=reach)


def nearsighted(reach: float) -> Fault:
    """A laser that sees so many metres far."""
    return lambda items, _: [seen_within(reach, item) for item in items]


def interrupted(seconds: float, every: float) -> Fault:
    """No data for so long, again and again."""
    kinds = LaserScan, Imu, Height, Odometry

    def fault(items: Sequence[Item], _seed: int) -> list[Item]:
        return changed(
            items, lambda t, i: None if isinstance(i, kinds) and t > LATER and t % every < seconds else i
        )

    return fault


def covered(seconds: float, every: float) -> Fault:
    """A hand right before the laser for so long, again and again: no beam gets further than it."""

    def cover(scan: LaserScan, rng: np.random.Generator, _t: float) -> LaserScan:
        hand = HAND + 0.01 * rng.standard_normal(len(scan.ranges))
        return replace(scan, ranges=np.minimum(scan.ranges, hand).astype(np.float32))

    return _scans_again(seconds, every, cover)


def crowded(people: int, seconds: float, every: float) -> Fault:
    """People all around walk with the robot for so long, again and again."""

    def crowd(scan: LaserScan, rng: np.random.Generator, t: float) -> LaserScan:
        angles = scan.angle_min + np.arange(len(scan.ranges)) * scan.angle_increment
        ranges = scan.ranges.copy()
        for k in range(people):
            bearing = AROUND * ((k + 0.5) / people - 0.5) + 0.2 * np.sin(0.7 * t + k)
            along, aside = (AWAY * wave(angles - bearing) for wave in (np.cos, np.sin))
            hit = (along > 0.0) & (np.abs(aside) < BODY)
            near = along - np.sqrt(np.maximum(BODY**2 - aside**2, 0.0)) + 0.01 * rng.standard_normal(len(angles))
            ranges = np.where(hit, np.minimum(ranges, near), ranges)
        return replace(scan, ranges=ranges.astype(np.float32))

    return _scans_again(seconds, every, crowd)


def repeated(kind: type[LaserScan] | type[Imu], seconds: float, every: float) -> Fault:
    """A driver sends its last measurement for so long, again and again."""

    def fault(items: Sequence[Item], _seed: int) -> list[Item]:
        last: LaserScan | Imu | None = None

        def repeat(t: float, item: Item) -> Item:
            nonlocal last
            if not isinstance(item, kind):
                return item
            if last is not None and t > LATER and t % every < seconds:
                return replace(last, stamp_ns=item.stamp_ns)
            last = item
            return item

        return changed(items, repeat)

    return fault


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


def _drawn(stream: int, ranges: Callable[[Float32s, np.random.Generator], Float32s]) -> Fault:
    """Scans whose ranges come of the measured ones by chance. stream: of the generator, as well as the seed."""

    def fault(items: Sequence[Item], seed: int) -> list[Item]:
        rng = np.random.default_rng([seed, stream])

        def scan(_t: float, item: Item) -> Item:
            return replace(item, ranges=ranges(item.ranges, rng)) if isinstance(item, LaserScan) else item

        return changed(items, scan)

    return fault


def unechoed(share: float) -> Fault:
    """So many of the beams have no echo, others in each scan: the walls are dark."""
    return _drawn(25, lambda ranges, rng: np.where(rng.random(len(ranges)) < share, np.float32(np.inf), ranges))


def ending(reach: float) -> Fault:
    """A laser that sees so many metres far, and sends that where nothing returns."""

    def ended(_t: float, item: Item) -> Item:
        if not isinstance(item, LaserScan):
            return item
        return replace(item, ranges=np.minimum(item.ranges, np.float32(reach)), range_max=reach)

    return lambda items, _seed: changed(items, ended)


def noisy(share: float) -> Fault:
    """A laser whose ranges have a noise of so much of them."""

    def scattered(ranges: Float32s, rng: np.random.Generator) -> Float32s:
        return (ranges * (1.0 + share * rng.standard_normal(len(ranges)))).astype(np.float32)

    return _drawn(28, scattered)


def blind(degrees: float) -> Fault:
    """So much of the view ahead is blocked, by a mast or a load before the laser, and gives no echo."""

    def blocked(_t: float, item: Item) -> Item:
        if not isinstance(item, LaserScan):
            return item
        bearings = item.angle_min + item.angle_increment * np.arange(len(item.ranges))
        return replace(item, ranges=np.where(np.abs(bearings) < np.radians(degrees) / 2, np.inf, item.ranges))

    return lambda items, _seed: changed(items, blocked)


def _scans_again(
    seconds: float, every: float, change: Callable[[LaserScan, np.random.Generator, float], LaserScan]
) -> Fault:
    """Scans changed for so many seconds of each `every`, from LATER on."""

    def fault(items: Sequence[Item], seed: int) -> list[Item]:
        rng = np.random.default_rng([seed, 24])

        def changed_scan(t: float, item: Item) -> Item:
            return (
                change(item, rng, t) if isinstance(item, LaserScan) and t > LATER and t % every < seconds else item
            )

        return changed(items, changed_scan)

    return fault
