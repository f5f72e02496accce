"""Section V-A in compiled form: eqs. (1)-(3) over one interval, their linearisation, the bounds of P.

x: (19,) quaternion 0:4, position 4:7, velocity 7:10, gyro bias 10:13, accelerometer bias 13:16, and the specific
force in body axes, smoothed, 16:19. P: (15, 15) of the errors of attitude (small rotation about the map's axes),
position, velocity, gyro bias, accelerometer bias. u: (6,) angular rate and specific force in body axes.

All in one file, since numba renews cached code only when the file that holds it changes; and in closed form, since
its own `@` and np.linalg would need scipy.
"""

import math

import numpy as np
from numba import njit

from slam_core import geometry
from slam_core.measurements import Float64s

STATES = 19
ERRORS = 15
# The smoothed specific force shows where down is while its size is within this share of gravity.
NEAR_GRAVITY = 0.1

_product = njit(error_model="numpy")(geometry.multiply)
_exponential = njit(error_model="numpy")(geometry.from_rotation_vector)
_matrix = njit(error_model="numpy")(geometry.rotation_matrix)
_heading_gradient = njit(error_model="numpy")(geometry.heading_gradient)


@njit(cache=True, error_model="numpy")
def advance(
    x: Float64s, P: Float64s, u: Float64s, dt: float, model: Float64s, bounds: Float64s
) -> tuple[Float64s, Float64s]:
    """The belief `dt` seconds later: eqs. (1)-(3), Phi P Phi^T + Q, and the pseudo measurements that bound P.

    model: (7,) gravity, smoothing time of the specific force, squared noise densities of gyro, accelerometer and
    of the walks of their biases. bounds: (15, 2), see `bound`.
    """
    moved = move(x, u, dt, model[0], model[1])
    spread = sandwich(transition(x, moved, u, dt), P)
    _add_noise(spread, dt, model[2:])
    return bound(moved, spread, model[0], bounds)


@njit(cache=True, error_model="numpy")
def move(x: Float64s, u: Float64s, dt: float, gravity: float, smoothing: float) -> Float64s:
    """Eqs. (1)-(3) under constant u: exact turn, trapezoid for velocity and position."""
    out = x.copy()
    turn = _exponential((u[:3] - x[10:13]) * dt)
    _set_attitude(out, _product(x[:4], turn))
    before, after = _matrix(x[:4]), _matrix(out[:4])
    back = _matrix(turn)
    share = -math.expm1(-dt / smoothing)
    for i in range(3):
        force = smoothed = 0.0
        for j in range(3):
            force += 0.5 * (before[i, j] + after[i, j]) * (u[3 + j] - x[13 + j])
            smoothed += back[j, i] * x[16 + j]
        out[7 + i] += dt * (force - (gravity if i == 2 else 0.0))
        out[4 + i] += 0.5 * dt * (x[7 + i] + out[7 + i])
        out[16 + i] = smoothed + share * (u[3 + i] - smoothed)
    return out


@njit(cache=True, error_model="numpy")
def transition(x: Float64s, moved: Float64s, u: Float64s, dt: float) -> Float64s:
    """Phi (15, 15): how the errors of x become the errors of `moved`, exact to second order in dt."""
    before, after = _matrix(x[:4]), _matrix(moved[:4])
    middle = 0.5 * (before + after)
    f = u[3:] - x[13:16]
    Phi = np.eye(ERRORS)
    force, force_after = np.zeros(3), np.zeros(3)
    for i in range(3):
        for j in range(3):
            force[i] += middle[i, j] * f[j]
            force_after[i] += after[i, j] * f[j]
            Phi[i, 9 + j] = -dt * middle[i, j]
            Phi[6 + i, 12 + j] = -dt * middle[i, j]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        Phi[6 + i, j] = dt * force[k]
        Phi[6 + i, k] = -dt * force[j]
        for c in range(3):
            turned = force_after[j] * middle[k, c] - force_after[k] * middle[j, c]
            Phi[6 + i, 9 + c] = 0.5 * dt * dt * turned
    for i in range(3):
        for c in range(ERRORS):
            if c < 3 or c > 8:
                Phi[3 + i, c] = 0.5 * dt * Phi[6 + i, c]
        Phi[3 + i, 6 + i] = dt
    return Phi


@njit(cache=True, error_model="numpy")
def _set_attitude(x: Float64s, q: Float64s) -> None:
    # Element by element: assigning a slice takes numba seconds to compile.
    norm = math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    for i in range(4):
        x[i] = q[i] / norm


