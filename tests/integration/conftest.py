"""Compiled kernels, a short drive through simulated rooms, the headless run of it, and recordings for sweeps."""

from pathlib import Path

import numpy as np
import pytest

from hectorscope.inputs import Item
from hectorscope.run.headless import run_headless
from hectorscope.run.warmup import load_everything
from hectorscope.simulation import SceneOptions, Simulation
from slam_core.measurements import Imu, LaserScan
from tests.commands import hectorscope
from tests.engines import START
from tests.ros_messages import Messages, write_bag
from tests.sources import MemoryRecording
from tests.sweeps import recording


@pytest.fixture(scope="session", autouse=True)
def _compiled() -> None:
    """A first start compiles for minutes on a busy machine: no test has to wait for that."""
    load_everything()


@pytest.fixture(scope="session")
def drive() -> list[Item]:
    """Four seconds through the simulated rooms, with inertial data and truth."""
    return list(Simulation("rooms", SceneOptions(duration=4.0, scan_rate=20.0, beams=181)).items())


@pytest.fixture(scope="session")
def reference(drive: list[Item]) -> np.ndarray:
    """The trajectory of the headless run."""
    return run_headless(MemoryRecording(drive), START)[0].trajectory


@pytest.fixture(scope="session")
def short_bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three seconds, whose run takes a tenth of one."""
    return recording(tmp_path_factory.mktemp("sweep"))


@pytest.fixture(scope="session")
def long_bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A minute and a half: long enough to be stopped."""
    return recording(tmp_path_factory.mktemp("sweep"), "long.bag", duration=90.0)


@pytest.fixture(scope="session")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three simulated seconds as a ROS 1 bag, made by the command itself."""
    path = tmp_path_factory.mktemp("cli") / "short.bag"
    options = ["--duration", 3, "--beams", 181, "--scan-rate", 20]
    done = hectorscope("simulate", "--scenario", "rooms", *options, "--out", path)
    assert done.returncode == 0, done.stderr
    assert str(path) in done.stdout
    return path


@pytest.fixture(scope="session")
def wrong_units_bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Ten simulated seconds whose IMU gives milli-g and degrees a second."""
    ros, entries = Messages("ros1"), []
    items = list(Simulation("rooms", SceneOptions(duration=10.0, beams=181, scan_rate=10.0)).items())
    for item in items:
        ns = item.stamp_ns - items[0].stamp_ns
        if isinstance(item, Imu):
            rates, forces = np.degrees(item.angular_velocity), item.linear_acceleration / 9.80665e-3
            entries.append(("/imu", ros.imu(ns, rates=rates, forces=forces), ns))
        elif isinstance(item, LaserScan):
            beams = {"angle_min": item.angle_min, "angle_increment": item.angle_increment}
            timing = {"time_increment": item.time_increment}
            entries.append(("/scan", ros.scan(ns, ranges=item.ranges, **beams, **timing), ns))
    return write_bag(tmp_path_factory.mktemp("units") / "wrong_units.bag", entries)
