"""Planar poses, quaternions (w, x, y, z), Euler angles and the heading that the stabilised frame is built on.

Heading. The paper's yaw angle jumps by pi where the pitch passes 90 degrees. Here an attitude is split into a turn
about the vertical and a tilt about a horizontal axis, q = q_z(psi) s with s_z = 0, so psi = 2 atan2(q_z, q_w).
This equals the yaw of a level robot, is smooth at 90 degrees of pitch, and is undefined only upside down.
The stabilised frame (REP-105 base_stabilized) stands in the base, turned by psi alone; s is the attitude in it.
"""

import math
from collections.abc import Sequence

import numpy as np

from slam_core.measurements import Float32s, Float64s, Transform

Numbers = Float64s | Sequence[float]
Quadruple = tuple[float, float, float, float]

# Below this cos(tilt / 2)^2 (within 2 degrees of upside down) the heading has no useful derivative.
_UPSIDE_DOWN = 3e-4


def wrap(angle: float) -> float:
    """The same angle in [-pi, pi], radians."""
    return math.remainder(angle, 2.0 * math.pi)


def compose(a: Float64s, b: Float64s) -> Float64s:
    """SE(2): the pose b (3,), given in a, seen from the parent of a (3,); x, y in metres, psi in radians."""
    c, s = math.cos(a[2]), math.sin(a[2])
    return np.array([a[0] + c * b[0] - s * b[1], a[1] + s * b[0] + c * b[1], wrap(a[2] + b[2])])


def inverse(pose: Float64s) -> Float64s:
    """SE(2): the pose (3,) of the parent seen from the child."""
    c, s = math.cos(pose[2]), math.sin(pose[2])
    return np.array([-c * pose[0] - s * pose[1], s * pose[0] - c * pose[1], wrap(-pose[2])])


def apart(a: Float64s, b: Float64s, distance: float, angle: float) -> bool:
    """Whether two poses (3,) are further from each other than a distance, metres, or an angle, radians."""
    return math.hypot(a[0] - b[0], a[1] - b[1]) > distance or abs(wrap(a[2] - b[2])) > angle


def transform_points(pose: Float64s, points: Float32s | Float64s) -> Float64s:
    """Eq. (8): points (n, 2) of the child in the parent, metres."""
    c, s = math.cos(pose[2]), math.sin(pose[2])
    x, y = points[:, 0].astype(np.float64), points[:, 1].astype(np.float64)
    out = np.empty((len(points), 2))
    out[:, 0] = c * x - s * y + pose[0]
    out[:, 1] = s * x + c * y + pose[1]
    return out


def multiply(p: Float64s, q: Float64s) -> Float64s:
    """Quaternion product: first the rotation q, then p."""
    return np.array(product(p, q))


def product(p: Numbers, q: Numbers) -> Quadruple:
    """`multiply` as numbers, which compiled code keeps out of memory."""
    pw, px, py, pz = p[0], p[1], p[2], p[3]
    qw, qx, qy, qz = q[0], q[1], q[2], q[3]
    return (
        pw * qw - px * qx - py * qy - pz * qz,
        pw * qx + px * qw + py * qz - pz * qy,
        pw * qy - px * qz + py * qw + pz * qx,
        pw * qz + px * qy - py * qx + pz * qw,
    )


def conjugate(q: Float64s) -> Float64s:
    """The opposite rotation."""
    return np.array([q[0], -q[1], -q[2], -q[3]])


def normalise(q: Float64s) -> Float64s:
    """The same rotation at unit length with w >= 0."""
    norm = math.sqrt(q[0] ** 2 + q[1] ** 2 + q[2] ** 2 + q[3] ** 2)
    return np.asarray(q, float) / math.copysign(norm, q[0])


def rotate(q: Float64s, vectors: Float64s) -> Float64s:
    """Vectors (3,) or (n, 3) of the child, in the axes of the parent."""
    turned: Float64s = vectors @ rotation_matrix(q.tolist()).T  # numpy's scalars are slow
    return turned


def from_rotation_vector(v: Float64s) -> Float64s:
    """Rotation by |v| radians about v (3,), exact for every length."""
    return np.array(exponential(v))


def exponential(v: Numbers) -> Quadruple:
    """`from_rotation_vector` as numbers."""
    half = 0.5 * math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    scale = 0.5 * math.sin(half) / half if half > 1e-6 else 0.5 - half * half / 12.0
    return math.cos(half), scale * v[0], scale * v[1], scale * v[2]


def to_rotation_vector(q: Float64s) -> Float64s:
    """The shortest rotation vector (3,) of q, radians."""
    w, x, y, z = q if q[0] >= 0.0 else -q
    sine = math.sqrt(x * x + y * y + z * z)
    scale = 2.0 * math.atan2(sine, w) / sine if sine > 1e-12 else 2.0
    return np.array([scale * x, scale * y, scale * z])


def rotation_matrix(q: Numbers) -> Float64s:
    """R (3, 3): the direction cosine matrix of eq. (3), from child axes to parent axes."""
    return np.array(cosines(q)).reshape(3, 3)