@njit(cache=True, error_model="numpy")
def _add_noise(P: Float64s, dt: float, density: Float64s) -> None:
    for i in range(3):
        P[i, i] += density[0] * dt
        P[3 + i, 3 + i] += density[1] * dt**3 / 3.0
        P[3 + i, 6 + i] += density[1] * dt**2 / 2.0
        P[6 + i, 3 + i] += density[1] * dt**2 / 2.0
        P[6 + i, 6 + i] += density[1] * dt
        P[9 + i, 9 + i] += density[2] * dt
        P[12 + i, 12 + i] += density[3] * dt


@njit(cache=True, error_model="numpy")
def bound(x: Float64s, P: Float64s, gravity: float, bounds: Float64s) -> tuple[Float64s, Float64s]:
    """A pseudo measurement for every error whose variance passes bounds[i, 0], with noise variance bounds[i, 1].

    Tilt is measured by the smoothed specific force; height, velocity and biases are pulled to zero.
    """
    if P[0, 0] > bounds[0, 0] or P[1, 1] > bounds[0, 0]:
        x, P = level(x, P, gravity, bounds[0, 1])
    for i in range(5, ERRORS):
        if P[i, i] > bounds[i, 0]:
            gain = P[i] / (P[i, i] + bounds[i, 1])
            P = P - gain.reshape(-1, 1) * P[i]
            x = inject(x, -x[1 + i] * gain)
    return x, P


@njit(cache=True, error_model="numpy")
def level(x: Float64s, P: Float64s, gravity: float, variance: float) -> tuple[Float64s, Float64s]:
    """Tilt from the direction of the smoothed specific force, if its size says that it is mostly gravity."""
    R = _matrix(x[:4])
    force = np.zeros(3)
    C = np.zeros((2, ERRORS))
    for i in range(3):
        for j in range(3):
            force[i] += R[i, j] * (x[16 + j] - x[13 + j])
    size = math.sqrt(force[0] ** 2 + force[1] ** 2 + force[2] ** 2)
    if abs(size - gravity) > NEAR_GRAVITY * gravity:
        return x, P
    C[0, 1], C[1, 0] = force[2], -force[2]
    for j in range(3):
        C[0, 12 + j], C[1, 12 + j] = -R[0, j], -R[1, j]
    error, P = gain_update(P, C, variance * np.eye(2), -force[:2])
    return inject(x, error), P


@njit(cache=True, error_model="numpy")
def inject(x: Float64s, error: Float64s) -> Float64s:
    """The state with an error (15,) put right."""
    out = x.copy()
    _set_attitude(out, _product(_exponential(error[:3]), x[:4]))
    for i in range(3, ERRORS):
        out[1 + i] += error[i]
    return out


@njit(cache=True, error_model="numpy")
def correct(
    x: Float64s, P: Float64s, innovation: Float64s, C: Float64s, R: Float64s, bound: float
) -> tuple[Float64s, Float64s, Float64s, float]:
    """A Kalman update behind a gate: x, P, S = C P C^T + R, and nu^T S^-1 nu.

    Where that passes `bound`, or the numbers do not bear the update (it is NaN then), x and P stay as they were.
    """
    return _gated(x, P, innovation, C, R, R, 1.0, bound)


@njit(cache=True, error_model="numpy")
def intersect_planar(
    x: Float64s, P: Float64s, xi: Float64s, R: Float64s, omega: float, bound: float
) -> tuple[Float64s, Float64s, Float64s, Float64s, float]:
    """Eqs. (18)-(20) with C x = (p_x, p_y, psi), behind a gate as in `correct`: also the innovation."""
    C = np.zeros((3, ERRORS))
    C[0, 3] = C[1, 4] = 1.0
    C[2, :3] = _heading_gradient(x[:4])
    innovation = np.array([xi[0] - x[4], xi[1] - x[5], xi[2] - 2.0 * math.atan2(x[3], x[0])])
    innovation[2] -= 2.0 * math.pi * round(innovation[2] / (2.0 * math.pi))
    better, reduced, S, nis = _gated(x, P, innovation, C, R, (1.0 - omega) / omega * R, 1.0 - omega, bound)
    return better, reduced, innovation, S, nis


