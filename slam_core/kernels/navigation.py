"""Section V-A in compiled form: eqs. (1)-(3) over one interval, their linearisation, the bounds of P.

x: (19,) quaternion 0:4, position 4:7, velocity 7:10, gyro bias 10:13, accelerometer bias 13:16, and the specific
force in body axes, smoothed, 16:19. P: (15, 15) of the errors of attitude (small rotation about the map's axes),
position, velocity, gyro bias, accelerometer bias. u: (6,) angular rate and specific force in body axes.
model: (8,) gravity, smoothing time of the specific force, squared noise densities of gyro, accelerometer and of
the walks of their biases, and whether (1 or 0) the base stays in the plane, and whether it does not slip sideways.
"""

import math

import numpy as np
from numba import njit

from slam_core.kernels import INNER
from slam_core.kernels.linear import fill_estimate, gain, multiply, symmetric
from slam_core.kernels.memory import alias_scope
from slam_core.kernels.rotations import cosines, exponential, product
from slam_core.measurements import Float64s

STATES = 19
ERRORS = 15
# The smoothed specific force shows where down is while its size is within this share of gravity.
NEAR_GRAVITY = 0.1
CONSTRAINED = 1e-12  # variance of what the platform cannot do
SLIP_SIGMA = 0.005  # m/s, of wheels that do not slip sideways
UNMEASURED = 1.0  # m/s, standard deviation of the vertical velocity where nothing measures the height

get, _ = alias_scope(0)
_, put = alias_scope(1)


@njit(inline="always", error_model="numpy")
def workspace() -> Float64s:
    """For what `advance` works out on the way: (3, 15, 15), the identity and twice anything."""
    work = np.zeros((3, ERRORS, ERRORS))
    for i in range(ERRORS):
        work[0, i, i] = 1.0
    return work


@njit(cache=True, error_model="numpy")
def advance(
    x: Float64s, P: Float64s, u: Float64s, dt: float, model: Float64s, bounds: Float64s, work: Float64s
) -> None:
    """The estimate `dt` seconds later, in place: eqs. (1)-(3), Phi P Phi^T + Q, and what bounds P.

    bounds: (15, 2), see `bound`. work: kept from one call to the next, as arrays of this size are slow to get.
    """
    Phi, half, turned = work[0], work[1], work[2]
    moved = move(x, u, dt, model[0], model[1])
    transition(x, moved, u, dt, Phi)
    _moved_errors(Phi, P, half)
    for i in range(ERRORS):
        for j in range(ERRORS):
            turned[j, i] = half[i, j]
    _moved_errors(Phi, turned, half)  # the product's transpose, which differs by rounding alone
    _add_noise(symmetric(half), dt, model[2:])
    moved, spread = bound(moved, half, model[0], bounds)
    if model[6] > 0.0:
        flatten(moved, spread)
    if model[7] > 0.0:
        moved, spread = _constrain_sideways(moved, spread)
    fill_estimate(x, P, moved, spread)


@njit(cache=True, error_model="numpy")
def move(x: Float64s, u: Float64s, dt: float, gravity: float, smoothing: float) -> Float64s:
    """Eqs. (1)-(3) under constant u: exact turn, trapezoid for velocity and position.

    smoothing: seconds; infinite: the smoothed force turns with the base and takes in none.
    """
    out = x.copy()
    turn = exponential(((u[0] - x[10]) * dt, (u[1] - x[11]) * dt, (u[2] - x[12]) * dt))
    _set_attitude(out, product(x, turn))
    middle, back = _mean(cosines(x), cosines(out)), cosines(turn)
    force = _times(middle, (u[3] - x[13], u[4] - x[14], u[5] - x[15]))
    share = -math.expm1(-dt / smoothing)
    for i in range(3):
        smoothed = back[i] * x[16] + back[3 + i] * x[17] + back[6 + i] * x[18]
        out[7 + i] += dt * (force[i] - (gravity if i == 2 else 0.0))
        out[4 + i] += 0.5 * dt * (x[7 + i] + out[7 + i])
        out[16 + i] = smoothed + share * (u[3 + i] - smoothed)
    return out