def cosines(q: Numbers) -> tuple[float, float, float, float, float, float, float, float, float]:
    """`rotation_matrix` as numbers, row by row."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    return (
        1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y),
        2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x),
        2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y),
    )  # fmt: skip


def from_rotation_matrix(m: Float64s) -> Float64s:
    """The unit quaternion of a rotation matrix (3, 3), w >= 0."""
    # Each row is one component times the whole quaternion; the longest row is the best conditioned.
    rows = np.array(
        [
            [1 + m[0, 0] + m[1, 1] + m[2, 2], m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]],
            [m[2, 1] - m[1, 2], 1 + m[0, 0] - m[1, 1] - m[2, 2], m[0, 1] + m[1, 0], m[0, 2] + m[2, 0]],
            [m[0, 2] - m[2, 0], m[0, 1] + m[1, 0], 1 - m[0, 0] + m[1, 1] - m[2, 2], m[1, 2] + m[2, 1]],
            [m[1, 0] - m[0, 1], m[0, 2] + m[2, 0], m[1, 2] + m[2, 1], 1 - m[0, 0] - m[1, 1] + m[2, 2]],
        ]
    )
    return normalise(rows[int(np.argmax(np.diag(rows)))])


def slerp(a: Float64s, b: Float64s, fraction: float) -> Float64s:
    """The attitude at `fraction` of the shortest turn from a to b."""
    return multiply(a, from_rotation_vector(fraction * to_rotation_vector(multiply(conjugate(a), b))))


def from_euler(roll: float, pitch: float, yaw: float) -> Float64s:
    """Quaternion of Omega = (phi, theta, psi): roll about x, then pitch about y, then yaw about z, radians."""
    cr, sr = math.cos(0.5 * roll), math.sin(0.5 * roll)
    cp, sp = math.cos(0.5 * pitch), math.sin(0.5 * pitch)
    cy, sy = math.cos(0.5 * yaw), math.sin(0.5 * yaw)
    return np.array(
        [
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        ]
    )


def to_euler(q: Float64s) -> tuple[float, float, float]:
    """Roll, pitch, yaw in radians, for display; roll and yaw are not separate at 90 degrees of pitch."""
    w, x, y, z = q.tolist()
    roll = math.atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    pitch = math.asin(max(-1.0, min(1.0, 2.0 * (w * y - z * x))))
    yaw = math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    return roll, pitch, yaw


def euler_rates(roll: float, pitch: float) -> Float64s:
    """E_Omega (3, 3) of eq. (1): body rates to the rates of roll, pitch, yaw; infinite at 90 degrees of pitch."""
    c, s, t = math.cos(roll), math.sin(roll), math.tan(pitch)
    sec = 1.0 / math.cos(pitch)
    return np.array([[1.0, s * t, c * t], [0.0, c, -s], [0.0, s * sec, c * sec]])


def yaw_quaternion(psi: float) -> Float64s:
    """A turn by psi radians about the vertical."""
    return np.array([math.cos(0.5 * psi), 0.0, 0.0, math.sin(0.5 * psi)])


def heading(q: Float64s) -> float:
    """The psi of q = q_z(psi) s, in [-pi, pi] radians: the heading of the stabilised frame; 0 if upside down."""
    return wrap(2.0 * math.atan2(q[3], q[0]))


def split_heading(q: Float64s) -> tuple[float, Float64s]:
    """(psi, s) of q = q_z(psi) s: the heading and the attitude (4,) of the base in the stabilised frame."""
    psi = heading(q)
    return psi, normalise(multiply(yaw_quaternion(-psi), q))


def heading_gradient(q: Float64s) -> Float64s:
    """(3,) d psi / d delta for q -> exp(delta) q: delta is a small rotation about the axes of the map.

    The tilt's share grows without bound towards upside down; there it is left out.
    """
    w, x, y, z = q[0], q[1], q[2], q[3]
    upright = w * w + z * z
    if upright < _UPSIDE_DOWN:
        return np.array([0.0, 0.0, 1.0])
    return np.array([(w * y + z * x) / upright, (z * y - w * x) / upright, 1.0])


def planar(T: Transform) -> Float64s:
    """The xi (3,): position in the plane and heading of a transform, metres and radians."""
    return np.array([T.translation[0], T.translation[1], heading(T.rotation)])


def matrix(T: Transform) -> Float64s:
    """The transform as a homogeneous matrix (4, 4)."""
    out = np.eye(4)
    out[:3, :3] = rotation_matrix(T.rotation)
    out[:3, 3] = T.translation
    return out


def chain(T_ab: Transform, T_bc: Transform) -> Transform:
    """T_ac: first T_bc, then T_ab."""
    return Transform(
        T_ab.translation + rotate(T_ab.rotation, T_bc.translation), multiply(T_ab.rotation, T_bc.rotation)
    )


def invert(T: Transform) -> Transform:
    """T_ba of T_ab."""
    back = conjugate(T.rotation)
    return Transform(-rotate(back, T.translation), back)
