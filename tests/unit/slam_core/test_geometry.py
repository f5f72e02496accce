import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from slam_core import geometry
from slam_core.measurements import Transform
from tests.motions import euler_matrix, turn_matrix

angles = st.floats(-3.0, 3.0)
vectors = st.tuples(angles, angles, angles).map(np.array)
planar_poses = st.tuples(st.floats(-50, 50), st.floats(-50, 50), angles).map(np.array)


def attitude(v: np.ndarray) -> np.ndarray:
    return geometry.from_rotation_vector(v)


@given(st.floats(-1e4, 1e4))
def test_wrap_keeps_the_direction_and_stays_within_half_a_turn(angle: float) -> None:
    """Sine and cosine are unchanged and the result lies in [-pi, pi]."""
    wrapped = geometry.wrap(angle)
    assert abs(wrapped) <= np.pi
    assert np.allclose([np.cos(wrapped), np.sin(wrapped)], [np.cos(angle), np.sin(angle)], atol=1e-9)


@given(planar_poses, planar_poses)
def test_planar_poses_compose_like_homogeneous_matrices(a: np.ndarray, b: np.ndarray) -> None:
    """Compose is the matrix product, inverse the matrix inverse."""

    def homogeneous(pose: np.ndarray) -> np.ndarray:
        c, s = np.cos(pose[2]), np.sin(pose[2])
        return np.array([[c, -s, pose[0]], [s, c, pose[1]], [0, 0, 1]])

    assert np.allclose(homogeneous(geometry.compose(a, b)), homogeneous(a) @ homogeneous(b))
    assert np.allclose(homogeneous(geometry.inverse(a)) @ homogeneous(a), np.eye(3), atol=1e-9)


@given(planar_poses)
def test_points_move_as_equation_8_says(pose: np.ndarray) -> None:
    """S(xi) = R(psi) s + p, written out for one point."""
    s = np.array([[2.0, -1.0]])
    c, d = np.cos(pose[2]), np.sin(pose[2])
    expected = [c * 2.0 + d * 1.0 + pose[0], d * 2.0 - c * 1.0 + pose[1]]
    assert np.allclose(geometry.transform_points(pose, s)[0], expected)


@given(vectors, vectors)
def test_quaternions_turn_as_matrices_do(a: np.ndarray, b: np.ndarray) -> None:
    """Rotation vector, product, matrix, conjugate and turned vector all agree with matrices."""
    A, B = turn_matrix(a), turn_matrix(b)
    assert np.allclose(geometry.rotation_matrix(attitude(a)), A, atol=1e-9)
    assert np.allclose(geometry.rotation_matrix(geometry.multiply(attitude(a), attitude(b))), A @ B, atol=1e-9)
    assert np.allclose(geometry.rotation_matrix(geometry.conjugate(attitude(a))), A.T, atol=1e-9)
    assert np.allclose(geometry.rotate(attitude(a), b), A @ b, atol=1e-9)
    assert np.allclose(geometry.rotate(attitude(a), np.stack([a, b])), np.stack([A @ a, A @ b]), atol=1e-9)


@pytest.mark.parametrize("size", [0.0, 1e-12, 1e-7, 1e-6, 2e-6, 1e-3, 1.0])
def test_small_turns_lose_no_digits(size: float) -> None:
    """A rotation vector comes back to 1e-14 of its size, on either side of the switch to a series."""
    v = size * np.array([0.6, -0.48, 0.64])
    assert np.allclose(geometry.to_rotation_vector(attitude(v)), v, rtol=1e-14, atol=1e-24)


@given(vectors)
def test_conversions_of_an_attitude_come_back(v: np.ndarray) -> None:
    """Matrix and Euler angles give the same attitude back; the quaternion has unit length and w >= 0."""
    q = geometry.normalise(attitude(v))
    assert np.isclose(np.linalg.norm(q), 1.0) and q[0] >= 0.0
    assert np.allclose(geometry.from_rotation_matrix(geometry.rotation_matrix(q)), q, atol=1e-7)
    turned = geometry.rotation_matrix(geometry.from_euler(*geometry.to_euler(q)))
    assert np.allclose(turned, geometry.rotation_matrix(q), atol=1e-6)


