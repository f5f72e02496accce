"""Two judges of the same errors, and another system on the same scans."""

import numpy as np
import pytest

from benchmarks.others import INSTALLED, RANGES, evo_errors, flat_cloud, judge, kiss_icp
from hectorscope.simulation import SceneOptions, Simulation
from slam_core.evaluation.trajectory import path_length, relative_errors
from slam_core.measurements import Float64s, LaserScan, Transform

bench = pytest.mark.skipif(not INSTALLED, reason="the bench extra is not installed")


def wandering(seed: int) -> tuple[Float64s, Float64s]:
    """Estimate and truth, (n, 8) and (m, 8): at other rates, in other frames, a few centimetres apart."""
    t = np.arange(0.0, 20.0, 0.01)
    yaw = 0.3 * np.sin(0.4 * t)
    truth = np.column_stack(
        [t, t * np.cos(0.1 * t), np.sin(t), 0.2 * t, np.cos(yaw / 2), 0 * t, 0 * t, np.sin(yaw / 2)]
    )
    estimate = truth[5:-5:4].copy()
    estimate[:, 1:3] += np.random.default_rng(seed).normal([2.0, -1.0], 0.03, size=(len(estimate), 2))
    return estimate, truth


@bench
def test_evo_finds_the_error_that_our_metric_finds() -> None:
    """In the plane, after the best rigid motion: the same figure, to a millionth of a metre."""
    for seed in (1, 2):
        judged = judge(*wandering(seed), ms=1.0)
        assert judged.ape == pytest.approx(judged.own, abs=1e-6)
        assert judged.own == pytest.approx(0.03 * np.sqrt(2), rel=0.1)


@bench
def test_evo_finds_the_relative_error_that_ours_finds() -> None:
    """Over a metre of path: two independent errors of 3 cm in each axis, whichever judge."""
    estimate, truth = wandering(3)
    same = truth[5:-5:4]
    planar = [np.column_stack([rows[:, 1:3], 2 * np.arctan2(rows[:, 7], rows[:, 4])]) for rows in (estimate, same)]
    ours = relative_errors(*planar, path_length(same[:, 1:3]), 1.0)[:, :2]
    assert evo_errors(estimate, truth)[1] == pytest.approx(np.sqrt(np.mean(np.sum(ours**2, axis=1))), rel=0.05)


def test_without_a_truth_only_the_way_is_known() -> None:
    """No errors, but how far the last pose is from the first."""
    judged = judge(wandering(1)[0], np.empty((0, 8)), ms=1.0)
    assert judged.ape is judged.rpe is judged.own is None
    assert judged.start_to_end > 1.0


def test_a_cloud_lies_in_the_frame_of_the_base_and_covers_the_revolution() -> None:
    """Beams without a return are left out; times are those of the beams, from 0 to the whole turn."""
    ranges = np.array([1.0, np.inf, 2.0, 40.0, 0.05], np.float32)
    mount = Transform(np.array([0.1, 0.0, 0.5]))
    scan = LaserScan(0, ranges, 0.0, np.pi / 2, time_increment=0.01, range_max=60.0, T_base_laser=mount)
    cloud, times = flat_cloud(scan, 0.1)
    np.testing.assert_allclose(cloud[1:-1], [[1.1, 0.0, 0.5], [-1.9, 0.0, 0.5]], atol=1e-6)
    np.testing.assert_allclose(times, [0.0, 0.0, 0.02, 0.1])
    assert np.linalg.norm(cloud[[0, -1]], axis=1).min() > RANGES[1]


@bench
def test_the_other_follows_a_short_drive() -> None:
    """Ten centimetres at most in rooms that it can follow: clouds, times and poses mean what they should."""
    simulation = Simulation("rooms", SceneOptions(duration=5.0))
    scans = [item for item in simulation.items() if isinstance(item, LaserScan)]
    start_ns = scans[0].stamp_ns
    rows, ms = kiss_icp(scans, start_ns)
    true = [simulation.truth_at(start_ns + round(t * 1e9)).translation for t in rows[:-2, 0]]
    assert path_length(np.array(true))[-1] > 1.5
    assert np.linalg.norm(rows[:-2, 1:3] - np.array(true)[:, :2], axis=1).max() < 0.1
    assert ms > 0.0
