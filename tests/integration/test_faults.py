"""Sensors fail in a running session: the state stays finite, the page names the fault, the robot finds its way."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest

from hectorscope.inputs import Item
from hectorscope.run.settings import Settings
from hectorscope.session.engine import Engine
from hectorscope.session.snapshot import Snapshot
from hectorscope.simulation import SceneOptions, Simulation
from slam_core.config import SlamConfig, with_value
from slam_core.geometry import rotation_matrix
from slam_core.measurements import GpsPosition, Height, Imu, LaserScan, TruthPose
from tests.sources import MemoryRecording, MemoryStream

S = 1_000_000_000
PATIENCE_S = 60.0
OPTIONS = SceneOptions(duration=20.0, scan_rate=20.0, beams=361, seed=5)
AFLOAT = replace(OPTIONS, duration=30.0, gps_outage=0.0)
Change = Callable[[float, Item], Item | None]


@dataclass(frozen=True)
class Drive:
    """The simulation, all that is measured in order of arrival, and when it began."""

    simulation: Simulation
    items: tuple[Item, ...]
    begin_ns: int

    def changed(self, change: Change) -> list[Item]:
        """The drive with every item changed or left out (None) by its time in seconds."""
        found = (change((item.stamp_ns - self.begin_ns) / S, item) for item in self.items)
        return [item for item in found if item is not None]


@cache
def drive() -> Drive:
    """Somebody walks, with a laser, an inertial unit and a barometer."""
    return _drive(Simulation("handheld", OPTIONS))


@cache
def voyage() -> Drive:
    """A boat that has satellites and a compass besides."""
    return _drive(Simulation("littoral", AFLOAT))


def _drive(simulation: Simulation) -> Drive:
    items = tuple(item for item in simulation.items() if not isinstance(item, TruthPose))
    return Drive(simulation, items, min(item.stamp_ns for item in items))


def process(items: Sequence[Item], config: SlamConfig | None = None) -> tuple[Snapshot, set[str]]:
    """What the page is shown at the end of a session, and every warning in its log."""
    engine = Engine(MemoryRecording(items), Settings(config or SlamConfig()), speed=float("inf"))
    engine.start()
    shown, deadline = engine.mailbox.latest, time.monotonic() + PATIENCE_S
    while (shown is None or shown.playback.state != "ended") and time.monotonic() < deadline:
        shown = engine.mailbox.take(timeout=0.1) or shown
    engine.stop()
    assert shown is not None and shown.playback.state == "ended"
    assert np.isfinite(shown.trajectory).all() and np.isfinite(shown.navigation).all()
    navigation = shown.result.navigation if shown.result else None
    if navigation is not None:
        assert np.isfinite(navigation.covariance).all() and np.linalg.eigvalsh(navigation.covariance)[0] > 0.0
    return shown, {entry.text for entry in shown.log if entry.level == "warning"}


def named(warnings: set[str], words: str) -> bool:
    """Whether one of them says so."""
    return any(words in warning for warning in warnings)


def changed(change: Change) -> list[Item]:
    """The walk, changed."""
    return drive().changed(change)


def errors(shown: Snapshot, jump: Callable[[float], float] = lambda t: t, of: Drive | None = None) -> np.ndarray:
    """(n, 3) time, error in the plane in metres and of up in degrees, at the results. jump: to the true time."""
    whole = of or drive()
    rows = []
    for row in shown.trajectory:
        t = jump((shown.playback.start_ns - whole.begin_ns) / S + row[0])
        true = whole.simulation.truth_at(whole.begin_ns + round(t * S))
        up = rotation_matrix(row[4:8])[2] @ rotation_matrix(true.rotation)[2]
        off = np.hypot(*(row[1:3] - true.translation[:2]))
        rows.append((t, off, np.degrees(np.arccos(min(1.0, up)))))
    return np.array(rows)


def worst(found: np.ndarray, begin: float, end: float) -> tuple[float, float]:
    """Largest error in the plane and of up between two times."""
    part = found[(found[:, 0] >= begin) & (found[:, 0] < end)]
    return float(part[:, 1].max()), float(part[:, 2].max())


def test_without_a_fault_nothing_is_said() -> None:
    """The drive itself: within 5 cm and 1.5 degrees, and no warning."""
    shown, warnings = process(drive().items)
    plane, up = worst(errors(shown), 1.0, 20.0)
    assert not warnings and not shown.warnings and plane < 0.05 and up < 1.5


def test_inertial_data_stops_and_comes_back() -> None:
    """For five seconds the matches alone carry the robot on; two seconds after, all is as before."""
    shown, warnings = process(changed(lambda t, i: None if isinstance(i, Imu) and 7 <= t < 12 else i))
    found = errors(shown)
    assert worst(found, 7.0, 12.0)[0] < 0.2
    plane, up = worst(found, 14.0, 20.0)
    assert plane < 0.1 and up < 1.5
    assert shown.unused["gap in the inertial data"] == 1
    assert named(warnings, "no inertial data comes")
    assert not shown.warnings


def test_scans_stop_and_come_back() -> None:
    """Inertial data carries the pose over two seconds without scans to where the map is found again."""
    shown, warnings = process(changed(lambda t, i: None if isinstance(i, LaserScan) and 9 <= t < 11 else i))
    assert named(warnings, "no scan came for over a second")
    assert not shown.warnings
    found = errors(shown)
    assert found[np.argmax(found[:, 0] > 10.5), 1] < 0.5
    assert worst(found, 11.5, 20.0)[0] < 0.1


def late(kinds: type | tuple[type, ...], by: float) -> list[Item]:
    """The drive in another order of arrival: these come later by so many seconds, all the others at their stamps.

    Inertial data begins at once, the rest after a second: what the filter begins with is the same then.
    """
    items = changed(lambda t, i: i if isinstance(i, Imu) or t >= 1.0 else None)
    return sorted(items, key=lambda item: item.stamp_ns + round(by * S) * isinstance(item, kinds))


def test_a_stream_without_scans_says_so_while_it_lasts() -> None:
    """Inertial data alone for two seconds: the page is told before a scan comes, if one ever does."""
    stream = MemoryStream()
    stream.send(changed(lambda t, i: i if t < (5.0 if isinstance(i, Imu) else 3.0) else None))
    engine = Engine(stream)
    engine.start()
    shown, deadline = engine.mailbox.latest, time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline and not (shown and named(set(shown.warnings), "no scan came")):
        shown = engine.mailbox.take(timeout=0.1) or shown
    engine.stop()
    assert shown is not None and named(set(shown.warnings), "no scan came for over a second")
    assert named({entry.text for entry in shown.log}, "no scan came for over a second")


@pytest.mark.parametrize(
    ("kinds", "names"),
    [((LaserScan,), ("scans",)), ((Imu, LaserScan), ("inertial data", "scans")), ((Height,), ("heights",))],
)
def test_what_comes_late_is_used_at_its_own_time(kinds: tuple[type, ...], names: tuple[str, ...]) -> None:
    """Scans 300 ms late, or inertial data with them: the same poses to a micrometre. Heights: nearly."""
    config = with_value(SlamConfig(), "aiding.standstill", False)  # which looks at the newest belief
    (in_time, none), (delayed, warnings) = (process(late(kinds, by), config) for by in (0.0, 0.3))
    assert not none
    assert all(named(warnings, f"{name} come over 0.15 s after data of the same time") for name in names)
    assert len(warnings) == len(names)
    assert delayed.scans == in_time.scans > 370
    if kinds == (Height,):  # a result cannot know a height that comes after it
        np.testing.assert_allclose(delayed.trajectory[:, 1:3], in_time.trajectory[:, 1:3], atol=0.1)
    else:
        np.testing.assert_allclose(delayed.trajectory, in_time.trajectory, atol=1e-6)


def test_what_comes_too_late_is_left_out() -> None:
    """Heights four seconds late are older than what the filter keeps: none is used, and that is said."""
    shown, warnings = process(late(Height, 4.0))
    assert named(warnings, "heights come over 0.15 s after") and named(
        warnings, "height comes too late to be used"
    )
    assert shown.unused["correction older than the history"] > 100
    assert worst(errors(shown), 1.0, 20.0)[0] < 0.1


@pytest.mark.parametrize("hour", [3600.0, -3600.0])
def test_a_clock_that_is_set_by_an_hour(hour: float) -> None:
    """All stamps jump at 10 s, for good: within a second the filter follows again, and says what happened."""

    def jump(t: float, item: Item) -> Item:
        return replace(item, stamp_ns=item.stamp_ns + round(hour * S)) if t >= 10 else item

    shown, warnings = process(changed(jump))
    found = errors(shown, lambda t: t - hour * (abs(t - 10) > 1000))
    assert named(warnings, "the clock of the laser was set")
    plane, up = worst(found, 12.0, 20.0)
    assert plane < 0.1 and up < 2.0
    assert shown.scans > 360
    assert named(warnings, "set ahead" if hour > 0 else "set back")
    assert not shown.warnings


def test_numbers_that_are_none() -> None:
    """A second of NaN in every inertial sample, height and half the beams is a second without them."""

    def broken(t: float, item: Item) -> Item:
        if not 9 <= t < 10:
            return item
        if isinstance(item, Imu):
            return replace(item, angular_velocity=np.full(3, np.nan))
        if isinstance(item, Height):
            return replace(item, height=float("nan"))
        if isinstance(item, LaserScan):
            return replace(item, ranges=np.where(np.arange(len(item.ranges)) % 2, item.ranges, np.float32("nan")))
        return item

    shown, warnings = process(changed(broken))
    assert named(warnings, "the IMU sends values that are not finite")
    assert named(warnings, "height sends values that are not finite")
    assert not shown.warnings
    assert worst(errors(shown), 12.0, 20.0)[0] < 0.1
    assert shown.unused["inertial sample without a plausible value"] == 100
    assert shown.unused["correction without a usable value"] == 10


def test_scans_without_a_number_are_scans_that_do_not_come() -> None:
    """A second of nothing but NaN: each is skipped by name, and the walk goes on from the inertial data."""

    def blind(t: float, item: Item) -> Item:
        nothing = isinstance(item, LaserScan) and 9 <= t < 10
        return replace(item, ranges=np.full(len(item.ranges), np.float32("nan"))) if nothing else item

    shown, warnings = process(changed(blind))
    assert named(warnings, "scans come without a beam in range")
    assert shown.report.skipped["scan without a beam in range"] == 20
    assert worst(errors(shown), 12.0, 20.0)[0] < 0.1


def test_a_clipped_gyro_is_noticed() -> None:
    """Half a second of yaw rates far beyond what is said: the heading is unsure meanwhile, not wrong for good."""
    shown, warnings = process(changed(clipped))
    assert named(warnings, "clipped")
    assert shown.unused["gyro at the end of its range"] > 20
    assert not shown.warnings
    assert worst(errors(shown), 13.0, 20.0)[0] < 0.1


def clipped(t: float, item: Item) -> Item:
    """Half a second of rates that stay on 2 rad/s about the vertical."""
    if isinstance(item, Imu) and 9 <= t < 9.5:
        return replace(item, angular_velocity=np.array([0.0, 0.0, 2.0]))
    return item


def test_a_barometer_that_freezes_is_left_out() -> None:
    """It repeats one value from 6 s on; some seconds and metres later it is named and not used any more."""

    def frozen(t: float, item: Item) -> Item:
        return replace(item, height=3.0) if isinstance(item, Height) and t >= 6 else item

    shown, warnings = process(changed(frozen))
    assert named(warnings, "height repeats one value") and named(set(shown.warnings), "height repeats one value")
    assert shown.result is not None
    height = next(status for status in shown.result.aiding if status.source == "height")
    assert height.frozen and height.stamp_ns - height.used_ns > 5 * S
    assert worst(errors(shown), 1.0, 20.0)[0] < 0.1


def test_a_barometer_that_thaws_is_used_again() -> None:
    """Frozen from 6 s to 14 s: what it says from then on counts, and the height is right again within seconds."""
    stuck = changed(lambda t, i: replace(i, height=3.0) if isinstance(i, Height) and 6 <= t < 14 else i)
    shown, warnings = process(stuck)
    assert named(warnings, "height repeats one value")
    assert shown.result is not None
    height = next(status for status in shown.result.aiding if status.source == "height")
    assert not height.frozen and height.stamp_ns == height.used_ns
    truth = drive().simulation.truth_at(shown.result.stamp_ns).translation[2]
    assert abs(shown.trajectory[-1, 3] - truth) < 0.3


def test_satellites_that_jump_move_nothing() -> None:
    """50 m for five seconds, in a boat: named, rejected while it lasts, and used again after it."""

    def jumped(t: float, item: Item) -> Item:
        off = isinstance(item, GpsPosition) and 18 <= t < 23
        return replace(item, position=item.position + np.array([50.0, 0.0, 0.0])) if off else item

    shown, warnings = process(voyage().changed(jumped))
    assert named(warnings, "gps contradicts the other sensors")
    assert shown.result is not None
    gps = next(status for status in shown.result.aiding if status.source == "gps")
    assert gps.rejected == 25 and gps.accepted
    found = errors(shown, of=voyage())
    assert worst(found, 18.0, 23.0)[0] < 0.15 and worst(found, 25.0, 30.0)[0] < 0.15


def test_an_imu_without_accelerometers_still_helps_to_turn() -> None:
    """Forces of zero: the robot is followed as without an IMU, with the yaw rate, and told what is missing."""
    dead = changed(lambda t, i: replace(i, linear_acceleration=np.zeros(3)) if isinstance(i, Imu) else i)
    shown, warnings = process(dead)
    assert named(warnings, "no gravity")
    assert shown.scans > 380 and shown.result is not None and shown.result.navigation is None
    assert worst(errors(shown), 1.0, 20.0)[0] < 0.2


def test_an_imu_that_begins_late_takes_over_where_the_robot_is() -> None:
    """Scans alone for eight seconds; then the filter goes on from that pose, without a jump."""
    shown, _ = process(changed(lambda t, i: None if isinstance(i, Imu | Height) and t < 8 else i))
    assert shown.scans > 390 and shown.result is not None and shown.result.navigation is not None
    assert np.abs(np.diff(shown.trajectory[:, 1:3], axis=0)).max() < 0.3
    plane, up = worst(errors(shown), 10.0, 20.0)
    assert plane < 0.2 and up < 2.0
