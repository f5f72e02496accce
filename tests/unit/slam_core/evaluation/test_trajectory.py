import numpy as np
import pytest

from slam_core.evaluation import trajectory as ev


def quaternion(roll: float, pitch: float, yaw: float) -> np.ndarray:
    """w, x, y, z of a turn about z, then y, then x, by half angles."""
    (cr, sr), (cp, sp), (cy, sy) = ((np.cos(a / 2), np.sin(a / 2)) for a in (roll, pitch, yaw))
    return np.array(
        [
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        ]
    )


def walk(seconds: float = 10.0, rate: float = 20.0) -> ev.Trajectory:
    """A curve with all six degrees of freedom moving."""
    t = np.arange(0.0, seconds, 1 / rate)
    positions = np.column_stack([t, np.sin(t), 0.1 * np.cos(2 * t)])
    angles = np.column_stack([0.2 * np.sin(3 * t), 0.1 * np.cos(2 * t), 0.5 * t])
    return ev.Trajectory(t, positions, np.array([quaternion(*a) for a in angles]))


def test_euler_angles_recover_the_angles():
    """Roll, pitch and yaw that made a quaternion come back."""
    angles = np.array([[0.3, -0.7, 2.9], [-3.0, 1.2, -0.4], [0.0, 0.0, 0.0]])
    got = ev.euler_angles(np.array([quaternion(*a) for a in angles]))
    np.testing.assert_allclose(got, angles, atol=1e-12)


def test_wrap_stays_within_half_a_turn():
    """Angles end in [-pi, pi) and differ from the given ones by whole turns."""
    angles = np.linspace(-20, 20, 401)
    wrapped = ev.wrap(angles)
    assert np.all((wrapped >= -np.pi) & (wrapped < np.pi))
    np.testing.assert_allclose(np.cos(wrapped), np.cos(angles), atol=1e-12)


def test_interpolation_lies_halfway_in_position_and_rotation():
    """Between two poses the truth is taken along the line and the great arc."""
    truth = ev.Trajectory(
        np.array([0.0, 1.0]),
        np.array([[0.0, 0, 0], [2.0, 4, 6]]),
        np.array([quaternion(0, 0, 0), quaternion(0, 0, 1)]),
    )
    got, covered = ev.interpolate(truth, np.array([0.5]))
    assert covered.tolist() == [True]
    np.testing.assert_allclose(got.positions[0], [1, 2, 3])
    np.testing.assert_allclose(ev.euler_angles(got.rotations)[0], [0, 0, 0.5], atol=1e-12)


def test_interpolation_takes_the_short_way_around():
    """A quaternion and its negative are the same rotation: nothing spins in between."""
    q = quaternion(0.1, 0.2, 0.3)
    truth = ev.Trajectory(np.array([0.0, 1.0]), np.zeros((2, 3)), np.array([q, -q]))
    got, _ = ev.interpolate(truth, np.array([0.25, 0.5]))
    np.testing.assert_allclose(ev.euler_angles(got.rotations), [[0.1, 0.2, 0.3]] * 2, atol=1e-9)


def test_times_outside_the_truth_or_in_its_gaps_are_left_out():
    """Nothing is extrapolated, nothing invented across a long gap."""
    times = np.array([0.0, 0.1, 5.0, 5.1])
    truth = ev.Trajectory(times, np.zeros((4, 3)), np.tile(quaternion(0, 0, 0), (4, 1)))
    _, covered = ev.interpolate(truth, np.array([-0.1, 0.05, 2.0, 5.05, 6.0]))
    assert covered.tolist() == [False, True, False, True, False]


def test_a_pose_beside_a_gap_counts_at_its_own_time():
    """Keyframes seconds apart are scored at their own instants, all of them but none between."""
    times = np.array([0.0, 5.0, 9.0])
    truth = ev.Trajectory(times, np.diag(times), np.tile(quaternion(0, 0, 0), (3, 1)))
    got, covered = ev.interpolate(truth, np.array([0.0, 2.0, 5.0, 9.0]))
    assert covered.tolist() == [True, False, True, True]
    np.testing.assert_array_equal(got.positions, truth.positions)


