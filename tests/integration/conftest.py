"""Compiled kernels, a short drive through simulated rooms, the headless run of it, and recordings for sweeps."""

from pathlib import Path

import numpy as np
import pytest

from hectorscope.inputs import Item
from hectorscope.run.headless import run_headless
from hectorscope.run.warmup import load_everything
from hectorscope.simulation import SceneOptions, Simulation
from tests.engines import START
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
