"""Trajectories, read back by evo."""

from pathlib import Path

import numpy as np
import pytest

from hectorscope.exporters import chosen
from hectorscope.run.results import Run
from hectorscope.run.settings import Settings
from slam_core.geometry import from_euler, rotation_matrix

file_interface = pytest.importorskip("evo.tools.file_interface", reason="evo of the extra test is not installed")
START_NS = 1_700_000_000_123_456_789


@pytest.fixture
def run() -> Run:
    """A bend of fifty poses that lean and climb."""
    t = np.linspace(0.0, 5.0, 50)
    rotations = np.array([from_euler(0.1 * np.sin(s), -0.2 * np.cos(s), 3.0 * s) for s in t])
    positions = np.stack([np.cos(t), 100.0 + np.sin(t), 0.1 * t], axis=1)
    return Run(START_NS, np.column_stack([t, positions, rotations]), (), Settings(), {})


def test_evo_reads_the_tum_file(run: Run, tmp_path: Path):
    """The same times, places and rotations."""
    chosen("tum")[0].write(run, tmp_path)
    read = file_interface.read_tum_trajectory_file(str(tmp_path / "trajectory.tum"))
    np.testing.assert_allclose(read.timestamps - START_NS / 1e9, run.trajectory[:, 0], atol=1e-6)
    np.testing.assert_allclose(read.positions_xyz, run.trajectory[:, 1:4], atol=1e-8)
    np.testing.assert_allclose(read.orientations_quat_wxyz, run.trajectory[:, 4:8], atol=1e-8)
    assert read.check()[0]


def test_evo_reads_the_kitti_file(run: Run, tmp_path: Path):
    """The same matrices; times.txt has a line for each."""
    chosen("kitti")[0].write(run, tmp_path)
    read = file_interface.read_kitti_poses_file(str(tmp_path / "trajectory.kitti"))
    expected = np.array([rotation_matrix(row[4:8]) for row in run.trajectory])
    np.testing.assert_allclose(np.array(read.poses_se3)[:, :3, :3], expected, atol=1e-8)
    np.testing.assert_allclose(read.positions_xyz, run.trajectory[:, 1:4], atol=1e-8)
    assert read.check()[0]
    np.testing.assert_allclose(np.loadtxt(tmp_path / "times.txt"), run.trajectory[:, 0], atol=1e-9)
