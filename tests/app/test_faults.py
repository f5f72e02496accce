"""Sensors fail on the way: the state stays finite, the fault is named, and the robot finds its way again."""

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from app.pipeline import Pipeline
from app.settings import Settings
from app.simulation import SceneOptions, Simulation
from app.sources import Item
from slam_core.config import SlamConfig, with_value
from slam_core.geometry import rotation_matrix
from slam_core.measurements import Height, Imu, LaserScan, TruthPose

S = 1_000_000_000
OPTIONS = SceneOptions(duration=20.0, scan_rate=20.0, beams=361, seed=5)
Change = Callable[[float, Item], Item | None]


@cache
def drive() -> tuple[Simulation, tuple[Item, ...], int]:
    """Somebody walks: the simulation, all that is measured in order of arrival, and when it began."""
    simulation = Simulation("handheld", OPTIONS)
    items = tuple(item for item in simulation.items() if not isinstance(item, TruthPose))
    return simulation, items, min(item.stamp_ns for item in items)


def process(items: Iterable[Item], config: SlamConfig | None = None) -> tuple[Pipeline, set[str]]:
    """The pipeline at the end, and every warning that it gave on the way."""
    pipeline, warnings = Pipeline(Settings(config or SlamConfig()), drive()[2]), set()
    for item in items:
        for measurement in pipeline.admit(item):
            if pipeline.step(measurement) is not None:
                warnings.update(pipeline.slam.warnings)
    for measurement in pipeline.flush():
        pipeline.step(measurement)
    assert np.isfinite(pipeline.trajectory).all()
    navigation = pipeline.result.navigation if pipeline.result else None
    if navigation is not None:
        assert np.isfinite(navigation.covariance).all() and np.linalg.eigvalsh(navigation.covariance)[0] > 0.0
    return pipeline, warnings


def changed(change: Change) -> list[Item]:
    """The drive with every item changed or left out (None) by its time in seconds."""
    _, items, begin = drive()
    found = (change((item.stamp_ns - begin) / S, item) for item in items)
    return [item for item in found if item is not None]


def errors(pipeline: Pipeline, jump: Callable[[float], float] = lambda t: t) -> np.ndarray:
    """(n, 3) time, error in the plane in metres and of up in degrees, at the results. jump: to the true time."""
    simulation, _, begin = drive()
    rows = []
    for row in pipeline.trajectory:
        t = jump(row[0])
        true = simulation.truth_at(begin + round(t * S))
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
    pipeline, warnings = process(drive()[1])
    plane, up = worst(errors(pipeline), 1.0, 20.0)
    assert not warnings and plane < 0.05 and up < 1.5


def test_inertial_data_stops_and_comes_back() -> None:
    """For five seconds the matches alone carry the robot on; two seconds after, all is as before."""
    pipeline, warnings = process(changed(lambda t, i: None if isinstance(i, Imu) and 7 <= t < 12 else i))
    found = errors(pipeline)
    assert worst(found, 7.0, 12.0)[0] < 0.2
    plane, up = worst(found, 14.0, 20.0)
    assert plane < 0.1 and up < 1.5
    assert pipeline.slam.unused["gap in the inertial data"] == 1
    assert any("no inertial data comes" in warning for warning in warnings)
    assert not pipeline.slam.warnings


def test_scans_stop_and_come_back() -> None:
    """Inertial data carries the pose over two seconds without scans to where the map is found again."""
    pipeline, _ = process(changed(lambda t, i: None if isinstance(i, LaserScan) and 9 <= t < 11 else i))
    found = errors(pipeline)
    assert found[np.argmax(found[:, 0] > 10.5), 1] < 0.5
    assert worst(found, 11.5, 20.0)[0] < 0.1


