"""What goes wrong in a drive: scans that are missing, broken or from elsewhere, and aids that are wild.

That of wheels and of an IMU has files of its own.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np

from benchmarks.strays import astray
from hectorscope.inputs import Item
from slam_core import geometry
from slam_core.measurements import Float32s, GpsPosition, Height, Imu, LaserScan, Odometry

Fault = Callable[[Sequence[Item], int], list[Item]]
"""The items of a drive, damaged; the seed draws the noise."""
Change = Callable[[float, Item], Item | None]
AT_S = 12.0  # seconds from the first item to the fault
BROKEN_SCANS = 10
LATER = 5.0  # seconds from the first item to what happens again and again
# From what comes together to what comes next, and so long before that in each second of it.
BEFORE_NEXT_NS = {LaserScan: 10_000_000, Imu: 2_000_000, Height: 2_000_000}
IN_TURN_NS = 400_000
HAND = 0.4  # metres before the laser
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


def held_up(kinds: tuple[type[Item], ...], seconds: float, every: float, *, stamped: bool) -> Fault:
    """Measurements of so many seconds come together just before the next one, again and again.

    stamped: on arrival; else they have the times at which they were measured.
    """

    def fault(items: Sequence[Item], _seed: int) -> list[Item]:
        begin_ns, arrivals = items[0].stamp_ns, list[tuple[int, Item]]()
        for item in items:
            t, came_ns = (item.stamp_ns - begin_ns) * 1e-9, item.stamp_ns
            if isinstance(item, kinds) and t > LATER and t % every < seconds:
                came_ns += round((seconds - t % every) * 1e9) - BEFORE_NEXT_NS[type(item)]
                came_ns += round(t % every * IN_TURN_NS)
            arrivals.append((came_ns, replace(item, stamp_ns=came_ns) if stamped else item))
        return [item for _, item in sorted(arrivals, key=lambda arrival: arrival[0])]

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


def seen_ahead(degrees: float, scan: LaserScan) -> LaserScan:
    """A scan of a sensor that sees so many degrees ahead, as a depth camera does."""
    angles = scan.angle_min + scan.angle_increment * np.arange(len(scan.ranges))
    seen = np.flatnonzero(np.abs(angles) <= 0.5 * np.radians(degrees))
    first, last = int(seen[0]), int(seen[-1]) + 1
    late_ns = round(1e9 * first * scan.time_increment)
    return replace(
        scan,
        stamp_ns=scan.stamp_ns + late_ns,
        ranges=scan.ranges[first:last].copy(),
        angle_min=float(angles[first]),
    )


def two_lasers(items: Sequence[Item], _seed: int) -> list[Item]:
    """Two lasers on one topic: one sees the right half of each scan, one mounted to the left the other half."""
    return [each for item in items for each in (_halves(item) if isinstance(item, LaserScan) else [item])]


def _halves(scan: LaserScan) -> list[LaserScan]:
    half, mount = len(scan.ranges) // 2, scan.T_base_laser
    turned = geometry.multiply(mount.rotation, geometry.from_euler(0.0, 0.0, 0.5 * np.pi))
    left = replace(
        scan,
        stamp_ns=scan.stamp_ns + round(1e9 * half * scan.time_increment),
        ranges=scan.ranges[half:].copy(),
        angle_min=scan.angle_min + half * scan.angle_increment - 0.5 * np.pi,
        T_base_laser=replace(mount, rotation=turned),
    )
    return [replace(scan, ranges=scan.ranges[:half].copy()), left]


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