@njit(inline="always", error_model="numpy")
def transition(x: Float64s, moved: Float64s, u: Float64s, dt: float, Phi: Float64s) -> None:
    """How the errors of x become the errors of `moved`, exact to second order in dt, into Phi (15, 15).

    That must be the identity, or what this made of it.
    """
    after = cosines(moved)
    middle = _mean(cosines(x), after)
    f = u[3] - x[13], u[4] - x[14], u[5] - x[15]
    force, force_after = _times(middle, f), _times(after, f)
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        Phi[6 + i, j] = dt * force[k]
        Phi[6 + i, k] = -dt * force[j]
        for c in range(3):
            Phi[i, 9 + c] = Phi[6 + i, 12 + c] = -dt * middle[3 * i + c]
            turned = force_after[j] * middle[3 * k + c] - force_after[k] * middle[3 * j + c]
            Phi[6 + i, 9 + c] = 0.5 * dt * dt * turned
    for i in range(3):
        for c in range(ERRORS):
            if c < 3 or c > 8:
                Phi[3 + i, c] = 0.5 * dt * Phi[6 + i, c]
        Phi[3 + i, 6 + i] = dt


@njit(inline="always")
def _mean(A, B):
    """Of two matrices (3, 3), each as numbers."""
    return (
        0.5 * (A[0] + B[0]), 0.5 * (A[1] + B[1]), 0.5 * (A[2] + B[2]),
        0.5 * (A[3] + B[3]), 0.5 * (A[4] + B[4]), 0.5 * (A[5] + B[5]),
        0.5 * (A[6] + B[6]), 0.5 * (A[7] + B[7]), 0.5 * (A[8] + B[8]),
    )  # fmt: skip


@njit(inline="always")
def _times(A, v):
    """A v of a matrix (3, 3) and a vector, as numbers."""
    return (
        A[0] * v[0] + A[1] * v[1] + A[2] * v[2],
        A[3] * v[0] + A[4] * v[1] + A[5] * v[2],
        A[6] * v[0] + A[7] * v[1] + A[8] * v[2],
    )


@njit(**INNER)
def _moved_errors(Phi: Float64s, P: Float64s, out: Float64s) -> None:
    """Phi P, by those elements of Phi (see `transition`) alone that are neither 0 nor on the diagonal.

    Along the rows, which LLVM makes vectors of.
    """
    by, old, new, dt = Phi.reshape(-1), P.reshape(-1), out.reshape(-1), Phi[3, 6]
    for i in range(3):
        a, b = (1 if i == 0 else 0), (1 if i == 2 else 2)
        turns, places, speeds = ERRORS * i, ERRORS * (3 + i), ERRORS * (6 + i)
        for j in range(ERRORS):
            first, second = get(old, ERRORS * a + j), get(old, ERRORS * b + j)
            turn, speed = get(old, turns + j), get(old, speeds + j)
            place = get(by, places + a) * first + get(by, places + b) * second + get(old, places + j) + dt * speed
            speed = get(by, speeds + a) * first + get(by, speeds + b) * second + speed
            for k in range(9, ERRORS):
                error = get(old, ERRORS * k + j)
                if k < 12:
                    turn += get(by, turns + k) * error
                place += get(by, places + k) * error
                speed += get(by, speeds + k) * error
            put(new, turns + j, turn)
            put(new, places + j, place)
            put(new, speeds + j, speed)
    for k in range(9 * ERRORS, ERRORS * ERRORS):
        put(new, k, get(old, k))


@njit(inline="always", error_model="numpy")
def _set_attitude(x: Float64s, q: Float64s) -> None:
    # Element by element: assigning a slice takes numba seconds to compile.
    norm = math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    for i in range(4):
        x[i] = q[i] / norm


