import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from slam_core.evaluation import trajectory as ev

coordinate = st.floats(-50, 50)
motion = st.tuples(coordinate, coordinate, st.floats(-3.1, 3.1)).map(np.array)
seeds = st.integers(0, 2**32 - 1)


@given(motion, seeds)
def test_alignment_undoes_any_rigid_motion(applied: np.ndarray, seed: int):
    """Points moved rigidly are carried back onto themselves."""
    points = np.random.default_rng(seed).normal(0, 10, (20, 2))
    poses = np.column_stack([points, np.zeros(20)])
    moved = ev.move(applied, poses)
    back = ev.move(ev.align(moved[:, :2], points), moved)
    np.testing.assert_allclose(back[:, :2], points, atol=1e-9)


@given(motion, seeds)
def test_no_other_motion_beats_the_alignment(other: np.ndarray, seed: int):
    """The aligned residual is the least there is: no random motion does better."""
    rng = np.random.default_rng(seed)
    source, target = rng.normal(0, 10, (2, 15, 2))
    poses = np.column_stack([source, np.zeros(15)])

    def residual(m: np.ndarray) -> float:
        return ev.rms(np.linalg.norm(ev.move(m, poses)[:, :2] - target, axis=1))

    assert residual(ev.align(source, target)) <= residual(other) + 1e-9


@given(motion, motion, seeds)
def test_relative_errors_do_not_depend_on_the_frames(one: np.ndarray, two: np.ndarray, seed: int):
    """Moving the estimate or the truth as a whole changes no relative error."""
    rng = np.random.default_rng(seed)
    estimate, truth = rng.normal(0, 1, (2, 30, 3))
    along = np.arange(30.0)
    before = ev.relative_errors(estimate, truth, along, 5.0)
    after = ev.relative_errors(ev.move(one, estimate), ev.move(two, truth), along, 5.0)
    np.testing.assert_allclose(after[:, :2], before[:, :2], atol=1e-9)
    np.testing.assert_allclose(ev.wrap(after[:, 2] - before[:, 2]), 0, atol=1e-9)


@given(seeds, st.floats(0, 1))
def test_slerp_turns_at_a_constant_rate(seed: int, share: float):
    """The way from the first rotation to the mixed one is its share of the whole way."""
    a, b = np.random.default_rng(seed).normal(size=(2, 1, 4))
    a, b = a / np.linalg.norm(a), b / np.linalg.norm(b)
    mixed = ev.slerp(a, b, np.array([[share]]))

    def angle(p: np.ndarray, q: np.ndarray) -> float:
        return float(2 * np.arctan2(np.linalg.norm(p - q), np.linalg.norm(p + q)))

    b = b if np.sum(a * b) >= 0 else -b
    np.testing.assert_allclose(angle(a, mixed), share * angle(a, b), atol=1e-6)
