"""The relation metric against homogeneous matrices, computed apart."""

import numpy as np

from slam_core.evaluation.relations import Relations, relation_error
from slam_core.evaluation.trajectory import Trajectory
from slam_core.measurements import Float64s


def matrix(x: float, y: float, yaw: float) -> Float64s:
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s, x], [s, c, y], [0.0, 0.0, 1.0]])


def drive(seed: int, n: int = 60) -> tuple[Trajectory, Float64s]:
    """A drive in the plane that wobbles in roll and height too, and its planar poses (n, 3)."""
    rng = np.random.default_rng(seed)
    poses = np.cumsum(rng.normal(0.1, 0.2, (n, 3)), axis=0)
    half = poses[:, 2] / 2
    rotations = np.column_stack([np.cos(half), np.zeros(n), np.zeros(n), np.sin(half)])
    positions = np.column_stack([poses[:, :2], rng.normal(size=n)])
    return Trajectory(np.arange(n) * 0.5, positions, rotations), poses


def test_the_errors_are_those_of_homogeneous_matrices():
    """Mean and deviation of |trans| and |rot| of inv(delta*) delta, for random drives and random relations."""
    for seed in range(5):
        trajectory, poses = drive(seed)
        rng = np.random.default_rng(seed + 100)
        pairs = np.sort(rng.choice(len(poses), (40, 2)), axis=1)
        motions = rng.normal(0.0, 1.0, (40, 3))
        found = relation_error(trajectory, Relations(pairs * 0.5, motions))
        errors = [
            np.linalg.inv(matrix(*motion)) @ np.linalg.inv(matrix(*poses[i])) @ matrix(*poses[j])
            for (i, j), motion in zip(pairs, motions, strict=True)
        ]
        distances = np.array([np.hypot(error[0, 2], error[1, 2]) for error in errors])
        turns = np.array([abs(np.arctan2(error[1, 0], error[0, 0])) for error in errors])
        wanted = [40, distances.mean(), distances.std(), turns.mean(), turns.std()]
        assert found is not None
        got = [found.used, found.translation_mean, found.translation_std, found.rotation_mean, found.rotation_std]
        np.testing.assert_allclose(got, wanted, atol=1e-9)


def test_relations_of_its_own_poses_have_no_error():
    """Also at times between two poses, where the trajectory is a straight line without a turn."""
    n = 11
    rows = np.column_stack([np.arange(n), 0.4 * np.arange(n), np.zeros((n, 2)), np.ones(n), np.zeros((n, 3))])
    relations = Relations(np.array([[0.25, 3.5], [2.0, 9.75]]), np.array([[1.3, 0.0, 0.0], [3.1, 0.0, 0.0]]))
    found = relation_error(Trajectory.from_rows(rows), relations)
    assert found is not None
    assert found.used == 2
    np.testing.assert_allclose([found.translation_mean, found.rotation_mean], 0.0, atol=1e-12)


def test_what_the_trajectory_does_not_cover_is_not_counted():
    """Only relations with both ends within the drive count; None if there is none."""
    trajectory, _ = drive(1)
    times = np.array([[1.0, 2.0], [-5.0, 2.0], [1.0, 400.0]])
    found = relation_error(trajectory, Relations(times, np.zeros((3, 3))))
    assert found is not None
    assert found.used == 1
    assert relation_error(trajectory, Relations(times[1:], np.zeros((2, 3)))) is None