def test_a_displaced_copy_has_no_aligned_error_but_a_raw_height_error():
    """Alignment takes out a rigid motion of the plane; so does the first pose when all else is equal."""
    truth = walk()
    moved = ev.move(np.array([3.0, -2.0, 0.7]), truth.planar)
    angles = np.column_stack([ev.euler_angles(truth.rotations)[:, :2], moved[:, 2]])
    positions = np.column_stack([moved[:, :2], truth.positions[:, 2] + 5.0])
    estimate = ev.Trajectory(truth.times, positions, np.array([quaternion(*a) for a in angles]))
    error = ev.evaluate(estimate, truth)
    assert error is not None
    for value in (error.raw, error.aligned, error.height, error.roll, error.pitch):
        assert value == pytest.approx(0.0, abs=1e-9)


def test_a_first_heading_that_is_wrong_shows_in_the_raw_error_only():
    """Raw hangs on the first pose: one wrong heading there swings the whole path; alignment forgives it."""
    truth = walk()
    angles = ev.euler_angles(truth.rotations)
    angles[0, 2] += 0.1
    estimate = ev.Trajectory(truth.times, truth.positions, np.array([quaternion(*a) for a in angles]))
    error = ev.evaluate(estimate, truth)
    assert error is not None
    assert error.raw == pytest.approx(0.1 * ev.rms(np.hypot(*truth.positions[:, :2].T)), rel=0.01)
    assert error.aligned == pytest.approx(0.0, abs=1e-9)


def test_known_tilt_error_is_reported():
    """A constant error of roll is its own root mean square; pitch is untouched."""
    truth = walk()
    angles = ev.euler_angles(truth.rotations) + np.array([0.01, 0.0, 0.0])
    estimate = ev.Trajectory(truth.times, truth.positions, np.array([quaternion(*a) for a in angles]))
    error = ev.evaluate(estimate, truth)
    assert error is not None
    assert error.roll == pytest.approx(0.01, rel=1e-6)
    assert error.pitch == pytest.approx(0.0, abs=1e-9)


def test_planar_poses_say_nothing_of_height_and_tilt():
    """Where the truth or the estimate is planar there are no such errors, neither flattering nor frightening."""
    full = walk()
    level = np.array([quaternion(0, 0, yaw) for yaw in full.planar[:, 2]])
    planar = ev.Trajectory(full.times, full.positions * [1, 1, 0], level)
    for estimate, truth in ((planar, full), (full, planar), (planar, planar)):
        error = ev.evaluate(estimate, truth)
        assert error is not None
        assert (error.height, error.roll, error.pitch) == (None, None, None)


def test_too_little_common_time_is_no_figure():
    """Fewer than three shared instants give no error at all."""
    truth = walk()
    late = ev.Trajectory(truth.times + 9.9, truth.positions, truth.rotations)
    assert ev.evaluate(late, truth) is None
    assert ev.evaluate(truth, truth.select(np.zeros(len(truth), bool))) is None


def test_rows_come_sorted_and_without_repeats():
    """Messages out of order or twice at one time are put right."""
    rows = np.zeros((4, 8))
    rows[:, 0] = [2, 1, 1, 3]
    rows[:, 1] = [20, 10, 11, 30]
    got = ev.Trajectory.from_rows(rows)
    assert got.times.tolist() == [1, 2, 3]
    assert got.positions[:, 0].tolist() == [10, 20, 30]


def test_relative_error_of_a_drifting_scale():
    """Driving straight with a path 1 % too long errs by 1 % of every stretch, in the direction of travel."""
    truth = np.column_stack([np.linspace(0, 10, 101), np.zeros(101), np.zeros(101)])
    estimate = truth * [1.01, 1, 1]
    along = ev.path_length(truth[:, :2])
    errors = ev.relative_errors(estimate, truth, along, 2.0)
    assert len(errors) > 50
    np.testing.assert_allclose(errors, np.tile([0.02, 0, 0], (len(errors), 1)), atol=2e-3)


def test_path_length_counts_every_step():
    """Path length of a right angle is the sum of its legs."""
    np.testing.assert_allclose(ev.path_length(np.array([[0.0, 0], [3, 0], [3, 4]])), [0, 3, 7])
