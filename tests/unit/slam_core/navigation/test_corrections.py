"""What matches, heights and wheels change in the belief."""

import numpy as np
import pytest

from slam_core import geometry
from slam_core.config import FusionMethod
from slam_core.kernels.navigation import ERRORS, inject
from slam_core.navigation.corrections import BodyVelocity, PlanarPose
from tests.filters import OMEGA, R, begun, same
from tests.motions import Ride, euler_matrix, grown, stamp, tumble


def test_a_match_pulls_the_plane_and_leaves_the_height() -> None:
    """The belief after lies between the one before, which has not seen the match, and the match."""
    estimator = begun()
    wanted = np.array([0.02, -0.01, 0.001])
    before = estimator.at(stamp(1.0))
    after = estimator.fuse_planar(stamp(1.0), wanted, R, 0.3)
    moved = geometry.planar(after.T_map_base) / wanted
    assert np.allclose(geometry.planar(before.T_map_base), 0.0, atol=1e-6)
    assert (moved > 0.0).all() and (moved < 1.0).all()
    assert np.isclose(after.T_map_base.translation[2], before.T_map_base.translation[2], atol=1e-3)
    assert np.array_equal(estimator.at(stamp(1.0)).covariance, after.covariance)


def test_planar_is_the_projection_of_the_belief() -> None:
    """C x and C P C^T: with the derivative of heading by finite differences."""
    ride = tumble()
    estimator = begun(3.5, ride)
    state, plane = estimator.at(stamp(3.4)), estimator.planar(stamp(3.4))
    q = state.T_map_base.rotation
    C = np.zeros((3, 15))
    C[0, 3] = C[1, 4] = 1.0
    for i, axis in enumerate(np.eye(3)):
        ahead, behind = (geometry.multiply(geometry.from_rotation_vector(h * axis), q) for h in (1e-6, -1e-6))
        C[2, i] = (geometry.heading(ahead) - geometry.heading(behind)) / 2e-6
    assert np.allclose(plane.mean, geometry.planar(state.T_map_base))
    assert np.allclose(plane.covariance, C @ state.covariance @ C.T, rtol=1e-4, atol=1e-12)


def test_a_match_across_half_a_turn_is_near() -> None:
    """A heading of -179 degrees corrects one of 179 by two degrees, not by 358."""
    ride = Ride(lambda t: np.zeros(3), lambda t: euler_matrix(0.0, 0.0, np.radians(179.0) * grown(t)))
    estimator = begun(3.5, ride)
    start = estimator.planar(stamp(3.0)).mean
    assert abs(start[2] - np.radians(179.0)) < np.radians(0.5)
    after = estimator.fuse_planar(stamp(3.0), np.array([0.0, 0.0, np.radians(-179.0)]), 1e-6 * np.eye(3), 0.9)
    assert abs(geometry.wrap(geometry.planar(after.T_map_base)[2] - start[2])) < np.radians(3.0)


def test_wheels_correct_the_velocity_in_the_axes_of_the_base() -> None:
    """A base that heads to the left and drives forward moves along the map's y axis."""
    ride = Ride(lambda t: np.zeros(3), lambda t: euler_matrix(0.0, 0.0, np.pi / 2 * grown(t)))
    estimator = begun(3.5, ride)
    for _ in range(20):
        assert estimator.update_velocity_body(stamp(3.5), np.array([1.0, 0.0]), 0.01)
    assert np.allclose(estimator.state.velocity, [0.0, 1.0, 0.0], atol=0.03)


def test_a_body_velocity_is_linearised_rightly() -> None:
    """A tiny correction moves the state along the gain that finite differences of R^T v predict."""
    rng = np.random.default_rng(3)
    x = rng.normal(size=19)
    x[:4] /= np.linalg.norm(x[:4])
    root = rng.normal(size=(ERRORS, ERRORS)) * 0.1
    P = root @ root.T + 1e-3 * np.eye(ERRORS)

    def measured(y: np.ndarray) -> np.ndarray:
        return geometry.rotation_matrix(y[:4]).T @ y[7:10]

    C = np.array(
        [(measured(inject(x, 1e-6 * e)) - measured(inject(x, -1e-6 * e))) / 2e-6 for e in np.eye(ERRORS)]
    ).T
    step = 1e-5 * np.ones(3)
    expected = P @ C.T @ np.linalg.inv(C @ P @ C.T + 0.01 * np.eye(3)) @ step
    better = BodyVelocity(measured(x) + step, 0.1).update(x, P).x
    assert np.allclose(better[4:16] - x[4:16], expected[3:], atol=1e-9)


def test_a_broken_correction_is_counted_and_dropped() -> None:
    """A match with NaN, a covariance that is none, a height without end: nothing of it reaches the belief."""
    estimator = begun()
    state = estimator.state
    estimator.fuse_planar(stamp(1.0), np.array([0.0, np.nan, 0.0]), R, OMEGA)
    estimator.fuse_planar(stamp(1.0), np.zeros(3), -R, OMEGA)
    estimator.fuse_planar(stamp(1.0), np.zeros(3), np.full((3, 3), np.nan), OMEGA)
    estimator.update_height(stamp(1.0), np.inf)
    estimator.update_velocity_body(stamp(1.0), np.array([np.nan, 0.0]), 0.1)
    assert estimator.counts["correction without a usable value"] == 5
    assert same(state, estimator.state, 0.0)


@pytest.mark.parametrize("method", ["fixed", "trace", "determinant"])
def test_what_no_match_knows_of_need_not_be_widened(method: FusionMethod) -> None:
    """Height, vertical velocity and bias are no less sure than before; all the rest is as in the paper."""
    state = begun(3.5, tumble()).state
    x = np.concatenate((state.T_map_base.rotation, state.T_map_base.translation, state.velocity, np.zeros(9)))
    P, vertical = state.covariance, [5, 8, 14]
    rest = np.delete(np.arange(ERRORS), vertical)
    paper, spared = (
        PlanarPose(geometry.planar(state.T_map_base), R, OMEGA, method, widen_vertical=widen).update(x, P)
        for widen in (True, False)
    )
    np.testing.assert_array_equal(spared.P[np.ix_(rest, rest)], paper.P[np.ix_(rest, rest)])
    assert (np.diag(paper.P)[vertical] > np.diag(spared.P)[vertical]).all()
    assert (np.diag(spared.P)[vertical] <= np.diag(P)[vertical] * (1.0 + 1e-9)).all()
    assert np.linalg.eigvalsh(spared.P)[0] > 0.0