@njit(inline="always", error_model="numpy")
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

    Tilt is measured by the smoothed specific force; height, velocity and biases are pulled to zero. Where nothing
    measures the height, the vertical velocity is no better known than UNMEASURED: accelerations that the noise of
    the accelerometers does not cover, as of a base that shakes, would carry the height off for good.
    """
    if P[0, 0] > bounds[0, 0] or P[1, 1] > bounds[0, 0]:
        x, P = level(x, P, gravity, bounds[0, 1])
    if P[5, 5] > bounds[5, 0] and P[8, 8] < UNMEASURED**2:
        P = P.copy()
        P[8, 8] = UNMEASURED**2
    for i in range(5, ERRORS):
        if P[i, i] > bounds[i, 0]:
            P, row, error = P.copy(), P[i].copy(), np.empty(ERRORS)
            for j in range(ERRORS):  # numpy's own arithmetic takes long to compile
                share = row[j] / (row[i] + bounds[i, 1])
                error[j] = -x[1 + i] * share
                for k in range(ERRORS):
                    P[j, k] -= share * row[k]
            x = inject(x, error)
    return x, P


@njit(inline="always", error_model="numpy")
def flatten(x: Float64s, P: Float64s) -> None:
    """Section III, in place: a base that stays in the plane has no roll, pitch, height and vertical velocity."""
    heading = 2.0 * math.atan2(x[3], x[0])
    x[0], x[1], x[2], x[3] = math.cos(0.5 * heading), 0.0, 0.0, math.sin(0.5 * heading)
    x[6] = x[9] = 0.0
    for i in (0, 1, 5, 8):
        for j in range(ERRORS):
            P[i, j] = P[j, i] = 0.0
        P[i, i] = CONSTRAINED


@njit(inline="always", error_model="numpy")
def _constrain_sideways(x: Float64s, P: Float64s) -> tuple[Float64s, Float64s]:
    """Section III: a base on wheels has no velocity to its left."""
    R, v = cosines(x), x[7:10]
    left = R[1], R[4], R[7]
    C = np.zeros((1, ERRORS))
    C[0, 0], C[0, 1] = left[1] * v[2] - left[2] * v[1], left[2] * v[0] - left[0] * v[2]
    C[0, 2] = left[0] * v[1] - left[1] * v[0]
    slip = 0.0
    for i in range(3):
        C[0, 6 + i] = left[i]
        slip += left[i] * v[i]
    CP, innovation = multiply(C, P), np.empty(1)
    S, innovation[0] = multiply(C, CP.T), -slip
    S[0, 0] += SLIP_SIGMA**2
    error, P = gain(P, CP, S, innovation)
    return inject(x, error), P


@njit(cache=True, error_model="numpy")
def level(x: Float64s, P: Float64s, gravity: float, variance: float) -> tuple[Float64s, Float64s]:
    """Tilt from the direction of the smoothed specific force, if its size is near that of gravity."""
    R, C = cosines(x), np.zeros((2, ERRORS))
    force = _times(R, (x[16] - x[13], x[17] - x[14], x[18] - x[15]))
    size = math.sqrt(force[0] ** 2 + force[1] ** 2 + force[2] ** 2)
    if abs(size - gravity) > NEAR_GRAVITY * gravity:
        return x, P
    C[0, 1], C[1, 0] = force[2], -force[2]
    for j in range(3):
        C[0, 12 + j], C[1, 12 + j] = -R[j], -R[3 + j]
    CP, innovation = multiply(C, P), np.empty(2)
    S, innovation[0], innovation[1] = multiply(C, CP.T), -force[0], -force[1]
    for i in range(2):
        S[i, i] += variance
    error, P = gain(P, CP, S, innovation)
    return inject(x, error), P


@njit(cache=True, error_model="numpy")
def inject(x: Float64s, error: Float64s) -> Float64s:
    """The state with an error (15,) put right."""
    out = x.copy()
    _set_attitude(out, product(exponential(error), x))
    for i in range(3, ERRORS):
        out[1 + i] += error[i]
    return out
