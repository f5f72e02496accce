"""The state at 100 Hz, whatever comes how often."""

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hectorscope.exporters.navigation import EXPORTER
from hectorscope.inputs import Item
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.results import Run
from hectorscope.run.settings import Settings
from hectorscope.simulation import SceneOptions, Simulation
from slam_core.measurements import Imu, LaserScan, TruthPose

S = 1_000_000_000
SIMULATION = Simulation("handheld", SceneOptions(duration=8.0, scan_rate=10.0, beams=361, seed=2))
ITEMS = tuple(item for item in SIMULATION.items() if not isinstance(item, TruthPose))
BEGIN = min(item.stamp_ns for item in ITEMS)


def rows(items: Iterable[Item]) -> np.ndarray:
    """(n, 11) of a run over these items."""
    pipeline = Pipeline(Settings(), BEGIN)
    for item in items:
        for measurement in pipeline.admit(item):
            pipeline.step(measurement)
    return pipeline.navigation


def off(found: np.ndarray) -> np.ndarray:
    """Metres between each row and the truth, in the plane."""
    true = np.array([SIMULATION.truth_at(BEGIN + round(t * S)).translation[:2] for t in found[:, 0]])
    return np.hypot(*(found[:, 1:3] - true).T)


@pytest.mark.parametrize("inertial", [True, False])
def test_a_row_every_hundredth_of_a_second(inertial: bool) -> None:
    """From scans at 10 Hz, with and without inertial data: evenly spaced, near the truth, velocity the slope."""
    found = rows(item for item in ITEMS if inertial or not isinstance(item, Imu))
    assert len(found) > 680
    np.testing.assert_allclose(np.diff(found[:, 0]), 0.01, atol=1e-9)
    np.testing.assert_allclose(found[:, 0] * 100, np.round(found[:, 0] * 100), atol=1e-6)
    late = found[:, 0] > 3.0
    assert off(found[late]).max() < (0.05 if inertial else 0.3)
    if inertial:
        ahead = found[late][1:, 1:3] - found[late][:-1, 1:3]
        assert np.median(np.abs(ahead - 0.01 * found[late][:-1, 8:10])) < 1e-3


def test_the_same_rows_every_time() -> None:
    """Two runs agree to the last bit."""
    assert np.array_equal(rows(ITEMS), rows(ITEMS))


def test_nothing_is_known_before_it_arrived() -> None:
    """The rows up to some instant are the same whatever comes after it."""
    cut = next(k for k, item in enumerate(ITEMS) if item.stamp_ns > BEGIN + 5 * S)
    found, whole = rows(ITEMS[:cut]), rows(ITEMS)
    assert 350 < len(found) < len(whole)
    assert np.array_equal(found, whole[: len(found)])


def test_pauses_and_clocks_are_not_filled() -> None:
    """Ten seconds of silence and a clock set by an hour leave a step in time, not a thousand guesses."""
    jumped = [replace(i, stamp_ns=i.stamp_ns + 3600 * S) if i.stamp_ns > BEGIN + 4 * S else i for i in ITEMS]
    steps = np.diff(rows(jumped)[:, 0])
    assert (steps > 3000).sum() == 1 and np.allclose(steps[steps < 3000], 0.01)
    silent = rows(i for i in ITEMS if not (isinstance(i, Imu | LaserScan) and 3 * S < i.stamp_ns - BEGIN < 6 * S))
    assert np.isfinite(silent).all() and len(silent) < 700


def test_the_file_holds_every_row(tmp_path: Path) -> None:
    """A head, then time, pose and velocity, to the microsecond and micrometre."""
    found = rows(ITEMS)
    EXPORTER.write(Run(BEGIN, found[:, :8], (), Settings(), {}, navigation=found), tmp_path)
    head, *lines = (tmp_path / "navigation.csv").read_text().splitlines()
    assert head.split(",") == ["t", "x", "y", "z", "qx", "qy", "qz", "qw", "vx", "vy", "vz"]
    assert len(lines) == len(found)
    last = np.array([float(value) for value in lines[-1].split(",")])
    np.testing.assert_allclose(last[1:4], found[-1, 1:4], atol=1e-6)
    np.testing.assert_allclose(last[[7, 4, 5, 6]], found[-1, 4:8], atol=1e-6)
    np.testing.assert_allclose(last[8:], found[-1, 8:], atol=1e-6)
    assert last[0] - BEGIN / S == pytest.approx(found[-1, 0], abs=1e-5)