@given(angles, angles, angles)
def test_euler_angles_are_roll_then_pitch_then_yaw(roll: float, pitch: float, yaw: float) -> None:
    """The attitude of (phi, theta, psi) is Rz Ry Rx."""
    q = geometry.from_euler(roll, pitch, yaw)
    assert np.allclose(geometry.rotation_matrix(q), euler_matrix(roll, pitch, yaw), atol=1e-9)


def test_slerp_turns_evenly() -> None:
    """At a third of the way the turn is a third; the ends are the ends; the short way round is taken."""
    a, v = attitude(np.array([0.3, 1.0, -0.2])), np.array([0.2, -0.9, 0.5])
    b = geometry.multiply(a, attitude(v))
    assert np.allclose(geometry.slerp(a, b, 1 / 3), geometry.multiply(a, attitude(v / 3)))
    assert np.allclose(geometry.slerp(a, -b, 1 / 3), geometry.multiply(a, attitude(v / 3)))
    assert np.allclose(geometry.slerp(a, b, 0.0), a) and np.allclose(geometry.slerp(a, b, 1.0), b)


@given(vectors)
def test_heading_splits_an_attitude_into_a_turn_and_a_tilt(v: np.ndarray) -> None:
    """Q = q_z(psi) s, and s has no component about the vertical."""
    psi, s = geometry.split_heading(attitude(v))
    assert abs(s[3]) < 1e-9
    rebuilt = geometry.rotation_matrix(geometry.multiply(geometry.yaw_quaternion(psi), s))
    assert np.allclose(rebuilt, geometry.rotation_matrix(attitude(v)), atol=1e-9)
    assert psi == geometry.heading(attitude(v))


@pytest.mark.parametrize("pitch", np.radians([-120.0, -90.0, -89.9, 0.0, 60.0, 90.0, 100.0, 170.0]))
def test_heading_survives_a_pitch_of_ninety_degrees(pitch: float) -> None:
    """Pitch alone never changes the heading, while Euler yaw jumps by half a turn at 90 degrees."""
    q = geometry.multiply(geometry.yaw_quaternion(0.7), geometry.from_euler(0.0, pitch, 0.0))
    assert np.isclose(geometry.heading(q), 0.7)


def test_heading_of_a_base_upside_down_is_a_number() -> None:
    """Where the heading is undefined it is 0 and its gradient is finite."""
    q = np.array([0.0, 1.0, 0.0, 0.0])
    assert geometry.heading(q) == 0.0
    assert np.isfinite(geometry.heading_gradient(q)).all()


@given(vectors)
def test_heading_gradient_is_the_finite_difference(v: np.ndarray) -> None:
    """D psi / d delta for small turns about the map's axes, wherever the base is not nearly upside down."""
    q = attitude(v)
    assume(q[0] ** 2 + q[3] ** 2 > 1e-2)
    for axis, derivative in zip(np.eye(3), geometry.heading_gradient(q), strict=True):
        ahead = geometry.heading(geometry.multiply(attitude(1e-6 * axis), q))
        behind = geometry.heading(geometry.multiply(attitude(-1e-6 * axis), q))
        assert np.isclose(geometry.wrap(ahead - behind) / 2e-6, derivative, atol=1e-5)


@given(vectors, vectors)
def test_transforms_chain_and_invert_like_matrices(a: np.ndarray, b: np.ndarray) -> None:
    """Chain is the matrix product, invert the inverse, planar reads x, y and heading."""
    T, U = Transform(b, attitude(a)), Transform(a, attitude(b))
    assert np.allclose(geometry.matrix(geometry.chain(T, U)), geometry.matrix(T) @ geometry.matrix(U), atol=1e-9)
    assert np.allclose(geometry.matrix(geometry.invert(T)) @ geometry.matrix(T), np.eye(4), atol=1e-9)
    assert np.allclose(geometry.planar(T), [b[0], b[1], geometry.heading(T.rotation)])