@njit(cache=True, error_model="numpy")
def _gated(
    x: Float64s,
    P: Float64s,
    innovation: Float64s,
    C: Float64s,
    R: Float64s,
    weighed: Float64s,
    share: float,
    bound: float,
) -> tuple[Float64s, Float64s, Float64s, float]:
    """The update with the noise `weighed`, P divided by `share`, if the innovation passes the gate with R."""
    S = R + sandwich(C, P)
    whitened = solve_lower(cholesky(S), innovation.reshape(-1, 1))
    nis = float(np.sum(whitened * whitened))
    if not nis <= bound:
        return x, P, S, nis
    error, reduced = gain_update(P, C, weighed, innovation)
    better = inject(x, error)
    reduced /= share
    if not is_sound(better, reduced):
        return x, P, S, math.nan
    return better, reduced, S, nis


@njit(cache=True, error_model="numpy")
def multiply(A: Float64s, B: Float64s) -> Float64s:
    """A B, skipping the zeros of A: transition and observer matrices are mostly empty."""
    out = np.zeros((A.shape[0], B.shape[1]))
    for i in range(A.shape[0]):
        for k in range(A.shape[1]):
            a = A[i, k]
            if a != 0.0:
                for j in range(B.shape[1]):
                    out[i, j] += a * B[k, j]
    return out


@njit(cache=True, error_model="numpy")
def sandwich(A: Float64s, P: Float64s) -> Float64s:
    """A P A^T of a symmetric P, symmetric to the last bit."""
    AP = multiply(A, P)
    out = multiply(A, AP.T.copy())
    for i in range(len(out)):
        for j in range(i):
            out[i, j] = out[j, i] = 0.5 * (out[i, j] + out[j, i])
    return out


@njit(cache=True, error_model="numpy")
def cholesky(A: Float64s) -> Float64s:
    """Lower L with L L^T = A; the diagonal of L holds NaN or 0 where A is not positive definite."""
    n = len(A)
    L = np.zeros((n, n))
    for i in range(n):
        for j in range(i + 1):
            rest = A[i, j]
            for k in range(j):
                rest -= L[i, k] * L[j, k]
            L[i, j] = math.sqrt(rest) if i == j else rest / L[j, j]
    return L


@njit(cache=True, error_model="numpy")
def is_covariance(A: Float64s) -> bool:
    """Whether A is finite, symmetric (to 1e-6 of its size) and positive definite."""
    for i in range(len(A)):
        for j in range(i):
            if not abs(A[i, j] - A[j, i]) <= 1e-6 * math.sqrt(abs(A[i, i] * A[j, j])):
                return False
    roots = np.diag(cholesky(A))
    return bool(np.all((roots > 0.0) & (roots < np.inf)))


@njit(cache=True, error_model="numpy")
def within(values: Float64s, limits: Float64s) -> bool:
    """Whether every |value| is below its limit; NaN is not."""
    inside = True
    for i in range(len(values)):
        inside &= abs(values[i]) < limits[i]
    return inside


@njit(cache=True, error_model="numpy")
def is_sound(x: Float64s, P: Float64s) -> bool:
    """Whether x and P are finite and no variance is zero or negative."""
    return bool(np.isfinite(x).all() and np.isfinite(P).all() and (np.diag(P) > 0.0).all())


@njit(cache=True, error_model="numpy")
def solve_lower(L: Float64s, B: Float64s) -> Float64s:
    """L^-1 B for a lower triangle L."""
    out = B.copy()
    for i in range(len(L)):
        for k in range(i):
            for j in range(B.shape[1]):
                out[i, j] -= L[i, k] * out[k, j]
        for j in range(B.shape[1]):
            out[i, j] /= L[i, i]
    return out


@njit(cache=True, error_model="numpy")
def gain_update(P: Float64s, C: Float64s, R: Float64s, innovation: Float64s) -> tuple[Float64s, Float64s]:
    """K innovation and P - K C P with K = P C^T (R + C P C^T)^-1.

    Through W = L^-1 C P with L L^T = R + C P C^T, since K C P = W^T W: symmetric by its making.
    """
    CP = multiply(C, P)
    L = cholesky(R + multiply(C, CP.T.copy()))
    W = solve_lower(L, CP)
    whitened = solve_lower(L, innovation.reshape(-1, 1))
    correction = np.zeros(len(P))
    reduced = P.copy()
    for k in range(len(C)):
        for i in range(len(P)):
            w = W[k, i]
            correction[i] += w * whitened[k, 0]
            for j in range(len(P)):
                reduced[i, j] -= w * W[k, j]
    return correction, reduced