@pytest.mark.parametrize("late", [(LaserScan,), (Imu, LaserScan), (Height,)])
def test_what_comes_late_is_used_at_its_own_time(late: tuple[type, ...]) -> None:
    """Scans 300 ms late, or inertial data with them: the same poses to a micrometre. Heights: nearly."""
    items = sorted(
        changed(lambda t, i: i if isinstance(i, Imu) or t >= 1.0 else None), key=lambda item: item.stamp_ns
    )
    order = sorted(items, key=lambda item: item.stamp_ns + 300_000_000 * isinstance(item, late))
    config = with_value(SlamConfig(), "aiding.standstill", False)  # which looks at the newest belief
    in_time, delayed = process(items, config)[0], process(order, config)[0]
    assert delayed.scans == in_time.scans > 370
    if late == (Height,):  # a result cannot know a height that comes after it
        np.testing.assert_allclose(delayed.trajectory[:, 1:3], in_time.trajectory[:, 1:3], atol=0.1)
    else:
        np.testing.assert_allclose(delayed.trajectory, in_time.trajectory, atol=1e-6)


@pytest.mark.parametrize("hour", [3600.0, -3600.0])
def test_a_clock_that_is_set_by_an_hour(hour: float) -> None:
    """All stamps jump at 10 s, for good: within a second the filter follows again, and says what happened."""

    def jump(t: float, item: Item) -> Item:
        return replace(item, stamp_ns=item.stamp_ns + round(hour * S)) if t >= 10 else item

    pipeline, warnings = process(changed(jump))
    found = errors(pipeline, lambda t: t - hour * (abs(t - 10) > 1000))
    plane, up = worst(found, 12.0, 20.0)
    assert plane < 0.1 and up < 2.0
    assert pipeline.scans > 360
    assert any(("leapt ahead" if hour > 0 else "set back") in warning for warning in warnings)


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

    pipeline, _ = process(changed(broken))
    assert worst(errors(pipeline), 12.0, 20.0)[0] < 0.1
    assert pipeline.slam.unused["inertial sample without a plausible value"] == 100
    assert pipeline.slam.unused["correction without a usable value"] == 10


def test_a_clipped_gyro_is_noticed() -> None:
    """Half a second of yaw rates far beyond what is said: the heading is unsure meanwhile, not wrong for good."""
    pipeline, warnings = process(changed(clipped))
    assert any("clipped" in warning for warning in warnings)
    assert pipeline.slam.unused["gyro at the end of its range"] > 20
    assert worst(errors(pipeline), 13.0, 20.0)[0] < 0.1


def clipped(t: float, item: Item) -> Item:
    """Half a second of rates that stay on 2 rad/s about the vertical."""
    if isinstance(item, Imu) and 9 <= t < 9.5:
        return replace(item, angular_velocity=np.array([0.0, 0.0, 2.0]))
    return item


def test_a_barometer_that_freezes_is_left_out() -> None:
    """It repeats one value from 6 s on; some seconds and metres later it is named and not used any more."""

    def frozen(t: float, item: Item) -> Item:
        return replace(item, height=3.0) if isinstance(item, Height) and t >= 6 else item

    pipeline, warnings = process(changed(frozen))
    assert any("height repeats one value" in warning for warning in warnings)
    assert pipeline.result is not None
    height = next(status for status in pipeline.result.aiding if status.source == "height")
    assert height.frozen and height.stamp_ns - height.used_ns > 5 * S
    assert worst(errors(pipeline), 1.0, 20.0)[0] < 0.1


def test_an_imu_without_accelerometers_still_helps_to_turn() -> None:
    """Forces of zero: the robot is followed as without an IMU, with the yaw rate, and told what is missing."""
    dead = changed(lambda t, i: replace(i, linear_acceleration=np.zeros(3)) if isinstance(i, Imu) else i)
    pipeline, warnings = process(dead)
    assert any("no gravity" in warning for warning in warnings)
    assert pipeline.scans > 380 and pipeline.result is not None and pipeline.result.navigation is None
    assert worst(errors(pipeline), 1.0, 20.0)[0] < 0.2


def test_an_imu_that_begins_late_takes_over_where_the_robot_is() -> None:
    """Scans alone for eight seconds; then the filter goes on from that pose, without a jump."""
    pipeline, _ = process(changed(lambda t, i: None if isinstance(i, Imu | Height) and t < 8 else i))
    assert pipeline.scans > 390 and pipeline.result is not None and pipeline.result.navigation is not None
    assert np.abs(np.diff(pipeline.trajectory[:, 1:3], axis=0)).max() < 0.3
    plane, up = worst(errors(pipeline), 10.0, 20.0)
    assert plane < 0.2 and up < 2.0
